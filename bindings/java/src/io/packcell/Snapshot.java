package io.packcell;

import com.sun.jna.ptr.PointerByReference;

/** Bin and queue together, to and from bytes that are the same on every machine. */
public record Snapshot(Bin bin, Queue queue) implements AutoCloseable {
    /** Neither is changed. */
    public static byte[] save(Bin bin, Queue queue) {
        Native.Filled<byte[]> filled = new Native.Filled<>(byte[]::new);
        Native.check(bin, queue, (b, q) -> filled.fill(
                (a, n, size) -> Raw.LIBRARY.pkc_snapshot_save(b, q, a, n, size)));
        return filled.array;
    }

    /** A new bin and a new queue. FORMAT names the first offset that is wrong. */
    public static Snapshot load(byte[] bytes) {
        PointerByReference bin = new PointerByReference();
        PointerByReference queue = new PointerByReference();
        Native.check(Raw.LIBRARY.pkc_snapshot_load(bytes, Native.count(bytes), bin, queue));
        return new Snapshot(new Bin(bin.getValue()), new Queue(queue.getValue()));
    }

    /** Closes both. */
    @Override
    public void close() {
        bin.close();
        queue.close();
    }
}
