package io.packcell;

import com.sun.jna.ptr.LongByReference;
import java.util.List;

/** What is done with, or asked of, a list of actions. */
public final class Step {
    private Step() {}

    /** Equal for equal plans on every machine; unsigned, see Long.toHexString. */
    public static long hash(List<Action> actions) {
        LongByReference hash = new LongByReference();
        Native.Given<Raw.pkc_action> raw = raw(actions);
        Native.check(Raw.LIBRARY.pkc_plan_hash(raw.array(), raw.count(), hash));
        return hash.getValue();
    }

    /** Carries out one step's actions on bin and queue, all or nothing. */
    public static void apply(Bin bin, Queue queue, List<Action> actions) {
        Native.Given<Raw.pkc_action> raw = raw(actions);
        Native.check(bin, queue,
                (b, q) -> Raw.LIBRARY.pkc_step_apply(b, q, raw.array(), raw.count()));
    }

    /**
     * The actions with each pack from the belt given to the nearest arm that reaches it; the queue
     * is the one before the step.
     */
    public static List<Action> allocate(Cell cell, Queue queue, List<Action> actions) {
        Native.Given<Raw.pkc_action> raw = raw(actions);
        Native.check(cell, queue,
                (c, q) -> Raw.LIBRARY.pkc_allocate(c, q, raw.array(), raw.count()));
        return Native.list(raw.array(), raw.count(), Action::from);
    }

    static Native.Given<Raw.pkc_action> raw(List<Action> actions) {
        return Native.given(actions, new Raw.pkc_action(), Action::set);
    }
}
