package io.packcell;

/**
 * A task primitive of a step. What its op does not use is 0: PACK uses all fields, UNPACK item and
 * arm, SKIP the item, TERMINATE none.
 */
public record Action(Op op, int item, int x, int y, int rot, int arm) {
    /** What an action does, in the order of PKC_OP_*. */
    public enum Op {
        /** From the bin into the arm's buffer. */
        UNPACK,
        /** Off the conveyor or the arm's buffer into the bin. */
        PACK,
        /** Taken off the conveyor for good. */
        SKIP,
        /** The bin is closed. */
        TERMINATE
    }

    static Action from(Raw.pkc_action raw) {
        return new Action(Native.named(Op.values(), raw.op), raw.item, raw.x, raw.y, raw.rot,
                raw.arm);
    }

    void set(Raw.pkc_action raw) {
        raw.op = Native.code(op);
        raw.item = item;
        raw.x = x;
        raw.y = y;
        raw.rot = rot;
        raw.arm = arm;
    }
}
