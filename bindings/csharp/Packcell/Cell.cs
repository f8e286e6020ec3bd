// The cell: arms, bin, belt, buffers. Lengths are metres, angles radians, times seconds.
namespace Packcell
{
    /// <summary>What a cell's description comes to.</summary>
    public sealed class CellInfo
    {
        internal Raw.pkc_cell_info raw;

        internal CellInfo()
        {
            Native.Check(Raw.pkc_cell_info_init(ref raw, Native.Size<Raw.pkc_cell_info>()));
        }

        public int Arms => raw.arms;
        public int BinW => raw.bin_w;
        public int BinH => raw.bin_h;
        /// <summary>Items that each arm's buffer holds.</summary>
        public int[] BufferSlots => new[] { raw.buffer_slots[0], raw.buffer_slots[1] };
        /// <summary>Of each arm: 6 or 4; 0 where there is none.</summary>
        public int[] Joints => new[] { raw.joints[0], raw.joints[1] };
        /// <summary>Kept between the arms.</summary>
        public double Margin => raw.margin;
        /// <summary>Of coordination.</summary>
        public double Tick => raw.tick;
        /// <summary>One arm's: home, belt, bin and home, with dwells.</summary>
        public double Cycle => raw.cycle;
        public string Name => raw.name.ToString();
    }

    /// <summary>A new one has the library's defaults.</summary>
    public sealed class LayoutOptions
    {
        internal Raw.pkc_layout_options raw;

        public LayoutOptions()
        {
            Native.Check(Raw.pkc_layout_options_init(ref raw,
                                                     Native.Size<Raw.pkc_layout_options>()));
        }

        /// <summary>Of the mean transfer time, 10..100000 (800).</summary>
        public int Evaluations { get => raw.evaluations; set => raw.evaluations = value; }
        /// <summary>Metres by which bases and buffers may move in x and in y, 0..2 (0.3).</summary>
        public double Range { get => raw.range; set => raw.range = value; }
    }

    /// <summary>How the layout was found.</summary>
    public sealed class LayoutInfo
    {
        internal Raw.pkc_layout_info raw;

        internal LayoutInfo()
        {
            Native.Check(Raw.pkc_layout_info_init(ref raw, Native.Size<Raw.pkc_layout_info>()));
        }

        /// <summary>Made.</summary>
        public int Evaluations => raw.evaluations;
        /// <summary>Mean transfer time between belt, bin and buffers, without dwells.</summary>
        public double Before => raw.before;
        public double After => raw.after;
    }

    /// <summary>Immutable; may be shared by threads.</summary>
    public sealed class Cell : Handle<Raw.pkc_cell>
    {
        private const int PoseNumbers = 4;

        /// <summary>By one of the Presets.</summary>
        public Cell(string preset) : base(Create(preset)) { }

        private Cell(Raw.pkc_cell raw) : base(raw) { }

        /// <summary>The names that the constructor knows.</summary>
        public static string[] Presets => Native.Listed(Raw.pkc_cell_preset);

        private static Raw.pkc_cell Create(string preset)
        {
            Raw.pkc_cell raw;
            Native.Check(Raw.pkc_cell_create(Native.Text(preset), out raw));
            return raw;
        }

        /// <summary>From the text of a cell.json.</summary>
        public static Cell Load(string json)
        {
            byte[] bytes = Native.Bytes(json);
            Raw.pkc_cell raw;
            Native.Check(Raw.pkc_cell_load(bytes, Native.Count(bytes), out raw));
            return new Cell(raw);
        }

        /// <summary>The same from a file. Status.IO if it cannot be read; Format or Argument name a
        /// wrong field.</summary>
        public static Cell LoadFile(string path)
        {
            Raw.pkc_cell raw;
            Native.Check(Raw.pkc_cell_load_file(Native.Text(path), out raw));
            return new Cell(raw);
        }

        /// <summary>The description as JSON text.</summary>
        public string Save()
        {
            return System.Text.Encoding.UTF8.GetString(
                Native.Filled((byte[] a, ulong n, out ulong size) =>
                    Raw.pkc_cell_save(Native.Of(this), a, n, out size)));
        }

        /// <summary>The same into a file, all or nothing.</summary>
        public void SaveFile(string path)
        {
            Native.Check(Raw.pkc_cell_save_file(Native.Of(this), Native.Text(path)));
        }

        /// <summary>What the description comes to.</summary>
        public CellInfo Info
        {
            get
            {
                var info = new CellInfo();
                Native.Check(Raw.pkc_cell_get_info(Native.Of(this), ref info.raw));
                return info;
            }
        }

        /// <summary>Throws, with zone and distance, if the arms do not reach what the scenario
        /// says.</summary>
        public void CheckReach(Scenario scenario)
        {
            Raw.pkc_scenario raw = scenario.ToRaw();
            Native.Check(Raw.pkc_cell_check(Native.Of(this), ref raw));
        }

        /// <summary>Six joints at which the arm's tool has its tip at x, y, z and is turned by yaw;
        /// for the four of a SCARA the last two are 0. Status.State if there are none.</summary>
        public double[] Inverse(int arm, double[] pose)
        {
            Require(pose, PoseNumbers, "pose");
            var joints = new double[Raw.PKC_MAX_JOINTS];
            Native.Check(Raw.pkc_cell_inverse(Native.Of(this), arm, pose, joints));
            return joints;
        }

        /// <summary>x, y, z of the tip and yaw at six joints.</summary>
        public double[] Forward(int arm, double[] joints)
        {
            Require(joints, Raw.PKC_MAX_JOINTS, "joints");
            var pose = new double[PoseNumbers];
            Native.Check(Raw.pkc_cell_forward(Native.Of(this), arm, joints, pose));
            return pose;
        }

        /// <summary>A cell with bases, buffers and homes moved for the shortest mean transfer.
        /// </summary>
        public Cell OptimizeLayout(Scenario scenario, LayoutOptions options, out LayoutInfo info)
        {
            Raw.pkc_scenario of = scenario.ToRaw();
            Raw.pkc_layout_options by = (options ?? new LayoutOptions()).raw;
            info = new LayoutInfo();
            Raw.pkc_cell raw;
            Native.Check(Raw.pkc_cell_optimize_layout(Native.Of(this), ref of, ref by,
                                                      ref info.raw, out raw));
            return new Cell(raw);
        }

        // C trusts the caller for arrays of a pinned size.
        private static void Require(double[] numbers, int size, string what)
        {
            if (numbers != null && numbers.Length != size)
                throw Native.Wrong(what + " of " + numbers.Length + " numbers: must have " + size);
        }
    }
}
