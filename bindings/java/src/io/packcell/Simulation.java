package io.packcell;

import com.sun.jna.Pointer;
import java.util.List;

/** A run of a schedule in a fresh world. */
public final class Simulation extends Handle {
    /** What became of an item. */
    public enum Outcome {
        OK,
        /** It would have come down on a wall or a neighbour: still held. */
        JAMMED,
        /** In the bin, but farther from its place than allowed. */
        MISPLACED,
        /** It had jammed before and was not put aside: nothing is let go. */
        ABSENT
    }

    private static final Raw LIBRARY = Raw.LIBRARY;

    /** A new one has the library's defaults. */
    public static final class Options {
        final Raw.pkc_simulation_options raw = new Raw.pkc_simulation_options();

        /** 240 steps a second, no deviations, no frames. */
        public Options() {
            Native.check(LIBRARY.pkc_simulation_options_init(raw, raw.size()));
        }

        /** Steps a second, 60..1000. */
        public Options hertz(int hertz) {
            raw.hertz = hertz;
            return this;
        }

        /** Standard deviations of an item's place, 0..0.05 m, and turn, 0..0.5, in the gripper. */
        public Options sigma(double metres, double yaw) {
            raw.sigma = metres;
            raw.sigma_yaw = yaw;
            return this;
        }

        /** Of the deviations: equal schedules and options give equal runs. */
        public Options seed(long seed) {
            raw.seed = seed;
            return this;
        }

        /** Keep the poses for the replay. */
        public Options frames(boolean frames) {
            raw.frames = frames ? 1 : 0;
            return this;
        }
    }

    /**
     * What became of an item that was to be put into the bin: the time of its release, and the
     * metres and radians between where it lies and where it should.
     */
    public record Place(int item, int step, int arm, Outcome outcome, double time, double error,
            double turn) {
        static Place from(Raw.pkc_place raw) {
            return new Place(raw.item, raw.step, raw.arm,
                    Native.named(Outcome.values(), raw.outcome), raw.time, raw.error, raw.turn);
        }
    }

    /**
     * worstError of an item in the bin at the end, and worstOverlap of two of them or one and a
     * wall, in metres; seconds simulated; detections: arrivals that the photo-eyes saw, missed:
     * those that they did not see; hash: of all final poses, bit for bit; milliseconds: CPU time.
     */
    public record Info(int places, int jams, int misplaced, double worstError, double worstOverlap,
            double seconds, long steps, long detections, long missed, long hash,
            double milliseconds) {}

    /** Runs what the schedule has so far, to its end; null: default options. */
    public Simulation(Schedule schedule, Options options) {
        super(create(schedule, options == null ? null : options.raw),
                LIBRARY::pkc_simulation_free);
    }

    /** With the default options. */
    public Simulation(Schedule schedule) {
        this(schedule, null);
    }

    private static Pointer create(Schedule schedule, Raw.pkc_simulation_options options) {
        return Native.made(schedule, s -> out -> LIBRARY.pkc_simulate(s, options, out));
    }

    /** What the run came to. */
    public Info info() {
        Raw.pkc_simulation_info raw = new Raw.pkc_simulation_info();
        Native.check(LIBRARY.pkc_simulation_info_init(raw, raw.size()));
        Native.check(this, p -> LIBRARY.pkc_simulation_get_info(p, raw));
        return new Info(raw.places, raw.jams, raw.misplaced, raw.worst_error, raw.worst_overlap,
                raw.seconds, raw.steps, raw.detections, raw.missed, raw.hash, raw.milliseconds);
    }

    /** In the order of their times. */
    public List<Place> places() {
        return Native.structsOf(this, new Raw.pkc_place(), Place::from,
                p -> (a, n, count) -> LIBRARY.pkc_simulation_places(p, a, n, count));
    }
}
