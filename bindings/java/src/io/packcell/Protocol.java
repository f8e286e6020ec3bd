package io.packcell;

/**
 * A stream of bins that a policy packs: bins of binW x binH cells, 1..128 each; items whose sides
 * are uniform on leastSide..mostSide; and how many are offered to a bin. With 0 items the first one
 * without a position closes the bin; with 1..1000000 those without a position are skipped.
 */
public record Protocol(int binW, int binH, int leastSide, int mostSide, int items,
        Rotation rotation) {
    /** Whether items may be turned. */
    public enum Rotation {
        OFF,
        ON,
        /** Each bin draws. */
        MIXED
    }

    /** The one that the trainer's defaults play: 10 x 10, sides 1..5, each bin until it closes. */
    public static Protocol defaults() {
        Raw.pkc_trainer_options raw = fresh();
        return new Protocol(raw.bin_w, raw.bin_h, raw.least_side, raw.most_side, raw.items,
                Native.named(Rotation.values(), raw.rotation + 1));
    }

    private static Raw.pkc_trainer_options fresh() {
        Raw.pkc_trainer_options raw = new Raw.pkc_trainer_options();
        Native.check(Raw.LIBRARY.pkc_trainer_options_init(raw, raw.size()));
        return raw;
    }

    /** The defaults for null. */
    static Raw.pkc_trainer_options raw(Protocol protocol) {
        Raw.pkc_trainer_options raw = fresh();
        if (protocol == null) return raw;
        raw.bin_w = protocol.binW;
        raw.bin_h = protocol.binH;
        raw.least_side = protocol.leastSide;
        raw.most_side = protocol.mostSide;
        raw.items = protocol.items;
        raw.rotation = Native.code(protocol.rotation) - 1;
        return raw;
    }
}
