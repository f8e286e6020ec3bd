package io.packcell;

/** A call that failed. The message is the library's: which value, and what is allowed. */
public final class PackcellException extends RuntimeException {
    private static final long serialVersionUID = 1L;

    private final int code;

    PackcellException(int code, String message) {
        super(message);
        this.code = code;
    }

    /** For what is wrong before the library is called. */
    PackcellException(String message) {
        this(Raw.PKC_E_ARGUMENT, message);
    }

    /** Null for a status that is newer than this class; see {@link #code}. */
    public Status status() {
        return Status.of(code);
    }

    /** The number of PKC_E_*. */
    public int code() {
        return code;
    }
}
