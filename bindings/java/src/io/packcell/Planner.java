package io.packcell;

import com.sun.jna.Pointer;
import com.sun.jna.ptr.IntByReference;
import com.sun.jna.ptr.PointerByReference;
import java.util.List;

/** Plans the next step. */
public final class Planner extends Handle {
    /** How a step is planned. */
    public enum Method {
        /** Algorithms 1-3 of the paper as written. */
        PAPER,
        /** The same tree, equal states once; repacking by an exact packer. */
        EXACT
    }

    /** Whether packed items may be moved. */
    public enum Repack {
        OFF,
        /** Raises the utilisation as far as the budget allows. */
        ANYTIME,
        /** Only for a plan that places every known item or fills the bin. */
        FULL
    }

    /** In select: two candidates in method PAPER with repacking, else all. */
    public static final int SELECT_AUTO = Raw.PKC_SELECT_AUTO;
    /** In select: no pruning. */
    public static final int SELECT_ALL = Raw.PKC_SELECT_ALL;
    /** In bufferCapacity. */
    public static final int UNLIMITED = Raw.PKC_UNLIMITED;

    private static final Raw LIBRARY = Raw.LIBRARY;

    /** A new one has the library's defaults. */
    public static final class Options {
        final Raw.pkc_planner_options raw = new Raw.pkc_planner_options();

        /** EXACT, rotation, no repacking, SELECT_AUTO, UNLIMITED buffers. */
        public Options() {
            Native.check(LIBRARY.pkc_planner_options_init(raw, raw.size()));
        }

        /** EXACT unless it is set. */
        public Options method(Method method) {
            raw.method = Native.code(method);
            return this;
        }

        /** Items may be turned. */
        public Options rotation(boolean rotation) {
            raw.rotation = rotation ? 1 : 0;
            return this;
        }

        /** OFF unless it is set. */
        public Options repack(Repack repack) {
            raw.repack = Native.code(repack) - 1;
            return this;
        }

        /** SELECT_AUTO, SELECT_ALL, or candidates kept a node, 1..128. */
        public Options select(int candidates) {
            raw.select = candidates;
            return this;
        }

        /** Items that an arm's buffer holds at any moment of a step, 0..4096, or UNLIMITED. */
        public Options bufferCapacity(int items) {
            raw.buffer_capacity = items;
            return this;
        }

        /** An accessible item that cannot be placed is skipped for good. */
        public Options skip(boolean skip) {
            raw.skip = skip ? 1 : 0;
            return this;
        }

        /**
         * Largest bin side, 1..128; most items in the bin, 1..16384; most recognised and buffered
         * ones together, 1..128. What is larger is LIMIT when it is planned for.
         */
        public Options limits(int maxSide, int maxItems, int maxKnown) {
            raw.max_side = maxSide;
            raw.max_items = maxItems;
            raw.max_known = maxKnown;
            return this;
        }

        /** Bytes for tables, 64 KiB..4 GiB. */
        public Options memory(long bytes) {
            raw.memory = bytes;
            return this;
        }
    }

    /** With the defaults and the default policy. */
    public Planner() {
        this(null, null);
    }

    /** Null options are the defaults, a null policy is the default one. */
    public Planner(Options options, Policy policy) {
        super(create(options, policy), LIBRARY::pkc_planner_free);
    }

    private static Pointer create(Options options, Policy policy) {
        PointerByReference out = new PointerByReference();
        Native.check(policy, p -> {
            if (p == null) Native.requireOpen(policy, "policy");
            return LIBRARY.pkc_planner_create(options == null ? null : options.raw, p, out);
        });
        return out.getValue();
    }

    /**
     * Plans the next step for what bin and queue hold; changes neither. Always legal for
     * Step.apply. With nothing on the conveyor and in the buffers that is TERMINATE. A null budget
     * is the default one.
     */
    public Plan plan(Bin bin, Queue queue, Budget budget) {
        Raw.pkc_budget raw = Budget.raw(budget);
        Native.check(this, bin, queue,
                (p, b, q) -> LIBRARY.pkc_planner_plan(p, b, q, raw, null));
        return result();
    }

    /** The same with the default budget: 200000 nodes, no time limit. */
    public Plan plan(Bin bin, Queue queue) {
        return plan(bin, queue, null);
    }

    /** The same work in slices: the state is copied, step does the work. */
    public void begin(Bin bin, Queue queue, Budget budget) {
        Raw.pkc_budget raw = Budget.raw(budget);
        Native.check(this, bin, queue, (p, b, q) -> LIBRARY.pkc_planner_begin(p, b, q, raw));
    }

    /** Spends up to so many nodes, at least 1; true when nothing is left to do. */
    public boolean step(long nodes) {
        IntByReference done = new IntByReference();
        Native.check(this, p -> LIBRARY.pkc_planner_step(p, nodes, done));
        return done.getValue() != 0;
    }

    /** The plan, or before it is done the best so far. STATE if nothing was begun. */
    public Plan result() {
        Raw.pkc_plan_info info = Plan.Info.fresh();
        List<Action> actions = Native.structsOf(this, new Raw.pkc_action(), Action::from,
                p -> (a, n, count) -> LIBRARY.pkc_planner_result(p, info, a, n, count));
        return new Plan(Plan.Info.from(info), actions);
    }

    /** From any thread: the plan being made ends at once with the best so far. */
    public void cancel() {
        Native.check(this, LIBRARY::pkc_planner_cancel);
    }
}
