package io.packcell;

import com.sun.jna.Pointer;
import com.sun.jna.ptr.DoubleByReference;
import com.sun.jna.ptr.FloatByReference;
import com.sun.jna.ptr.IntByReference;
import com.sun.jna.ptr.LongByReference;
import java.util.ArrayList;
import java.util.List;

/** The low level: where an item goes. Immutable; may be shared by threads. */
public final class Policy extends Handle {
    private static final Raw LIBRARY = Raw.LIBRARY;

    /** What a policy is made of; heuristics are not learned. */
    public enum Architecture { HEURISTIC, ACTOR_CRITIC, FULLY_CONVOLUTIONAL, AFTERSTATE }

    /**
     * Where a policy comes from; zeros for a heuristic. Bins 0 x 0: it serves any; utilization is
     * 0..1, or -1 if it was not measured; rewardFill is the share of filled cells in the reward.
     */
    public record Info(Architecture architecture, int binW, int binH, long parameters, long seed,
            long steps, double rewardFill, double utilization, String learner) {}

    /**
     * What actor and critic say: W*H + 1 logits and probabilities by position, the last for "no
     * position", those without room with probability 0; and the value of the bin.
     */
    public record Evaluation(float[] logits, float[] probabilities, float value) {}

    /** The same for many pairs, one after another: W*H + 1 probabilities for each. */
    public record BatchEvaluation(int[] positions, float[] probabilities, float[] values) {}

    /** Mean utilisation, 0..1, and half the width of its 95 % interval. */
    public record Measurement(double mean, double halfWidth) {}

    /** By one of the builtin names. */
    public Policy(String name) {
        this(create(Native.toC(name)));
    }

    private Policy(Pointer pointer) {
        super(pointer, LIBRARY::pkc_policy_free);
    }

    private static Pointer create(byte[] name) {
        return Native.made(out -> LIBRARY.pkc_policy_create(name, out));
    }

    /** The names that the constructor knows, "default" first. */
    public static List<String> builtins() {
        return Native.listed(LIBRARY::pkc_policy_builtin);
    }

    /** From a weight blob (.pkw). */
    public static Policy load(byte[] blob) {
        return new Policy(
                Native.made(out -> LIBRARY.pkc_policy_load(blob, Native.count(blob), out)));
    }

    /**
     * The same from a file. IO if it cannot be read, FORMAT with the first offset that is wrong.
     */
    public static Policy loadFile(String path) {
        byte[] text = Native.toC(path);
        return new Policy(Native.made(out -> LIBRARY.pkc_policy_load_file(text, out)));
    }

    /** The weight blob. UNSUPPORTED for a heuristic: it has none. */
    public byte[] save() {
        return Native.bytesOf(this, p -> (a, n, size) -> LIBRARY.pkc_policy_save(p, a, n, size));
    }

    /** The same into a file, all or nothing. */
    public void saveFile(String path) {
        byte[] text = Native.toC(path);
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

    /** Where the policy comes from. */
    public Info info() {
        Raw.pkc_policy_info raw = new Raw.pkc_policy_info();
        Native.check(LIBRARY.pkc_policy_info_init(raw, raw.size()));
        Native.check(this, p -> LIBRARY.pkc_policy_get_info(p, raw));
        return new Info(Native.named(Architecture.values(), raw.architecture + 1), raw.bin_w,
                raw.bin_h, raw.parameters, raw.seed, raw.steps, raw.reward_fill, raw.utilization,
                Native.text(raw.learner));
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

    /** What a learned policy says of such an item; UNSUPPORTED if it gives positions alone. */
    public Evaluation evaluate(Bin bin, int w, int h) {
        int positions = positions(bin);
        float[] logits = new float[positions];
        float[] probabilities = new float[positions];
        LongByReference count = new LongByReference();
        FloatByReference value = new FloatByReference();
        Native.check(this, bin, (p, b) -> LIBRARY.pkc_policy_evaluate(p, b, w, h, logits,
                probabilities, positions, count, value));
        return new Evaluation(logits, probabilities, value.getValue());
    }

    /**
     * The positions for 1..2^20 pairs of a bin and an item of sizes[2*i] x sizes[2*i + 1] cells,
     * faster than one by one. All bins have the same sides; the same bin may stand in many pairs.
     */
    public int[] selectBatch(List<Bin> bins, int[] sizes) {
        List<Bin> all = all(bins);
        int[] positions = new int[all.size()];
        batch(all, sizes, positions, null, null);
        return positions;
    }

    /** The same with what a learned policy says; UNSUPPORTED if it gives positions alone. */
    public BatchEvaluation evaluateBatch(List<Bin> bins, int[] sizes) {
        List<Bin> all = all(bins);
        long probabilities = all.isEmpty() ? 0 : (long) positions(all.get(0)) * all.size();
        if (probabilities > Integer.MAX_VALUE)
            throw new PackcellException(
                    probabilities + " probabilities: must be at most " + Integer.MAX_VALUE);
        BatchEvaluation evaluation = new BatchEvaluation(new int[all.size()],
                new float[(int) probabilities], new float[all.size()]);
        batch(all, sizes, evaluation.positions, evaluation.probabilities, evaluation.values);
        return evaluation;
    }

    /**
     * Packs so many bins, 1..2^32, of a held-out stream, always at the most probable position. A
     * null protocol is the default one.
     */
    public Measurement measure(Protocol protocol, long seed, long bins) {
        Raw.pkc_trainer_options raw = Protocol.raw(protocol);
        DoubleByReference mean = new DoubleByReference();
        DoubleByReference halfWidth = new DoubleByReference();
        Native.check(this,
                p -> LIBRARY.pkc_policy_measure(p, raw, seed, bins, mean, halfWidth));
        return new Measurement(mean.getValue(), halfWidth.getValue());
    }

    /** Read once: the list may change while C uses what it held. */
    private static List<Bin> all(List<Bin> bins) {
        return bins == null ? List.of() : new ArrayList<>(bins);
    }

    /** What is asked for is not null, and has room for all pairs. */
    private void batch(List<Bin> bins, int[] sizes, int[] positions, float[] probabilities,
            float[] values) {
        int count = bins.size();
        if (sizes == null || sizes.length != 2L * count)
            throw new PackcellException((sizes == null ? 0 : sizes.length) + " sizes for " + count
                    + " bins: must be two a bin");
        Pointer[] raw = new Pointer[count];
        try {
            for (int i = 0; i < count; ++i) raw[i] = Native.enter(bins.get(i));
            Native.check(this, p -> LIBRARY.pkc_policy_evaluate_batch(p, raw, sizes, count,
                    positions, probabilities, values));
        } finally {
            for (int i = 0; i < count; ++i) Native.leave(bins.get(i), raw[i]);
        }
    }

    private static int positions(Bin bin) {
        Raw.pkc_bin_info info = new Raw.pkc_bin_info();
        Native.check(LIBRARY.pkc_bin_info_init(info, info.size()));
        Native.check(bin, b -> LIBRARY.pkc_bin_get_info(b, info));
        return info.w * info.h + 1;
    }
}
