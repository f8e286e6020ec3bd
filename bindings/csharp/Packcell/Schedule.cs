// What the arms, the belt and the planner do and when. Seconds, metres, radians.
using System;
using System.Collections.Generic;

namespace Packcell
{
    /// <summary>How two arms are coordinated.</summary>
    public enum Mode
    {
        SyncPaper = Raw.PKC_MODE_SYNC_PAPER,
        ZoneMutex = Raw.PKC_MODE_ZONE_MUTEX,
        Coordinated = Raw.PKC_MODE_COORDINATED
    }

    /// <summary>Why an arm waits.</summary>
    public enum Wait
    {
        None = 0,
        Belt = Raw.PKC_WAIT_BELT,
        Planning = Raw.PKC_WAIT_PLANNING,
        OtherArm = Raw.PKC_WAIT_OTHER_ARM,
        Bin = Raw.PKC_WAIT_BIN,
        Cells = Raw.PKC_WAIT_CELLS,
        Sync = Raw.PKC_WAIT_SYNC,
        Done = Raw.PKC_WAIT_DONE
    }

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
        public double Strokes => raw.strokes;
        public double Grips => raw.grips;

        public double Waiting(Wait reason)
        {
            Raw.double_x8 waits = raw.waits;
            return waits[(int)reason];
        }
    }

    public sealed class ScheduleInfo
    {
        internal Raw.pkc_schedule_info raw;

        internal ScheduleInfo()
        {
            Native.Check(Raw.pkc_schedule_info_init(ref raw, Native.Size<Raw.pkc_schedule_info>()));
        }

        public Mode Mode => (Mode)raw.mode;
        /// <summary>Mode whose schedule it is.</summary>
        public Mode Taken => (Mode)raw.taken;
        public int Steps => raw.steps;
        public double Makespan => raw.makespan;
        public double LowerBound => raw.lower_bound;
        public double Released => raw.released;
        public double Belt => raw.belt;
        public double Planning => raw.planning;
        /// <summary>-1 with one arm.</summary>
        public double MinClearance => raw.min_clearance;
        public ulong Hash => raw.hash;
        public ulong Nodes => raw.nodes;
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
        public Wait Reason => (Wait)raw.reason;

        private static double[] Numbers(Raw.double_x6 from)
        {
            var numbers = new double[Raw.double_x6.Length];
            for (int i = 0; i < numbers.Length; ++i)
                numbers[i] = from[i];
            return numbers;
        }
    }

    public enum Trace
    {
        Chrome = Raw.PKC_TRACE_CHROME,
        Timeline = Raw.PKC_TRACE_TIMELINE,
        Joints0 = Raw.PKC_TRACE_JOINTS_0,
        Joints1 = Raw.PKC_TRACE_JOINTS_1,
        Gantt = Raw.PKC_TRACE_GANTT,
        Replay = Raw.PKC_TRACE_REPLAY
    }

    public sealed class Schedule : Handle<Raw.pkc_schedule>
    {
        public Schedule(Cell cell, Scenario scenario, Mode mode)
            : base(Create(cell, scenario, mode)) { }

        private static Raw.pkc_schedule Create(Cell cell, Scenario scenario, Mode mode)
        {
            Raw.pkc_scenario of = scenario.ToRaw();
            Raw.pkc_schedule raw;
            Native.Check(Raw.pkc_schedule_create(Native.Of(cell), ref of, (int)mode, out raw));
            return raw;
        }

        /// <summary>Adds a step's work; bin and queue are those before the step.</summary>
        public void AddStep(Bin bin, Queue queue, IReadOnlyList<PlanAction> actions)
        {
            Raw.pkc_action[] raw = Native.Map(actions, PlanAction.ToRaw);
            Native.Check(Raw.pkc_schedule_add_step(Native.Of(this), Native.Of(bin),
                                                   Native.Of(queue), raw, Native.Count(raw)));
        }

        /// <summary>The item let go at this time did not fit: its arm takes it to its buffer.
        /// </summary>
        public void PutAside(int item, double time)
        {
            Native.Check(Raw.pkc_schedule_put_aside(Native.Of(this), item, time));
        }

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
        /// the period, in seconds, is that of the CSV files.</summary>
        public void WriteTrace(Trace kind, string path, Simulation simulation = null,
                               double period = 0.01)
        {
            Native.Check(Raw.pkc_trace_write_file(Native.Of(this),
                                                  Native.OrNone(simulation, "simulation"),
                                                  (int)kind, period, Native.Text(path)));
        }
    }
}
