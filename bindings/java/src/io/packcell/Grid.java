package io.packcell;

import com.sun.jna.ptr.DoubleByReference;
import com.sun.jna.ptr.IntByReference;

/**
 * From a real bin to cells and back, all in millimetres: the bin's inside, what is kept free along
 * each wall, a cell's side, what is kept free between items.
 */
public record Grid(double binW, double binH, double margin, double cell, double clearance) {
    /** Sides in cells. */
    public record Cells(int w, int h) {}

    /** Millimetres from the bin's inside top-left corner, y down. */
    public record Point(double x, double y) {}

    /** The paper's: 320 x 260, 10, 30, 0. */
    public static Grid defaults() {
        Raw.pkc_grid raw = fresh();
        return new Grid(raw.bin_w, raw.bin_h, raw.margin, raw.cell, raw.clearance);
    }

    /** The bin's cells: floor((side - 2 * margin) / cell) of each side. */
    public Cells binCells() {
        IntByReference w = new IntByReference();
        IntByReference h = new IntByReference();
        Native.check(Raw.LIBRARY.pkc_grid_bin(raw(), w, h));
        return new Cells(w.getValue(), h.getValue());
    }

    /** Cells that an item of so many millimetres takes: ceil((side + clearance) / cell). */
    public Cells itemCells(double width, double height) {
        IntByReference w = new IntByReference();
        IntByReference h = new IntByReference();
        Native.check(Raw.LIBRARY.pkc_grid_item(raw(), width, height, w, h));
        return new Cells(w.getValue(), h.getValue());
    }

    /** Centre of a rectangle of cells, from the bin's inside top-left corner. */
    public Point centre(int x, int y, int w, int h) {
        DoubleByReference centreX = new DoubleByReference();
        DoubleByReference centreY = new DoubleByReference();
        Native.check(Raw.LIBRARY.pkc_grid_centre(raw(), x, y, w, h, centreX, centreY));
        return new Point(centreX.getValue(), centreY.getValue());
    }

    private static Raw.pkc_grid fresh() {
        Raw.pkc_grid raw = new Raw.pkc_grid();
        Native.check(Raw.LIBRARY.pkc_grid_init(raw, raw.size()));
        return raw;
    }

    private Raw.pkc_grid raw() {
        Raw.pkc_grid raw = fresh();
        raw.bin_w = binW;
        raw.bin_h = binH;
        raw.margin = margin;
        raw.cell = cell;
        raw.clearance = clearance;
        return raw;
    }
}
