// Streams and sets of items, and the grid from millimetres to cells.
using System;

namespace Packcell
{
    /// <summary>What is generated.</summary>
    public enum GeneratorKind
    {
        /// <summary>A stream of items with sides uniform on 1 to half the bin's.</summary>
        Random = Raw.PKC_GENERATE_RANDOM,
        /// <summary>Sets that fill a bin to the last cell.</summary>
        Full = Raw.PKC_GENERATE_FULL
    }

    /// <summary>A new one is Random, 10 x 10, preset "table", seed 1. Equal options give equal
    /// items on every machine.</summary>
    public sealed class GeneratorOptions
    {
        internal Raw.pkc_generator_options raw;

        public GeneratorOptions()
        {
            Native.Check(Raw.pkc_generator_options_init(ref raw,
                                                        Native.Size<Raw.pkc_generator_options>()));
        }

        public GeneratorKind Kind { get => (GeneratorKind)raw.kind; set => raw.kind = (int)value; }
        /// <summary>Cells of the bin's sides, 1..128 (10 x 10).</summary>
        public int W { get => raw.w; set => raw.w = value; }
        public int H { get => raw.h; set => raw.h = value; }
        /// <summary>Full: of the sides, as a fraction of the bin's side.</summary>
        public double Mean { get => raw.mean; set => raw.mean = value; }
        /// <summary>Full: standard deviation in cells.</summary>
        public double Sigma { get => raw.sigma; set => raw.sigma = value; }
        public ulong Seed { get => raw.seed; set => raw.seed = value; }

        /// <summary>Sets mean and sigma: "text" or "table".</summary>
        public GeneratorOptions Preset(string name)
        {
            Native.Check(Raw.pkc_generator_preset(ref raw, Native.Text(name)));
            return this;
        }
    }

    /// <summary>Streams and sets of items.</summary>
    public sealed class Generator : Handle<Raw.pkc_generator>
    {
        /// <summary>Without options, the defaults.</summary>
        public Generator(GeneratorOptions options = null) : base(Create(options)) { }

        private static Raw.pkc_generator Create(GeneratorOptions options)
        {
            Raw.pkc_generator_options of = (options ?? new GeneratorOptions()).raw;
            Raw.pkc_generator raw;
            Native.Check(Raw.pkc_generator_create(ref of, out raw));
            return raw;
        }

        /// <summary>Random: so many items, ids counting on. Full: the next set, of at most so many,
        /// ids from 0; W * H always suffice, with fewer it may be Status.Capacity.</summary>
        public Item[] Next(int most)
        {
            if (most < 0)
                throw Native.Wrong(FormattableString.Invariant(
                    $"{most} items: must be 0 or more"));
            var raw = new Raw.pkc_item[most];
            ulong count;
            Native.Check(Raw.pkc_generator_next(Native.Of(this), raw, (ulong)most, out count));
            Array.Resize(ref raw, (int)count);
            return Native.Map(raw, Item.From);
        }
    }

    /// <summary>From a real bin, in millimetres, to cells and back. A new one has the paper's: 320
    /// x 260, 10, 30, 0.</summary>
    public sealed class Grid
    {
        private Raw.pkc_grid raw;

        public Grid()
        {
            Native.Check(Raw.pkc_grid_init(ref raw, Native.Size<Raw.pkc_grid>()));
        }

        public double BinW { get => raw.bin_w; set => raw.bin_w = value; }
        public double BinH { get => raw.bin_h; set => raw.bin_h = value; }
        /// <summary>Kept free along each wall.</summary>
        public double Margin { get => raw.margin; set => raw.margin = value; }
        /// <summary>Side of a cell.</summary>
        public double Cell { get => raw.cell; set => raw.cell = value; }
        /// <summary>Kept free between neighbouring items.</summary>
        public double Clearance { get => raw.clearance; set => raw.clearance = value; }

        /// <summary>The bin's cells: floor((side - 2 * margin) / cell) of each side.</summary>
        public (int W, int H) BinCells()
        {
            int w, h;
            Native.Check(Raw.pkc_grid_bin(ref raw, out w, out h));
            return (w, h);
        }

        /// <summary>Cells that an item of w x h millimetres takes: ceil((side + clearance) /
        /// cell).</summary>
        public (int W, int H) ItemCells(double w, double h)
        {
            int cellsW, cellsH;
            Native.Check(Raw.pkc_grid_item(ref raw, w, h, out cellsW, out cellsH));
            return (cellsW, cellsH);
        }

        /// <summary>Centre of a rectangle of cells, in millimetres from the bin's inside top-left
        /// corner.</summary>
        public (double X, double Y) Centre(int x, int y, int w, int h)
        {
            double centreX, centreY;
            Native.Check(Raw.pkc_grid_centre(ref raw, x, y, w, h, out centreX, out centreY));
            return (centreX, centreY);
        }
    }
}
