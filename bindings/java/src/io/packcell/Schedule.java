package io.packcell;

import com.sun.jna.Pointer;
import java.util.List;

/** What the arms, the belt and the planner do and when. Seconds, metres, radians. */
public final class Schedule extends Handle {
    /** How two arms are coordinated. */
    public enum Mode {
        /** The paper's: atomic actions in common slots, one step at a time. */
        SYNC_PAPER,
        /** Asynchronous; one arm at a time over the bin. */
        ZONE_MUTEX,
        /** Asynchronous; kept apart by their footprints alone. */
        COORDINATED
    }

    /** Why an arm waits. */
    public enum Wait {
        /** No item has arrived. */
        BELT,
        /** The step is being planned. */
        PLANNING,
        /** The other arm is too near, or still at the belt. */
        OTHER_ARM,
        /** The other arm has the bin (ZONE_MUTEX). */
        BIN,
        /** The other arm has not freed the cells yet. */
        CELLS,
        /** The slot's or step's other action has not ended (SYNC_PAPER). */
        SYNC,
        /** Nothing is left to do. */
        DONE
    }

    /** What an arm does. */
    public enum Activity { TRAVEL, LOWER, GRIP, RELEASE, LIFT, WAIT }

    /** Kinds of files. */
    public enum Trace {
        /** Chrome trace events (JSON); opens in Perfetto. */
        CHROME,
        /** CSV: time, joints, tools, clearance, every period. */
        TIMELINE,
        /** CSV: set-points of arm 0 every period. */
        JOINTS_0,
        /** CSV: set-points of arm 1 every period. */
        JOINTS_1,
        /** SVG. */
        GANTT,
        /** One self-contained HTML page. */
        REPLAY
    }

    private static final Raw LIBRARY = Raw.LIBRARY;

    /**
     * Where an arm's time goes: travel, strokes down and up, gripping and letting go, and waits by
     * PKC_WAIT_*. Everything adds up to the makespan.
     */
    public record ArmTimes(double travel, double strokes, double grips, double[] waits) {
        /** Seconds of such waits. */
        public double waiting(Wait reason) {
            return waits[Native.code(reason)];
        }

        static ArmTimes from(Raw.pkc_arm_times raw) {
            return new ArmTimes(raw.travel, raw.strokes, raw.grips, raw.waits.clone());
        }
    }

    /**
     * Taken is the mode whose schedule it is, its own or a stricter one's; steps those added;
     * makespan the time until both arms are home; released when the last step's work was released;
     * belt and planning how long the belt moves and the planner plans; minClearance that between
     * the arms, -1 with one arm; milliseconds the CPU time of motion planning and coordination.
     */
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

    /** An empty one. */
    public Schedule(Cell cell, Scenario scenario, Mode mode) {
        super(create(cell, Scenario.raw(scenario), Native.code(mode)),
                LIBRARY::pkc_schedule_free);
    }

    private static Pointer create(Cell cell, Raw.pkc_scenario scenario, int mode) {
        return Native.made(cell,
                c -> out -> LIBRARY.pkc_schedule_create(c, scenario, mode, out));
    }

    /**
     * Adds a step's work; bin and queue are those before the step. STATE if it is not legal or the
     * arms block each other for good; LIMIT if a buffer has no place left.
     */
    public void addStep(Bin bin, Queue queue, List<Action> actions) {
        Native.Given<Raw.pkc_action> raw = Step.raw(actions);
        Native.check(this, bin, queue, (p, b, q) -> LIBRARY.pkc_schedule_add_step(p, b, q,
                raw.array(), raw.count()));
    }

    /**
     * The item that is let go over the bin at this time did not fit (see Simulation.places): its
     * arm takes it to its buffer. STATE if no arm lets go of it then.
     */
    public void putAside(int item, double time) {
        Native.check(this, p -> LIBRARY.pkc_schedule_put_aside(p, item, time));
    }

    /** What the steps so far come to. */
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
     * in seconds, 0.0001..10, is that of the CSV files.
     */
    public void writeTrace(Trace kind, String path, Simulation simulation, double period) {
        byte[] text = Native.toC(path);
        Native.check(this, simulation, (p, s) -> {
            if (s == null) Native.requireOpen(simulation, "simulation");
            return LIBRARY.pkc_trace_write_file(p, s, Native.code(kind), period, text);
        });
    }
}
