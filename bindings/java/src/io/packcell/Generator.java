package io.packcell;

import com.sun.jna.Pointer;
import com.sun.jna.ptr.LongByReference;
import java.util.List;

/** Streams and sets of items. */
public final class Generator extends Handle {
    /** What is generated. */
    public enum Kind {
        /** A stream of items with sides uniform on 1 to half the bin's. */
        RANDOM,
        /** Sets that fill a bin to the last cell. */
        FULL
    }

    private static final Raw LIBRARY = Raw.LIBRARY;

    /** A new one has the library's defaults; equal options give equal items. */
    public static final class Options {
        final Raw.pkc_generator_options raw = new Raw.pkc_generator_options();

        /** RANDOM, 10 x 10, preset "table", seed 1. */
        public Options() {
            Native.check(LIBRARY.pkc_generator_options_init(raw, raw.size()));
        }

        /** RANDOM unless it is set. */
        public Options kind(Kind kind) {
            raw.kind = Native.code(kind);
            return this;
        }

        /** The bin, 1..128 cells a side. */
        public Options bin(int w, int h) {
            raw.w = w;
            raw.h = h;
            return this;
        }

        /** FULL: mean of the sides as a fraction of the bin's, standard deviation in cells. */
        public Options sides(double mean, double sigma) {
            raw.mean = mean;
            raw.sigma = sigma;
            return this;
        }

        /** Equal options give equal items on every machine. */
        public Options seed(long seed) {
            raw.seed = seed;
            return this;
        }

        /** Sets mean and sigma: "text" or "table". */
        public Options preset(String name) {
            Native.check(LIBRARY.pkc_generator_preset(raw, Native.toC(name)));
            return this;
        }
    }

    /** With the default options. */
    public Generator() {
        this(null);
    }

    /** Null: default options. */
    public Generator(Options options) {
        super(create((options == null ? new Options() : options).raw),
                LIBRARY::pkc_generator_free);
    }

    private static Pointer create(Raw.pkc_generator_options options) {
        return Native.made(out -> LIBRARY.pkc_generator_create(options, out));
    }

    /**
     * RANDOM: so many items, ids counting on. FULL: the next set, of at most so many, ids from 0;
     * W * H always suffice, with fewer it may be CAPACITY.
     */
    public List<Item> next(int most) {
        if (most < 0) throw new PackcellException(most + " items: must be 0 or more");
        Raw.pkc_item[] raw = Native.structs(new Raw.pkc_item(), most);
        LongByReference count = new LongByReference();
        Native.check(this, p -> LIBRARY.pkc_generator_next(p, raw, most, count));
        return Native.list(raw, (int) count.getValue(), Item::from);
    }
}
