package io.packcell;

import com.sun.jna.Pointer;
import com.sun.jna.ptr.IntByReference;
import java.util.List;

/** A bin of cells and what lies in it. */
public final class Bin extends Handle {
    /** In cells: no item is there. */
    public static final int FREE_CELL = Raw.PKC_CELL_FREE;
    /** In cells: taken by block. */
    public static final int FIXED_CELL = Raw.PKC_CELL_FIXED;

    private static final Raw LIBRARY = Raw.LIBRARY;

    /** The hash is that of the occupied cells, fixed ones and items. */
    public record Info(int w, int h, int items, int occupiedCells, int fixedCells, long hash) {}

    /** An empty bin of w x h cells, each 1..128. */
    public Bin(int w, int h) {
        this(Native.made(out -> LIBRARY.pkc_bin_create(w, h, out)));
    }

    Bin(Pointer pointer) {
        super(pointer, LIBRARY::pkc_bin_free);
    }

    /** A bin of its own with the same items and fixed cells. */
    public Bin copy() {
        return new Bin(Native.made(this, p -> out -> LIBRARY.pkc_bin_clone(p, out)));
    }

    /** Removes every item; fixed cells stay. */
    public void clear() {
        Native.check(this, LIBRARY::pkc_bin_clear);
    }

    /** Marks free cells as taken from the start. STATE if one of the w x h at (x, y) is taken. */
    public void block(int x, int y, int w, int h) {
        Native.check(this, p -> LIBRARY.pkc_bin_block(p, x, y, w, h));
    }

    /**
     * Puts an item, turned by a quarter if rot is 1, with its top-left corner at (x, y). STATE if
     * it does not lie on free cells alone, its id is in the bin already, or it must not be turned.
     */
    public void pack(Item item, int x, int y, int rot) {
        Raw.pkc_item raw = Item.raw(item);
        Native.check(this, p -> LIBRARY.pkc_bin_pack(p, raw, x, y, rot));
    }

    /** The same, not turned. */
    public void pack(Item item, int x, int y) {
        pack(item, x, y, 0);
    }

    /** Takes an item out, and says where it was. STATE if it is not there or is pinned. */
    public Placement unpack(int id) {
        Raw.pkc_placement raw = new Raw.pkc_placement();
        Native.check(this, p -> LIBRARY.pkc_bin_unpack(p, id, raw));
        return Placement.from(raw);
    }

    /** What is in the bin now. */
    public Info info() {
        Raw.pkc_bin_info raw = new Raw.pkc_bin_info();
        Native.check(LIBRARY.pkc_bin_info_init(raw, raw.size()));
        Native.check(this, p -> LIBRARY.pkc_bin_get_info(p, raw));
        return new Info(raw.w, raw.h, raw.items, raw.occupied_cells, raw.fixed_cells, raw.hash);
    }

    /** In packing order. */
    public List<Placement> items() {
        return Native.structsOf(this, new Raw.pkc_placement(), Placement::from,
                p -> (a, n, count) -> LIBRARY.pkc_bin_items(p, a, n, count));
    }

    /** By index x + y * W: the id of the item there, FREE_CELL or FIXED_CELL. */
    public int[] cells() {
        Native.Filled<int[]> filled = new Native.Filled<>(int[]::new);
        Native.check(this,
                p -> filled.fill((a, n, count) -> LIBRARY.pkc_bin_cells(p, a, n, count)));
        return filled.array;
    }

    /**
     * W*H + 1 answers: may the corner of an item that covers w x h cells lie there? The last is "no
     * position", true only when no other is.
     */
    public boolean[] feasible(int w, int h) {
        byte[] mask = Native.bytesOf(this,
                p -> (a, n, count) -> LIBRARY.pkc_bin_feasible(p, w, h, a, n, count));
        boolean[] answers = new boolean[mask.length];
        for (int i = 0; i < mask.length; ++i) answers[i] = mask[i] != 0;
        return answers;
    }

    /**
     * The contact reward: occupied cells, walls included, around a w x h rectangle at (x, y),
     * 0..2(w+h). STATE if the rectangle is not free.
     */
    public int contact(int x, int y, int w, int h) {
        IntByReference reward = new IntByReference();
        Native.check(this, p -> LIBRARY.pkc_bin_contact(p, x, y, w, h, reward));
        return reward.getValue();
    }
}
