package io.packcell;

/** An item in a bin, its top-left corner at cell (x, y). */
public record Placement(Item item, int x, int y, int rot) {
    static Placement from(Raw.pkc_placement raw) {
        return new Placement(Item.from(raw.item), raw.x, raw.y, raw.rot);
    }
}
