//! What a failing call says.

use packcell_sys as sys;
use std::ffi::{CStr, CString};
use std::fmt;
use std::os::raw::c_char;

/// The result of a call into packcell.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a call failed; what the header calls `PKC_E_*`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Status {
    /// A value lies outside what is allowed.
    Argument,
    /// A struct has a layout that the library does not know.
    Struct,
    /// Memory could not be had.
    Memory,
    /// The handle is in use by another thread.
    Busy,
    /// The call does not fit the handle's state.
    State,
    /// An array is too small.
    Capacity,
    /// More than the limits that the handle was created with.
    Limit,
    /// Bytes do not hold what they should.
    Format,
    /// A named file could not be read or written.
    Io,
    /// Not in this build, or not something this policy does.
    Unsupported,
    /// A fault of packcell's own.
    Internal,
    /// A number that this crate does not know.
    Other(i32),
}

impl Status {
    fn from_raw(status: sys::pkc_status) -> Status {
        match status {
            sys::PKC_E_ARGUMENT => Status::Argument,
            sys::PKC_E_STRUCT => Status::Struct,
            sys::PKC_E_MEMORY => Status::Memory,
            sys::PKC_E_BUSY => Status::Busy,
            sys::PKC_E_STATE => Status::State,
            sys::PKC_E_CAPACITY => Status::Capacity,
            sys::PKC_E_LIMIT => Status::Limit,
            sys::PKC_E_FORMAT => Status::Format,
            sys::PKC_E_IO => Status::Io,
            sys::PKC_E_UNSUPPORTED => Status::Unsupported,
            sys::PKC_E_INTERNAL => Status::Internal,
            other => Status::Other(other),
        }
    }
}

impl Status {
    /// The number that the header gives it.
    pub fn code(self) -> i32 {
        match self {
            Status::Argument => sys::PKC_E_ARGUMENT,
            Status::Struct => sys::PKC_E_STRUCT,
            Status::Memory => sys::PKC_E_MEMORY,
            Status::Busy => sys::PKC_E_BUSY,
            Status::State => sys::PKC_E_STATE,
            Status::Capacity => sys::PKC_E_CAPACITY,
            Status::Limit => sys::PKC_E_LIMIT,
            Status::Format => sys::PKC_E_FORMAT,
            Status::Io => sys::PKC_E_IO,
            Status::Unsupported => sys::PKC_E_UNSUPPORTED,
            Status::Internal => sys::PKC_E_INTERNAL,
            Status::Other(status) => status,
        }
    }
}

impl fmt::Display for Status {
    /// `PKC_E_ARGUMENT` and the like.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // SAFETY: the name is static.
        f.write_str(&unsafe { text(sys::pkc_status_name(self.code())) })
    }
}

/// A failed call: its status, and the library's line about the value and what is allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    status: Status,
    message: String,
}

impl Error {
    /// Why the call failed.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Which value was wrong and what is allowed.
    pub fn message(&self) -> &str {
        &self.message
    }

    pub(crate) fn argument(message: String) -> Error {
        Error {
            status: Status::Argument,
            message,
        }
    }

    pub(crate) fn memory(message: String) -> Error {
        Error {
            status: Status::Memory,
            message,
        }
    }

    /// The error of a status that is not `PKC_OK`. To be called on the thread of the failing call,
    /// before its next one.
    pub fn from_status(status: sys::pkc_status) -> Error {
        // SAFETY: the text is the thread's own and is copied before its next call.
        let message = unsafe { text(sys::pkc_last_error()) };
        Error {
            status: Status::from_raw(status),
            message,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

pub(crate) fn check(status: sys::pkc_status) -> Result<()> {
    if status == sys::PKC_OK {
        Ok(())
    } else {
        Err(Error::from_status(status))
    }
}

/// A copy of a C text; NULL is empty.
///
/// # Safety
/// `pointer` is NULL or a text that ends with a zero.
pub(crate) unsafe fn text(pointer: *const c_char) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: the caller's promise.
    unsafe { CStr::from_ptr(pointer) }
        .to_string_lossy()
        .into_owned()
}

/// A copy of the text in a fixed field, up to its zero.
pub(crate) fn field_text(field: &[c_char]) -> String {
    let bytes: Vec<u8> = field
        .iter()
        .take_while(|&&c| c != 0)
        .map(|&c| c as u8)
        .collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// For a parameter of the library; a zero within cannot be said in C.
pub(crate) fn c_string(name: &str, bytes: &[u8]) -> Result<CString> {
    CString::new(bytes).map_err(|e| {
        let place = e.nul_position();
        Error::argument(format!("{name}: a zero byte at {place}: must not have any"))
    })
}
