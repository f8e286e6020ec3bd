// A stream of bins that a policy is measured on.
namespace Packcell
{
    /// <summary>Whether items may be turned.</summary>
    public enum Rotation
    {
        Off = Raw.PKC_ROTATION_OFF,
        On = Raw.PKC_ROTATION_ON,
        /// <summary>Each bin draws.</summary>
        Mixed = Raw.PKC_ROTATION_MIXED
    }

    /// <summary>The bins, and the items offered to them. A new one is what the trainer's defaults
    /// play: 10 x 10, sides 1..5, each bin until it closes, rotation mixed.</summary>
    public sealed class Protocol
    {
        internal Raw.pkc_trainer_options raw;

        public Protocol()
        {
            Native.Check(Raw.pkc_trainer_options_init(ref raw,
                                                      Native.Size<Raw.pkc_trainer_options>()));
        }

        /// <summary>Cells of a bin's side, 1..128.</summary>
        public int BinW { get => raw.bin_w; set => raw.bin_w = value; }
        /// <summary>Cells of a bin's side, 1..128.</summary>
        public int BinH { get => raw.bin_h; set => raw.bin_h = value; }
        /// <summary>Items' sides are uniform from here...</summary>
        public int LeastSide { get => raw.least_side; set => raw.least_side = value; }
        /// <summary>...to here, at most the bin's shorter side.</summary>
        public int MostSide { get => raw.most_side; set => raw.most_side = value; }
        /// <summary>0: the first item without a position closes the bin; 1..1000000: so many are
        /// offered, and those without a position skipped.</summary>
        public int Items { get => raw.items; set => raw.items = value; }
        public Rotation Rotation
        {
            get => (Rotation)raw.rotation;
            set => raw.rotation = (int)value;
        }
    }

    /// <summary>Mean utilisation, 0..1, and half the width of its 95 % interval.</summary>
    public struct Measurement
    {
        public double Mean, HalfWidth;
    }
}
