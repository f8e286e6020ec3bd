package io.packcell;

import com.sun.jna.ptr.IntByReference;
import com.sun.jna.ptr.LongByReference;
import java.util.List;

/** Packs exactly; bounds what can be packed. */
public final class ExactPacker {
    /** BUDGET: not decided within it. */
    public enum Answer { FOUND, IMPOSSIBLE, BUDGET }

    /** The placements are in the items' order if FOUND, else there are none. */
    public record Packing(Answer answer, long nodes, List<Placement> placements) {}

    /** With BUDGET the count is an upper bound only. */
    public record Bound(long count, Answer answer) {}

    private ExactPacker() {}

    /** Can all items be placed on the bin's free cells? A null budget is the default one. */
    public static Packing pack(Bin bin, List<Item> items, boolean rotation, Budget budget) {
        Raw.pkc_item[] raw = raw(items);
        Raw.pkc_budget of = Budget.raw(budget);
        Raw.pkc_placement[] placements =
                Native.structs(new Raw.pkc_placement(), (int) Native.count(items));
        IntByReference answer = new IntByReference();
        LongByReference nodes = new LongByReference();
        Native.check(bin, b -> Raw.LIBRARY.pkc_exact_pack(b, raw, Native.count(items),
                rotation ? 1 : 0, of, placements, answer, nodes));
        int found = answer.getValue() == Raw.PKC_PACKING_FOUND ? items.size() : 0;
        return new Packing(Native.named(Answer.values(), answer.getValue()), nodes.getValue(),
                Native.list(placements, found, Placement::from));
    }

    /** How many of the next items, in order and without one left out, fit. */
    public static Bound boundInOrder(Bin bin, List<Item> items, boolean rotation, Budget budget) {
        Raw.pkc_item[] raw = raw(items);
        Raw.pkc_budget of = Budget.raw(budget);
        LongByReference count = new LongByReference();
        IntByReference answer = new IntByReference();
        Native.check(bin, b -> Raw.LIBRARY.pkc_bound_in_order(b, raw, Native.count(items),
                rotation ? 1 : 0, of, count, answer));
        return new Bound(count.getValue(), Native.named(Answer.values(), answer.getValue()));
    }

    private static Raw.pkc_item[] raw(List<Item> items) {
        return Native.given(items, new Raw.pkc_item(), Item::set);
    }
}
