package io.packcell;

import com.sun.jna.Pointer;
import com.sun.jna.ptr.FloatByReference;
import com.sun.jna.ptr.IntByReference;
import com.sun.jna.ptr.LongByReference;
import java.util.List;

/** The low level: where an item goes. Immutable; may be shared by threads. */
public final class Policy extends Handle {
    private static final Raw LIBRARY = Raw.LIBRARY;

    /** The architecture is PKC_ARCH_*; utilization -1: not measured; bins 0 x 0: any. */
    public record Info(int architecture, int binW, int binH, long parameters, long seed, long steps,
            double rewardFill, double utilization, String learner) {}

    /** By position, the last for "no position"; and the value of the bin. */
    public record Evaluation(float[] logits, float[] probabilities, float value) {}

    /** By one of the builtin names. */
    public Policy(String name) {
        this(create(Native.text(name)));
    }

    private Policy(Pointer pointer) {
        super(pointer, LIBRARY::pkc_policy_free);
    }

    private static Pointer create(String name) {
        return Native.made(out -> LIBRARY.pkc_policy_create(name, out));
    }

    public static List<String> builtin() {
        return Native.listed(LIBRARY::pkc_policy_builtin);
    }

    /** From a weight blob (.pkw). */
    public static Policy load(byte[] blob) {
        return new Policy(
                Native.made(out -> LIBRARY.pkc_policy_load(blob, Native.count(blob), out)));
    }

    public static Policy loadFile(String path) {
        String text = Native.text(path);
        return new Policy(Native.made(out -> LIBRARY.pkc_policy_load_file(text, out)));
    }

    /** The weight blob; heuristics have none. */
    public byte[] save() {
        return Native.bytesOf(this, p -> (a, n, size) -> LIBRARY.pkc_policy_save(p, a, n, size));
    }

    public void saveFile(String path) {
        String text = Native.text(path);
        Native.check(this, p -> LIBRARY.pkc_policy_save_file(p, text));
    }

    /** Empty for a closed one. */
    public String name() {
        String[] name = new String[1];
        Native.check(this, p -> {
            name[0] = LIBRARY.pkc_policy_name(p);
            return Raw.PKC_OK;
        });
        return name[0];
    }

    public Info info() {
        Raw.pkc_policy_info raw = new Raw.pkc_policy_info();
        Native.check(LIBRARY.pkc_policy_info_init(raw, raw.size()));
        Native.check(this, p -> LIBRARY.pkc_policy_get_info(p, raw));
        return new Info(raw.architecture, raw.bin_w, raw.bin_h, raw.parameters, raw.seed, raw.steps,
                raw.reward_fill, raw.utilization, Native.text(raw.learner));
    }

    /**
     * The position x + y * W for an item that covers w x h cells as it is turned; W * H is "no
     * position".
     */
    public int select(Bin bin, int w, int h) {
        IntByReference position = new IntByReference();
        Native.check(this, bin, (p, b) -> LIBRARY.pkc_policy_select(p, b, w, h, position));
        return position.getValue();
    }

    /** What actor and critic say; heuristics say nothing. */
    public Evaluation evaluate(Bin bin, int w, int h) {
        Raw.pkc_bin_info info = new Raw.pkc_bin_info();
        Native.check(LIBRARY.pkc_bin_info_init(info, info.size()));
        Native.check(bin, b -> LIBRARY.pkc_bin_get_info(b, info));
        int positions = info.w * info.h + 1;
        float[] logits = new float[positions];
        float[] probabilities = new float[positions];
        LongByReference count = new LongByReference();
        FloatByReference value = new FloatByReference();
        Native.check(this, bin, (p, b) -> LIBRARY.pkc_policy_evaluate(p, b, w, h, logits,
                probabilities, positions, count, value));
        return new Evaluation(logits, probabilities, value.getValue());
    }

    /**
     * The positions for many pairs of a bin and an item of sizes[2*i] x sizes[2*i + 1] cells,
     * faster than one by one. All bins have the same sides.
     */
    public int[] selectBatch(List<Bin> bins, int[] sizes) {
        int count = bins == null ? 0 : bins.size();
        if (sizes == null || sizes.length != 2L * count)
            throw new PackcellException((sizes == null ? 0 : sizes.length) + " sizes for " + count
                    + " bins: must be two a bin");
        Bin[] entered = new Bin[count];
        Pointer[] raw = new Pointer[count];
        int[] positions = new int[count];
        try {
            for (int i = 0; i < count; ++i) {
                entered[i] = bins.get(i);
                raw[i] = Native.enter(entered[i]);
            }
            Native.check(this, p -> LIBRARY.pkc_policy_evaluate_batch(p, raw, sizes, count,
                    positions, null, null));
        } finally {
            for (int i = 0; i < count; ++i) Native.leave(entered[i], raw[i]);
        }
        return positions;
    }
}
