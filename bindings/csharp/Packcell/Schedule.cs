// What the arms, the belt and the planner do and when. Seconds, metres, radians.
using System;
using System.Collections.Generic;

namespace Packcell
{
    /// <summary>How two arms are coordinated.</summary>
    public enum Mode
    {
        /// <summary>The paper's: atomic actions in common slots, one step at a time.</summary>
        SyncPaper = Raw.PKC_MODE_SYNC_PAPER,
        /// <summary>Asynchronous; one arm at a time over the bin.</summary>
        ZoneMutex = Raw.PKC_MODE_ZONE_MUTEX,
        /// <summary>Asynchronous; kept apart by their footprints alone.</summary>
        Coordinated = Raw.PKC_MODE_COORDINATED
    }

    /// <summary>Why an arm waits.</summary>
    public enum Wait
    {
        None = 0,
        /// <summary>No item has arrived.</summary>
        Belt = Raw.PKC_WAIT_BELT,
        /// <summary>The step is being planned.</summary>
        Planning = Raw.PKC_WAIT_PLANNING,
        /// <summary>The other arm is too near, or still at the belt.</summary>
        OtherArm = Raw.PKC_WAIT_OTHER_ARM,
        /// <summary>The other arm has the bin (ZoneMutex).</summary>
        Bin = Raw.PKC_WAIT_BIN,
        /// <summary>The other arm has not freed the cells yet.</summary>
        Cells = Raw.PKC_WAIT_CELLS,
        /// <summary>The slot's or step's other action has not ended (SyncPaper).</summary>
        Sync = Raw.PKC_WAIT_SYNC,
        /// <summary>Nothing is left to do.</summary>
        Done = Raw.PKC_WAIT_DONE
    }

    /// <summary>What an arm does.</summary>
    public enum Activity
    {
        Travel = Raw.PKC_ACTIVITY_TRAVEL,
        Lower = Raw.PKC_ACTIVITY_LOWER,
        Grip = Raw.PKC_ACTIVITY_GRIP,
        Release = Raw.PKC_ACTIVITY_RELEASE,
        Lift = Raw.PKC_ACTIVITY_LIFT,
        Wait = Raw.PKC_ACTIVITY_WAIT
    }

    /// <summary>Where an arm's time goes; everything adds up to the makespan.</summary>
    public sealed class ArmTimes
    {
        private readonly Raw.pkc_arm_times raw;

        internal ArmTimes(Raw.pkc_arm_times raw)
        {
            this.raw = raw;
        }

        public double Travel => raw.travel;
        /// <summary>Down and up.</summary>
        public double Strokes => raw.strokes;
        /// <summary>Gripping and letting go.</summary>
        public double Grips => raw.grips;

        /// <summary>Seconds of such waits.</summary>
        public double Waiting(Wait reason)
        {
            Raw.double_x8 waits = raw.waits;
            return waits[(int)reason];
        }
    }

    /// <summary>What the steps so far come to.</summary>
    public sealed class ScheduleInfo
    {
        internal Raw.pkc_schedule_info raw;

        internal ScheduleInfo()
        {
            Native.Check(Raw.pkc_schedule_info_init(ref raw, Native.Size<Raw.pkc_schedule_info>()));
        }

        public Mode Mode => (Mode)raw.mode;
        /// <summary>Mode whose schedule it is: its own or a stricter one's.</summary>
        public Mode Taken => (Mode)raw.taken;
        public int Steps => raw.steps;
        /// <summary>Until both arms are home.</summary>
        public double Makespan => raw.makespan;
        public double LowerBound => raw.lower_bound;
        /// <summary>When the last step's work was released.</summary>
        public double Released => raw.released;
        /// <summary>In which the belt moves.</summary>
        public double Belt => raw.belt;
        /// <summary>Of planning, as the cell's description has them.</summary>
        public double Planning => raw.planning;
        /// <summary>-1 with one arm.</summary>
        public double MinClearance => raw.min_clearance;
        /// <summary>Of the schedule, times to the microsecond.</summary>
        public ulong Hash => raw.hash;
        /// <summary>Of the coordination search.</summary>
        public ulong Nodes => raw.nodes;
        /// <summary>CPU time of motion planning and coordination.</summary>
        public double Milliseconds => raw.milliseconds;

        public ArmTimes[] Arms => new[] { new ArmTimes(raw.arms[0]), new ArmTimes(raw.arms[1]) };
    }

    /// <summary>An arm at a time.</summary>
    public sealed class ArmSample
    {
        private readonly Raw.pkc_arm_sample raw;

        internal ArmSample(Raw.pkc_arm_sample raw)
        {
            this.raw = raw;
        }

