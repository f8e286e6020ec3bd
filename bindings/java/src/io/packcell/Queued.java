package io.packcell;

/**
 * An item on the conveyor or in a buffer. Bit 0 and bit 1 of arms say which arms can take it now;
 * if it is recognized the planner sees its size.
 */
public record Queued(Item item, int arms, boolean recognized) {
    static Queued from(Raw.pkc_queued raw) {
        return new Queued(Item.from(raw.item), raw.arms, raw.recognized != 0);
    }
}
