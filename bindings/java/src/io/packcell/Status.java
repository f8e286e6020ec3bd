package io.packcell;

/** Status of a failed call: PKC_E_ARGUMENT and the like, in the header's order. */
public enum Status {
    ARGUMENT, STRUCT, MEMORY, BUSY, STATE, CAPACITY, LIMIT, FORMAT, IO, UNSUPPORTED, INTERNAL;

    /** The number of PKC_E_*. */
    public int code() {
        return -1 - ordinal();
    }

    /** Null for a number that is newer than this class. */
    static Status of(int code) {
        return Native.named(values(), -code);
    }
}
