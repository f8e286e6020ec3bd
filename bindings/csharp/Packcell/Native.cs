// What the classes are made of: errors as exceptions, handles, and arrays that the library sizes.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using System.Text;

namespace Packcell
{
    /// <summary>Status of a failed call; the numbers are those of PKC_E_*.</summary>
    public enum Status
    {
        /// <summary>A null object, or a value outside what is allowed.</summary>
        Argument = Raw.PKC_E_ARGUMENT,
        /// <summary>A struct of a size that the library does not know.</summary>
        Struct = Raw.PKC_E_STRUCT,
        /// <summary>Memory could not be had.</summary>
        Memory = Raw.PKC_E_MEMORY,
        /// <summary>The object is in use by another thread.</summary>
        Busy = Raw.PKC_E_BUSY,
        /// <summary>The call does not fit the object's state.</summary>
        State = Raw.PKC_E_STATE,
        /// <summary>An array is too small.</summary>
        Capacity = Raw.PKC_E_CAPACITY,
        /// <summary>More than the limits that the object was made with.</summary>
        Limit = Raw.PKC_E_LIMIT,
        /// <summary>Bytes do not hold what they should.</summary>
        Format = Raw.PKC_E_FORMAT,
        /// <summary>A file could not be read or written.</summary>
        IO = Raw.PKC_E_IO,
        /// <summary>Not in this build, or not something this policy does.</summary>
        Unsupported = Raw.PKC_E_UNSUPPORTED,
        /// <summary>A fault of packcell's own; please report it.</summary>
        Internal = Raw.PKC_E_INTERNAL
    }

    /// <summary>A call that failed. The message is the library's: which value, what is allowed.
    /// </summary>
    public sealed class PackcellException : Exception
    {
        public PackcellException(Status status, string message) : base(message)
        {
            Status = status;
        }

        /// <summary>What was wrong; a number that is newer than these classes has no name
        /// here.</summary>
        public Status Status { get; }

        /// <summary>"PKC_E_ARGUMENT" and the like.</summary>
        public string StatusName => Raw.Text(Raw.pkc_status_name((int)Status));
    }

    /// <summary>The linked library.</summary>
    public static class Library
    {
        /// <summary>Major * 10000 + minor * 100 + patch.</summary>
        public static int Version => (int)Raw.pkc_version();
    }

    /// <summary>Owns one handle of the library. Disposing of it frees the handle, once no call uses
    /// it any more; a forgotten one is freed by the garbage collector. One thread at a time may use
    /// it: another gets Status.Busy. A null object, or one disposed of, is Status.Argument, unless
    /// another thread disposes of it just as a call begins: that is an ObjectDisposedException.
    /// </summary>
    public abstract class Handle<T> : IDisposable where T : SafeHandle, new()
    {
        internal static readonly T Null = new T();

        internal Handle(T raw)
        {
            Held = raw;
        }

        /// <summary>For calls of Raw; it stays this object's.</summary>
        public T Held { get; }

        /// <summary>Whether Dispose has been called.</summary>
        public bool IsDisposed => Held.IsClosed;

        /// <summary>Frees the handle, at once or after the call that uses it. A second time does
        /// nothing.</summary>
        public void Dispose()
        {
            Held.Dispose();
            GC.SuppressFinalize(this);
        }
    }

    internal static class Native
    {
        internal delegate int Filling<R>(R[] array, ulong capacity, out ulong count);

        private static readonly UTF8Encoding Strict = new UTF8Encoding(false, true);

        // Must be the first thing after the call: the next one may change the message.
        internal static void Check(int status)
        {
            if (status != Raw.PKC_OK)
                throw new PackcellException((Status)status, Raw.Text(Raw.pkc_last_error()));
        }

        internal static PackcellException Wrong(string message)
        {
            return new PackcellException(Status.Argument, message);
        }

        // NULL for what is null or disposed of: the library says what is missing.
        internal static T Of<T>(Handle<T> handle) where T : SafeHandle, new()
        {
            return handle == null || handle.IsDisposed ? Handle<T>.Null : handle.Held;
        }

        // The same where NULL has a meaning of its own, which only null stands for.
        internal static T OrNone<T>(Handle<T> handle, string what) where T : SafeHandle, new()
        {
            if (handle != null && handle.IsDisposed)
                throw Wrong(what + " was disposed of: must be an open one, or null");
            return Of(handle);
        }

        // C reads a text to its first zero, and would not see what comes after it.
        internal static string Text(string text)
        {
            if (text == null)
                return null;
            if (text.IndexOf('\0') >= 0)
                throw Wrong("text with a zero character: must have none");
            Bytes(text);
            return text;
        }

        internal static byte[] Bytes(string text)
        {
            try
            {
                return text == null ? null : Strict.GetBytes(text);
            }
            catch (EncoderFallbackException)
            {
                throw Wrong("text with half a surrogate pair: must be Unicode");
            }
        }

        // With null the count is one, and the library says that the array is missing.
        internal static ulong Count<R>(R[] array)
        {
            return array == null ? 1 : (ulong)array.LongLength;
        }

        internal static R[] Filled<R>(Filling<R> call)
        {
            R[] array = null;
            for (;;)
            {
                ulong capacity = array == null ? 0 : (ulong)array.LongLength;
                ulong count;
                int status = call(array, capacity, out count);
                if (status == Raw.PKC_E_CAPACITY && count > capacity)
                {
                    array = new R[count];
                    continue;
                }
                Check(status);
                if (array == null)
                    return new R[0];
                if (count < capacity)
                    Array.Resize(ref array, (int)count);
                return array;
            }
        }

        internal static To[] Map<From, To>(IReadOnlyList<From> list, Converter<From, To> convert)
        {
            if (list == null)
                return null;
            To[] array = new To[list.Count];
            for (int i = 0; i < array.Length; ++i)
                array[i] = convert(list[i]);
            return array;
        }

        internal static string[] Listed(Func<ulong, IntPtr> name)
        {
            var names = new List<string>();
            string next;
            while ((next = Raw.Text(name((ulong)names.Count))) != null)
                names.Add(next);
            return names.ToArray();
        }

        internal static ulong Size<T>()
        {
            return (ulong)Marshal.SizeOf(typeof(T));
        }
    }
}
