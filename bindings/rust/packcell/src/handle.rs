//! What all handles share: who owns them, and how arrays come out of them.

use crate::error::{c_string, check, Error, Result};
use packcell_sys as sys;
use std::ffi::CString;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::ptr;

/// A type that owns a handle and frees it. It is `Send`: the library binds no handle to a thread. It
/// is not `Sync`, unless it says so: a second thread would get [`crate::Status::Busy`].
macro_rules! handle {
    ($(#[$doc:meta])* $name:ident, $raw:ident, $free:ident) => {
        $(#[$doc])*
        pub struct $name {
            raw: std::ptr::NonNull<packcell_sys::$raw>,
        }

        impl $name {
            /// Takes what `create` stores, if it succeeds.
            pub(crate) fn make(
                create: impl FnOnce(*mut *mut packcell_sys::$raw) -> packcell_sys::pkc_status,
            ) -> crate::Result<Self> {
                let mut raw = std::ptr::null_mut();
                crate::error::check(create(&mut raw))?;
                let raw = std::ptr::NonNull::new(raw).expect("packcell succeeds with a handle");
                Ok($name { raw })
            }

            /// Takes over a handle that a call of [`crate::sys`] gave.
            ///
            /// # Safety
            /// It is a handle of this type, and nobody else frees it or uses it from now on.
            pub unsafe fn from_raw(raw: std::ptr::NonNull<packcell_sys::$raw>) -> Self {
                $name { raw }
            }

            /// The handle for a call of [`crate::sys`]; it stays this object's own.
            pub fn as_ptr(&self) -> *mut packcell_sys::$raw {
                self.raw.as_ptr()
            }
        }

        impl Drop for $name {
            fn drop(&mut self) {
                // SAFETY: the handle is this object's own, and no call uses it any more.
                unsafe { packcell_sys::$free(self.as_ptr()) }
            }
        }

        // SAFETY: no handle is bound to the thread that made it.
        unsafe impl Send for $name {}

        impl std::fmt::Debug for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.debug_tuple(stringify!($name)).field(&self.raw).finish()
            }
        }
    };
}
pub(crate) use handle;

/// The elements that a call gives: first it is asked for their number, then for them.
pub(crate) fn fill<T: Copy + Default>(
    mut call: impl FnMut(*mut T, usize, *mut usize) -> sys::pkc_status,
) -> Result<Vec<T>> {
    let mut count = 0;
    match call(ptr::null_mut(), 0, &mut count) {
        sys::PKC_OK | sys::PKC_E_CAPACITY => {}
        status => return Err(Error::from_status(status)),
    }
    let mut elements = zeros(count)?;
    if count > 0 {
        check(call(elements.as_mut_ptr(), elements.len(), &mut count))?;
        elements.truncate(count);
    }
    Ok(elements)
}

/// So many elements, or an error where Rust would end the program for want of memory.
pub(crate) fn zeros<T: Copy + Default>(count: usize) -> Result<Vec<T>> {
    let mut elements = Vec::new();
    elements
        .try_reserve_exact(count)
        .map_err(|e| Error::memory(format!("{count} elements: {e}")))?;
    elements.resize(count, T::default());
    Ok(elements)
}

/// A struct that the library's own function has filled with its defaults.
pub(crate) fn fresh<T: Default>(
    init: unsafe extern "C" fn(*mut T, usize) -> sys::pkc_status,
) -> Result<T> {
    let mut value = T::default();
    // SAFETY: the size is that of what the pointer names.
    check(unsafe { init(&mut value, std::mem::size_of::<T>()) })?;
    Ok(value)
}

/// A struct with what `get` stores in it.
pub(crate) fn filled<T: Default>(
    init: unsafe extern "C" fn(*mut T, usize) -> sys::pkc_status,
    get: impl FnOnce(*mut T) -> sys::pkc_status,
) -> Result<T> {
    let mut value = fresh(init)?;
    check(get(&mut value))?;
    Ok(value)
}

pub(crate) fn c_path(path: &Path) -> Result<CString> {
    c_string("path", path.as_os_str().as_bytes())
}
