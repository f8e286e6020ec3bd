// A run of a schedule in a fresh world.
namespace Packcell
{
    /// <summary>A new one has the library's defaults: 240 steps a second, no deviations, no
    /// frames.</summary>
    public sealed class SimulationOptions
    {
        internal Raw.pkc_simulation_options raw;

        public SimulationOptions()
        {
            Native.Check(Raw.pkc_simulation_options_init(
                ref raw, Native.Size<Raw.pkc_simulation_options>()));
        }

        /// <summary>Steps a second, 60..1000.</summary>
        public int Hertz { get => raw.hertz; set => raw.hertz = value; }
        /// <summary>Standard deviation of an item's place in the gripper, 0..0.05 m.</summary>
        public double Sigma { get => raw.sigma; set => raw.sigma = value; }
        /// <summary>And of its turn, 0..0.5.</summary>
        public double SigmaYaw { get => raw.sigma_yaw; set => raw.sigma_yaw = value; }
        /// <summary>Equal schedules and options give equal runs.</summary>
        public ulong Seed { get => raw.seed; set => raw.seed = value; }
        /// <summary>Keep the poses for the replay.</summary>
        public bool Frames { get => raw.frames != 0; set => raw.frames = value ? 1 : 0; }
    }

    /// <summary>What became of an item.</summary>
    public enum Outcome
    {
        Ok = Raw.PKC_PLACE_OK,
        /// <summary>It would have come down on a wall or a neighbour: still held.</summary>
        Jammed = Raw.PKC_PLACE_JAMMED,
        /// <summary>In the bin, but farther from its place than allowed.</summary>
        Misplaced = Raw.PKC_PLACE_MISPLACED,
        /// <summary>It had jammed and was not put aside: nothing is let go.</summary>
        Absent = Raw.PKC_PLACE_ABSENT
    }

    /// <summary>What became of an item that was to be put into the bin.</summary>
    public struct Place
    {
        public int Item, Step, Arm;
        public Outcome Outcome;
        /// <summary>Of the release, seconds.</summary>
        public double Time;
        /// <summary>Metres between where it lies and where it should.</summary>
        public double Error;
        /// <summary>Radians between how it lies and how it should.</summary>
        public double Turn;

        internal static Place From(Raw.pkc_place raw) => new Place {
            Item = raw.item, Step = raw.step, Arm = raw.arm, Outcome = (Outcome)raw.outcome,
            Time = raw.time, Error = raw.error, Turn = raw.turn
        };
    }

    /// <summary>What a run came to.</summary>
    public sealed class SimulationInfo
    {
        internal Raw.pkc_simulation_info raw;

        internal SimulationInfo()
        {
            Native.Check(Raw.pkc_simulation_info_init(ref raw,
                                                      Native.Size<Raw.pkc_simulation_info>()));
        }

        public int Places => raw.places;
        public int Jams => raw.jams;
        public int Misplaced => raw.misplaced;
        /// <summary>Metres, of an item in the bin at the end.</summary>
        public double WorstError => raw.worst_error;
        /// <summary>Metres by which two of them, or one and a wall, overlap.</summary>
        public double WorstOverlap => raw.worst_overlap;
        /// <summary>Simulated.</summary>
        public double Seconds => raw.seconds;
        public ulong Steps => raw.steps;
        /// <summary>Arrivals that the photo-eyes saw.</summary>
        public ulong Detections => raw.detections;
        /// <summary>And those that they did not see.</summary>
        public ulong Missed => raw.missed;
        /// <summary>Of all final poses, bit for bit.</summary>
        public ulong Hash => raw.hash;
        /// <summary>CPU time of the run.</summary>
        public double Milliseconds => raw.milliseconds;
    }

    /// <summary>A run of a schedule in a fresh world.</summary>
    public sealed class Simulation : Handle<Raw.pkc_simulation>
    {
        /// <summary>Runs what the schedule has so far, to its end.</summary>
        public Simulation(Schedule schedule, SimulationOptions options = null)
            : base(Create(schedule, options)) { }

        private static Raw.pkc_simulation Create(Schedule schedule, SimulationOptions options)
        {
            Raw.pkc_simulation_options of = (options ?? new SimulationOptions()).raw;
            Raw.pkc_simulation raw;
            Native.Check(Raw.pkc_simulate(Native.Of(schedule), ref of, out raw));
            return raw;
        }

        /// <summary>What the run came to.</summary>
        public SimulationInfo Info
        {
            get
            {
                var info = new SimulationInfo();
                Native.Check(Raw.pkc_simulation_get_info(Native.Of(this), ref info.raw));
                return info;
            }
        }

        /// <summary>In the order of their times.</summary>
        public Place[] Places()
        {
            return Native.Map(Native.Filled((Raw.pkc_place[] a, ulong n, out ulong count) =>
                Raw.pkc_simulation_places(Native.Of(this), a, n, out count)), Place.From);
        }
    }
}
