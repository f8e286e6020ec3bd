package io.packcell;

import com.sun.jna.Pointer;
import com.sun.jna.Structure;
import com.sun.jna.ptr.LongByReference;
import com.sun.jna.ptr.PointerByReference;
import java.nio.ByteBuffer;
import java.nio.CharBuffer;
import java.nio.charset.CharacterCodingException;
import java.nio.charset.StandardCharsets;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.function.BiConsumer;
import java.util.function.Function;
import java.util.function.IntFunction;
import java.util.function.LongFunction;

/** What the classes are made of: checked calls, arrays that the library sizes, records. */
final class Native {
    private Native() {}

    interface Call1 {
        int run(Pointer a);
    }

    interface Call2 {
        int run(Pointer a, Pointer b);
    }

    interface Call3 {
        int run(Pointer a, Pointer b, Pointer c);
    }

    interface Making {
        int run(PointerByReference out);
    }

    interface Filling<A> {
        int run(A array, long capacity, LongByReference count);
    }

    /** Must be the first thing after the call: the next one may change the message. */
    static void check(int status) {
        if (status != Raw.PKC_OK)
            throw new PackcellException(status, Raw.LIBRARY.pkc_last_error());
    }

    static void check(Handle a, Call1 call) {
        Pointer p = enter(a);
        try {
            check(call.run(p));
        } finally {
            leave(a, p);
        }
    }

    static void check(Handle a, Handle b, Call2 call) {
        Pointer q = enter(b);
        try {
            check(a, p -> call.run(p, q));
        } finally {
            leave(b, q);
        }
    }

    static void check(Handle a, Handle b, Handle c, Call3 call) {
        Pointer r = enter(c);
        try {
            check(a, b, (p, q) -> call.run(p, q, r));
        } finally {
            leave(c, r);
        }
    }

    /** NULL for what is null or closed: the library says what is missing. */
    static Pointer enter(Handle handle) {
        return handle == null ? null : handle.enter();
    }

    static void leave(Handle handle, Pointer entered) {
        if (entered != null) handle.leave();
    }

    /** Where NULL has a meaning of its own, which only null stands for. */
    static void requireOpen(Handle handle, String what) {
        if (handle != null && handle.isClosed())
            throw new PackcellException(what + " is closed: must be an open one, or null");
    }

    static Pointer made(Making call) {
        PointerByReference out = new PointerByReference();
        check(call.run(out));
        return out.getValue();
    }

    static Pointer made(Handle a, Function<Pointer, Making> call) {
        PointerByReference out = new PointerByReference();
        check(a, p -> call.apply(p).run(out));
        return out.getValue();
    }

    /** As Raw takes texts. C reads one to its first zero, and would not see what comes after it. */
    static byte[] toC(String text) {
        if (text == null) return null;
        if (text.indexOf('\0') >= 0)
            throw new PackcellException("text with a zero character: must have none");
        byte[] bytes = bytes(text);
        return Arrays.copyOf(bytes, bytes.length + 1);
    }

    static String text(byte[] bytes) {
        int length = 0;
        while (length < bytes.length && bytes[length] != 0) ++length;
        return new String(bytes, 0, length, StandardCharsets.UTF_8);
    }

    /** As UTF-8; what has no such form is refused, where String.getBytes writes a question mark. */
    static byte[] bytes(String text) {
        if (text == null) return null;
        try {
            ByteBuffer encoded = StandardCharsets.UTF_8.newEncoder().encode(CharBuffer.wrap(text));
            byte[] bytes = new byte[encoded.remaining()];
            encoded.get(bytes);
            return bytes;
        } catch (CharacterCodingException error) {
            throw new PackcellException("text with half a surrogate pair: must be Unicode");
        }
    }

    /** The constant with this number, counted from 1; null if there is none. */
    static <E> E named(E[] values, int code) {
        return code >= 1 && code <= values.length ? values[code - 1] : null;
    }

    static int code(Enum<?> value) {
        return value == null ? 0 : value.ordinal() + 1;
    }

    static List<String> listed(LongFunction<String> name) {
        List<String> names = new ArrayList<>();
        for (String next; (next = name.apply(names.size())) != null;) names.add(next);
        return List.copyOf(names);
    }

    /** With null the count is one, and the library says that the array is missing. */
    static long count(byte[] bytes) {
        return bytes == null ? 1 : bytes.length;
    }

    /** So many structs, one after another; null for none, which JNA has no array for. */
    @SuppressWarnings("unchecked")
    static <S extends Structure> S[] structs(S first, int count) {
        // JNA reckons their size as an int.
        int most = Integer.MAX_VALUE / first.size();
        if (count > most)
            throw new PackcellException(count + " elements: must be at most " + most);
        return count == 0 ? null : (S[]) first.toArray(count);
    }

    /** An array for the library and its length, which is one if there is no list (see count). */
    record Given<S>(S[] array, int count) {}

    /** The list is read once: its length may change meanwhile, what C is told must not. */
    static <R, S extends Structure> Given<S> given(List<R> list, S first, BiConsumer<R, S> set) {
        if (list == null) return new Given<>(null, 1);
        List<R> values = new ArrayList<>(list);
        S[] array = structs(first, values.size());
        for (int i = 0; i < values.size(); ++i) {
            if (values.get(i) == null)
                throw new PackcellException("element " + i + " is null: must be one");
            set.accept(values.get(i), array[i]);
        }
        return new Given<>(array, values.size());
    }

    static <S, R> List<R> list(S[] array, int count, Function<S, R> from) {
        List<R> list = new ArrayList<>(count);
        for (int i = 0; i < count; ++i) list.add(from.apply(array[i]));
        return List.copyOf(list);
    }

    /** An array as large as the library says. */
    static final class Filled<A> {
        private final IntFunction<A> make;
        A array;
        int count;

        Filled(IntFunction<A> make) {
            this.make = make;
            array = null;
        }

        int fill(Filling<A> call) {
            long capacity = 0;
            for (;;) {
                LongByReference out = new LongByReference();
                int status = call.run(array, capacity, out);
                if (status == Raw.PKC_E_CAPACITY && out.getValue() > capacity) {
                    capacity = out.getValue();
                    array = make.apply((int) capacity);
                    continue;
                }
                if (array == null) array = make.apply(0);
                count = (int) out.getValue();
                return status;
            }
        }
    }

    static <S extends Structure, R> List<R> structsOf(Handle a, S first, Function<S, R> from,
            Function<Pointer, Filling<S[]>> call) {
        Filled<S[]> filled = new Filled<>(n -> structs(first, n));
        check(a, p -> filled.fill(call.apply(p)));
        return list(filled.array, filled.count, from);
    }

    static byte[] bytesOf(Handle a, Function<Pointer, Filling<byte[]>> call) {
        Filled<byte[]> filled = new Filled<>(byte[]::new);
        check(a, p -> filled.fill(call.apply(p)));
        return filled.array;
    }
}
