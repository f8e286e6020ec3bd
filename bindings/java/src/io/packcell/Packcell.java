package io.packcell;

/** The linked library. */
public final class Packcell {
    private Packcell() {}

    /** Major * 10000 + minor * 100 + patch. */
    public static int version() {
        return Raw.LIBRARY.pkc_version();
    }
}
