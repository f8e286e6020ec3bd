package io.packcell;

import com.sun.jna.ptr.IntByReference;
import com.sun.jna.ptr.LongByReference;
import java.util.List;

/** Packs exactly; bounds what can be packed. */
public final class ExactPacker {
    /** What is known. */
    public enum Answer {
        /** All items fit, or the count is exact. */
        FOUND,
        /** They do not all fit. */
        IMPOSSIBLE,
        /** Not decided within the budget. */
        BUDGET
    }

    /** The placements are in the items' order if FOUND, else there are none. */
    public record Packing(Answer answer, long nodes, List<Placement> placements) {}

    /** With BUDGET the count is an upper bound only. */
    public record Bound(long count, Answer answer) {}

    private ExactPacker() {}

    /**
     * Can all items, 16384 at most, be placed on the bin's free cells without moving what is there?
     * A null budget is the default one.
     */
    public static Packing pack(Bin bin, List<Item> items, boolean rotation, Budget budget) {
        Native.Given<Raw.pkc_item> raw = raw(items);
        Raw.pkc_budget of = Budget.raw(budget);
        Raw.pkc_placement[] placements =
                Native.structs(new Raw.pkc_placement(), raw.count());
        IntByReference answer = new IntByReference();
        LongByReference nodes = new LongByReference();
        Native.check(bin, b -> Raw.LIBRARY.pkc_exact_pack(b, raw.array(), raw.count(),
                rotation ? 1 : 0, of, placements, answer, nodes));
        int found = answer.getValue() == Raw.PKC_PACKING_FOUND ? raw.count() : 0;
        return new Packing(Native.named(Answer.values(), answer.getValue()), nodes.getValue(),
                Native.list(placements, found, Placement::from));
    }

    /**
     * How many of the next items, in order and without one left out, fit: no planner without a
     * buffer packs more of them into this bin.
     */
    public static Bound boundInOrder(Bin bin, List<Item> items, boolean rotation, Budget budget) {
        Native.Given<Raw.pkc_item> raw = raw(items);
        Raw.pkc_budget of = Budget.raw(budget);
        LongByReference count = new LongByReference();
        IntByReference answer = new IntByReference();
        Native.check(bin, b -> Raw.LIBRARY.pkc_bound_in_order(b, raw.array(), raw.count(),
                rotation ? 1 : 0, of, count, answer));
        return new Bound(count.getValue(), Native.named(Answer.values(), answer.getValue()));
    }

    private static Native.Given<Raw.pkc_item> raw(List<Item> items) {
        return Native.given(items, new Raw.pkc_item(), Item::set);
    }
}
