package io.packcell;

/** A task primitive. What its op does not use is 0. */
public record Action(Op op, int item, int x, int y, int rot, int arm) {
    /** In the order of PKC_OP_*. */
    public enum Op { UNPACK, PACK, SKIP, TERMINATE }

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
