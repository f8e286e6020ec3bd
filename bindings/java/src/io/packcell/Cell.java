package io.packcell;

import com.sun.jna.Pointer;
import java.nio.charset.StandardCharsets;
import java.util.List;

/**
 * Arms, bin, belt, buffers. Lengths are metres, angles radians, times seconds. Immutable; may be
 * shared by threads.
 */
public final class Cell extends Handle {
    private static final int POSE_NUMBERS = 4;
    private static final Raw LIBRARY = Raw.LIBRARY;

    /**
     * Buffer slots and joints (6, 4, or 0 for no arm) are those of each arm; margin is kept between
     * the arms; tick is the step of coordination; cycle is one arm's way from home to the belt, the
     * bin and home, with dwells.
     */
    public record Info(int arms, int binW, int binH, int[] bufferSlots, int[] joints, double margin,
            double tick, double cycle, String name) {}

    /**
     * Evaluations of the mean transfer time, 10..100000, and metres by which bases and buffers may
     * move in x and in y, 0..2.
     */
    public record LayoutOptions(int evaluations, double range) {
        /** 800 evaluations, 0.3 metres. */
        public static LayoutOptions defaults() {
            Raw.pkc_layout_options raw = fresh();
            return new LayoutOptions(raw.evaluations, raw.range);
        }

        private static Raw.pkc_layout_options fresh() {
            Raw.pkc_layout_options raw = new Raw.pkc_layout_options();
            Native.check(LIBRARY.pkc_layout_options_init(raw, raw.size()));
            return raw;
        }
    }

    /** The better cell, the caller's to close, and the mean transfer times without dwells. */
    public record Layout(Cell cell, int evaluations, double before, double after) {}

    /** By one of the presets. */
    public Cell(String preset) {
        this(create(Native.toC(preset)));
    }

    private Cell(Pointer pointer) {
        super(pointer, LIBRARY::pkc_cell_free);
    }

    private static Pointer create(byte[] preset) {
        return Native.made(out -> LIBRARY.pkc_cell_create(preset, out));
    }

    /** The names that the constructor knows. */
    public static List<String> presets() {
        return Native.listed(LIBRARY::pkc_cell_preset);
    }

    /** From the text of a cell.json. */
    public static Cell load(String json) {
        byte[] bytes = Native.bytes(json);
        return new Cell(
                Native.made(out -> LIBRARY.pkc_cell_load(bytes, Native.count(bytes), out)));
    }

    /** From a cell.json. IO if it cannot be read; FORMAT or ARGUMENT name a wrong field. */
    public static Cell loadFile(String path) {
        byte[] text = Native.toC(path);
        return new Cell(Native.made(out -> LIBRARY.pkc_cell_load_file(text, out)));
    }

    /** The description as JSON text. */
    public String save() {
        return new String(Native.bytesOf(this,
                p -> (a, n, size) -> LIBRARY.pkc_cell_save(p, a, n, size)), StandardCharsets.UTF_8);
    }

    /** The same into a file, all or nothing. */
    public void saveFile(String path) {
        byte[] text = Native.toC(path);
        Native.check(this, p -> LIBRARY.pkc_cell_save_file(p, text));
    }

    /** What the description comes to. */
    public Info info() {
        Raw.pkc_cell_info raw = new Raw.pkc_cell_info();
        Native.check(LIBRARY.pkc_cell_info_init(raw, raw.size()));
        Native.check(this, p -> LIBRARY.pkc_cell_get_info(p, raw));
        return new Info(raw.arms, raw.bin_w, raw.bin_h, raw.buffer_slots.clone(),
                raw.joints.clone(), raw.margin, raw.tick, raw.cycle, Native.text(raw.name));
    }

    /** Throws, with zone and distance, if the arms do not reach what the scenario says. */
    public void checkReach(Scenario scenario) {
        Raw.pkc_scenario raw = Scenario.raw(scenario);
        Native.check(this, p -> LIBRARY.pkc_cell_check(p, raw));
    }

    /**
     * Six joints at which the arm's tool has its tip at x, y, z and is turned by yaw; for the four
     * of a SCARA the last two are 0. STATE if there are none.
     */
    public double[] inverse(int arm, double... pose) {
        require(pose, POSE_NUMBERS, "pose");
        double[] joints = new double[Raw.PKC_MAX_JOINTS];
        Native.check(this, p -> LIBRARY.pkc_cell_inverse(p, arm, pose, joints));
        return joints;
    }

    /** x, y, z of the tip and yaw at six joints. */
    public double[] forward(int arm, double... joints) {
        require(joints, Raw.PKC_MAX_JOINTS, "joints");
        double[] pose = new double[POSE_NUMBERS];
        Native.check(this, p -> LIBRARY.pkc_cell_forward(p, arm, joints, pose));
        return pose;
    }

    /** Bases, buffers and homes moved for the shortest mean transfer; null: default options. */
    public Layout optimizeLayout(Scenario scenario, LayoutOptions options) {
        Raw.pkc_scenario of = Scenario.raw(scenario);
        Raw.pkc_layout_options by = LayoutOptions.fresh();
        if (options != null) {
            by.evaluations = options.evaluations;
            by.range = options.range;
        }
        Raw.pkc_layout_info info = new Raw.pkc_layout_info();
        Native.check(LIBRARY.pkc_layout_info_init(info, info.size()));
        Cell cell = new Cell(Native.made(this,
                p -> out -> LIBRARY.pkc_cell_optimize_layout(p, of, by, info, out)));
        return new Layout(cell, info.evaluations, info.before, info.after);
    }

    /** C trusts the caller for arrays of a pinned size. */
    private static void require(double[] numbers, int size, String what) {
        if (numbers != null && numbers.length != size)
            throw new PackcellException(
                    what + " of " + numbers.length + " numbers: must have " + size);
    }
}
