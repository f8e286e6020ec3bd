package io.packcell;

import com.sun.jna.Pointer;
import java.util.List;

/** What the arms, the belt and the planner do and when. Seconds, metres, radians. */
public final class Schedule extends Handle {
    /** How two arms are coordinated. */
    public enum Mode { SYNC_PAPER, ZONE_MUTEX, COORDINATED }

    /** Why an arm waits. */
    public enum Wait { BELT, PLANNING, OTHER_ARM, BIN, CELLS, SYNC, DONE }

    public enum Activity { TRAVEL, LOWER, GRIP, RELEASE, LIFT, WAIT }

    public enum Trace { CHROME, TIMELINE, JOINTS_0, JOINTS_1, GANTT, REPLAY }

    private static final Raw LIBRARY = Raw.LIBRARY;

    /** Where an arm's time goes; everything adds up to the makespan. */
    public record ArmTimes(double travel, double strokes, double grips, double[] waits) {
        public double waiting(Wait reason) {
            return waits[Native.code(reason)];
        }

        static ArmTimes from(Raw.pkc_arm_times raw) {
            return new ArmTimes(raw.travel, raw.strokes, raw.grips, raw.waits.clone());
        }
    }

    /** Taken is the mode whose schedule it is; the clearance is -1 with one arm. */
    public record Info(Mode mode, Mode taken, int steps, double makespan, double lowerBound,
            double released, double belt, double planning, double minClearance,
            List<ArmTimes> arms, long hash, long nodes, double milliseconds) {}

    /**
     * An arm at a time: set-points of six joints; x, y, z of the tool's tip and yaw; half the
     * diagonal of the item that is held (0: none); the item (-1: none). A reason is there in a
     * wait, else null.
     */
    public record Sample(double[] position, double[] velocity, double[] acceleration, double[] tool,
            double held, int item, int step, Activity activity, Wait reason) {}

    public Schedule(Cell cell, Scenario scenario, Mode mode) {
        super(create(cell, Scenario.raw(scenario), Native.code(mode)),
                LIBRARY::pkc_schedule_free);
    }

    private static Pointer create(Cell cell, Raw.pkc_scenario scenario, int mode) {
        return Native.made(cell,
                c -> out -> LIBRARY.pkc_schedule_create(c, scenario, mode, out));
    }

    /** Adds a step's work; bin and queue are those before the step. */
    public void addStep(Bin bin, Queue queue, List<Action> actions) {
        Raw.pkc_action[] raw = Step.raw(actions);
        Native.check(this, bin, queue, (p, b, q) -> LIBRARY.pkc_schedule_add_step(p, b, q, raw,
                Native.count(actions)));
    }

    /** The item let go at this time did not fit: its arm takes it to its buffer. */
    public void putAside(int item, double time) {
        Native.check(this, p -> LIBRARY.pkc_schedule_put_aside(p, item, time));
    }

    public Info info() {
        Raw.pkc_schedule_info raw = new Raw.pkc_schedule_info();
        Native.check(LIBRARY.pkc_schedule_info_init(raw, raw.size()));
        Native.check(this, p -> LIBRARY.pkc_schedule_get_info(p, raw));
        return new Info(Native.named(Mode.values(), raw.mode),
                Native.named(Mode.values(), raw.taken), raw.steps, raw.makespan, raw.lower_bound,
                raw.released, raw.belt, raw.planning, raw.min_clearance,
                Native.list(raw.arms, raw.arms.length, ArmTimes::from), raw.hash, raw.nodes,
                raw.milliseconds);
    }

    /** At a time of 0..makespan. */
    public Sample sample(int arm, double time) {
        Raw.pkc_arm_sample raw = new Raw.pkc_arm_sample();
        Native.check(this, p -> LIBRARY.pkc_schedule_sample(p, arm, time, raw));
        return new Sample(raw.position.clone(), raw.velocity.clone(), raw.acceleration.clone(),
                raw.tool.clone(), raw.held, raw.item, raw.step,
                Native.named(Activity.values(), raw.activity),
                Native.named(Wait.values(), raw.reason));
    }

    /**
     * Writes the schedule, all or nothing, with the poses of a run if that is not null; the period,
     * in seconds, is that of the CSV files.
     */
    public void writeTrace(Trace kind, String path, Simulation simulation, double period) {
        String text = Native.text(path);
        Native.check(this, simulation, (p, s) -> {
            if (s == null) Native.requireOpen(simulation, "simulation");
            return LIBRARY.pkc_trace_write_file(p, s, Native.code(kind), period, text);
        });
    }
}
