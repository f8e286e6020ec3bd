package io.packcell;

/** An item of w x h cells; its id, at least 0, is the caller's and unique in bin and queue. */
public record Item(int id, int w, int h, int flags) {
    /** May only be packed as it is. */
    public static final int NO_ROTATE = Raw.PKC_ITEM_NO_ROTATE;
    /** Is never unpacked. */
    public static final int PINNED = Raw.PKC_ITEM_PINNED;

    /** Without flags. */
    public Item(int id, int w, int h) {
        this(id, w, h, 0);
    }

    static Item from(Raw.pkc_item raw) {
        return new Item(raw.id, raw.w, raw.h, raw.flags);
    }

    void set(Raw.pkc_item raw) {
        raw.id = id;
        raw.w = w;
        raw.h = h;
        raw.flags = flags;
    }

    /** NULL for null: the library says what is missing. */
    static Raw.pkc_item raw(Item item) {
        if (item == null) return null;
        Raw.pkc_item raw = new Raw.pkc_item();
        item.set(raw);
        return raw;
    }
}