        /// <summary>Of six joints.</summary>
        public double[] Position => Numbers(raw.position);
        public double[] Velocity => Numbers(raw.velocity);
        public double[] Acceleration => Numbers(raw.acceleration);

        /// <summary>x, y, z of the tip, yaw.</summary>
        public double[] Tool
        {
            get
            {
                Raw.double_x4 tool = raw.tool;
                return new[] { tool[0], tool[1], tool[2], tool[3] };
            }
        }

        /// <summary>Half the diagonal of the item in the gripper; 0: none.</summary>
        public double Held => raw.held;
        /// <summary>-1: none.</summary>
        public int Item => raw.item;
        public int Step => raw.step;
        public Activity Activity => (Activity)raw.activity;
        /// <summary>Of a wait, else None.</summary>
        public Wait Reason => (Wait)raw.reason;

        private static double[] Numbers(Raw.double_x6 from)
        {
            var numbers = new double[Raw.double_x6.Length];
            for (int i = 0; i < numbers.Length; ++i)
                numbers[i] = from[i];
            return numbers;
        }
    }

    /// <summary>Kinds of files.</summary>
    public enum Trace
    {
        /// <summary>Chrome trace events (JSON); opens in Perfetto.</summary>
        Chrome = Raw.PKC_TRACE_CHROME,
        /// <summary>CSV: time, joints, tools, clearance, every period.</summary>
        Timeline = Raw.PKC_TRACE_TIMELINE,
        /// <summary>CSV: set-points of arm 0 every period.</summary>
        Joints0 = Raw.PKC_TRACE_JOINTS_0,
        /// <summary>CSV: set-points of arm 1 every period.</summary>
        Joints1 = Raw.PKC_TRACE_JOINTS_1,
        /// <summary>SVG.</summary>
        Gantt = Raw.PKC_TRACE_GANTT,
        /// <summary>One self-contained HTML page.</summary>
        Replay = Raw.PKC_TRACE_REPLAY
    }

    /// <summary>What the arms, the belt and the planner do and when.</summary>
    public sealed class Schedule : Handle<Raw.pkc_schedule>
    {
        /// <summary>An empty one.</summary>
        public Schedule(Cell cell, Scenario scenario, Mode mode)
            : base(Create(cell, scenario, mode)) { }

        private static Raw.pkc_schedule Create(Cell cell, Scenario scenario, Mode mode)
        {
            Raw.pkc_scenario of = scenario.ToRaw();
            Raw.pkc_schedule raw;
            Native.Check(Raw.pkc_schedule_create(Native.Of(cell), ref of, (int)mode, out raw));
            return raw;
        }

        /// <summary>Adds a step's work; bin and queue are those before the step. Status.State if it
        /// is not legal or the arms block each other for good; Limit if a buffer has no place
        /// left.</summary>
        public void AddStep(Bin bin, Queue queue, IReadOnlyList<PlanAction> actions)
        {
            Raw.pkc_action[] raw = Native.Map(actions, PlanAction.ToRaw);
            Native.Check(Raw.pkc_schedule_add_step(Native.Of(this), Native.Of(bin),
                                                   Native.Of(queue), raw, Native.Count(raw)));
        }

        /// <summary>The item that is let go over the bin at this time did not fit (see
        /// Simulation.Places): its arm takes it to its buffer. Status.State if no arm lets go of it
        /// then.</summary>
        public void PutAside(int item, double time)
        {
            Native.Check(Raw.pkc_schedule_put_aside(Native.Of(this), item, time));
        }

        /// <summary>What the steps so far come to.</summary>
        public ScheduleInfo Info
        {
            get
            {
                var info = new ScheduleInfo();
                Native.Check(Raw.pkc_schedule_get_info(Native.Of(this), ref info.raw));
                return info;
            }
        }

        /// <summary>At a time of 0..makespan.</summary>
        public ArmSample Sample(int arm, double time)
        {
            var raw = new Raw.pkc_arm_sample();
            Native.Check(Raw.pkc_schedule_sample(Native.Of(this), arm, time, ref raw));
            return new ArmSample(raw);
        }

        /// <summary>Writes the schedule, all or nothing, with the poses of a run if there is one;
        /// the period, in seconds, 0.0001..10, is that of the CSV files.</summary>
        public void WriteTrace(Trace kind, string path, Simulation simulation = null,
                               double period = 0.01)
        {
            Native.Check(Raw.pkc_trace_write_file(Native.Of(this),
                                                  Native.OrNone(simulation, "simulation"),
                                                  (int)kind, period, Native.Text(path)));
        }
    }
}
