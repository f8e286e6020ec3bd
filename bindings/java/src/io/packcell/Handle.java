package io.packcell;

import com.sun.jna.Pointer;
import java.lang.ref.Cleaner;
import java.util.function.Consumer;

/**
 * Owns one handle of the library. Closing frees it, once no call uses it any more; one that was
 * forgotten is freed after the collector found it. One thread at a time may use it: another gets
 * {@link Status#BUSY}. A null or closed one is {@link Status#ARGUMENT}.
 */
public abstract class Handle implements AutoCloseable {
    private static final Cleaner CLEANER = Cleaner.create();

    private final State state;
    private final Cleaner.Cleanable cleanable;

    Handle(Pointer pointer, Consumer<Pointer> free) {
        state = new State(pointer, free);
        cleanable = CLEANER.register(this, state);
    }

    /** Frees the handle, at once or after the call that uses it. A second time does nothing. */
    @Override
    public final void close() {
        cleanable.clean();
    }

    /** Whether close has been called. */
    public final boolean isClosed() {
        return state.isClosed();
    }

    /** The pointer, which is not freed before {@link #leave}; NULL if this is closed. */
    final Pointer enter() {
        return state.enter();
    }

    /** Once for each pointer, not NULL, that enter gave. */
    final void leave() {
        state.leave();
    }

    /** Apart from the object, which the cleaner must not keep alive. */
    private static final class State implements Runnable {
        private final Pointer pointer;
        private final Consumer<Pointer> free;
        private int uses;
        private boolean closed;

        State(Pointer pointer, Consumer<Pointer> free) {
            this.pointer = pointer;
            this.free = free;
        }

        synchronized boolean isClosed() {
            return closed;
        }

        synchronized Pointer enter() {
            if (closed) return null;
            ++uses;
            return pointer;
        }

        synchronized void leave() {
            if (--uses == 0 && closed) free.accept(pointer);
        }

        @Override
        public synchronized void run() {
            if (closed) return;
            closed = true;
            if (uses == 0) free.accept(pointer);
        }
    }
}
