//! The frame of a call from XLA: structures of `xla/ffi/api/c_api.h`, as far as they are read.

use std::ffi::{CString, c_char, c_int, c_void};
use std::slice;

/// An error of XLA.
#[repr(C)]
pub struct ApiError {
    _opaque: [u8; 0],
}

/// Kinds of errors, by the numbers of absl's status codes.
#[derive(Clone, Copy)]
pub enum Code {
    InvalidArgument = 3,
    Internal = 13,
}

/// Values of `XLA_FFI_DataType`.
const INT64: c_int = 5;
const FLOAT64: c_int = 12;
/// Value of `XLA_FFI_AttrType`.
const SCALAR: c_int = 3;
/// Value of `XLA_FFI_ExecutionStage`.
const EXECUTE: c_int = 3;
/// Value of `XLA_FFI_Extension_Type`.
const METADATA: c_int = 1;
/// The version of the interface: major and minor, of which nothing newer is used.
const VERSION: [c_int; 2] = [0, 1];

#[repr(C)]
struct Extension {
    size: usize,
    kind: c_int,
    next: *mut Extension,
}

#[repr(C)]
struct MetadataExtension {
    base: Extension,
    metadata: *mut Metadata,
}

#[repr(C)]
struct Metadata {
    size: usize,
    version: Version,
    traits: u32,
}

#[repr(C)]
struct Version {
    size: usize,
    extensions: *mut Extension,
    major: c_int,
    minor: c_int,
}

#[repr(C)]
struct ErrorArguments {
    size: usize,
    extensions: *mut Extension,
    message: *const c_char,
    code: c_int,
}

#[repr(C)]
struct Api {
    size: usize,
    extensions: *mut Extension,
    version: Version,
    internal: *const c_void,
    create_error: unsafe extern "C" fn(*mut ErrorArguments) -> *mut ApiError,
}

/// Arguments or results: kinds and pointers.
#[repr(C)]
struct Values {
    size: usize,
    extensions: *mut Extension,
    count: i64,
    kinds: *const c_int,
    values: *const *const Buffer,
}

#[repr(C)]
struct Attributes {
    size: usize,
    extensions: *mut Extension,
    count: i64,
    kinds: *const c_int,
    names: *const *const Text,
    values: *const *const Scalar,
}

#[repr(C)]
struct Text {
    start: *const u8,
    length: usize,
}

#[repr(C)]
struct Scalar {
    kind: c_int,
    value: *const c_void,
}

#[repr(C)]
struct Buffer {
    size: usize,
    extensions: *mut Extension,
    kind: c_int,
    data: *mut c_void,
    rank: i64,
    lengths: *const i64,
}

/// A call.
#[repr(C)]
pub struct CallFrame {
    size: usize,
    extensions: *mut Extension,
    api: *const Api,
    context: *mut c_void,
    stage: c_int,
    arguments: Values,
    results: Values,
    attributes: Attributes,
}

/// An array of doubles in XLA's memory.
pub struct Doubles {
    pub data: *mut u8,
    pub shape: Vec<usize>,
}

/// A list of C, which is empty where its address is null.
///
/// # Safety
/// The address is null, or that of so many values that live as long as `'a`.
unsafe fn list<'a, T>(start: *const T, count: i64) -> &'a [T] {
    let count = usize::try_from(count).unwrap_or(0);
    // SAFETY: the promise of the caller.
    if start.is_null() || count == 0 { &[] } else { unsafe { slice::from_raw_parts(start, count) } }
}

impl CallFrame {
    /// Whether nothing is to be computed: XLA asks for the version, which is written, or prepares a call.
    pub fn answered(&self) -> bool {
        let mut asked = false;
        let mut extension = self.extensions;
        // SAFETY: extensions are a list of structures that begin with this one; that of metadata has a
        // pointer behind it, to a structure that XLA lets handlers write.
        unsafe {
            while let Some(base) = extension.as_ref() {
                if base.kind == METADATA
                    && let Some(metadata) = (*extension.cast::<MetadataExtension>()).metadata.as_mut()
                {
                    [metadata.version.major, metadata.version.minor] = VERSION;
                    metadata.traits = 0;
                    asked = true;
                }
                extension = base.next;
            }
        }
        asked || self.stage != EXECUTE
    }

    /// An error with this message.
    pub fn error(&self, message: &str, code: Code) -> *mut ApiError {
        let message = CString::new(message.replace('\0', " ")).unwrap_or_default();
        let mut arguments = ErrorArguments {
            size: size_of::<ErrorArguments>(),
            extensions: std::ptr::null_mut(),
            message: message.as_ptr(),
            code: code as c_int,
        };
        // SAFETY: every frame has the table of XLA's functions; the message is copied.
        unsafe { ((*self.api).create_error)(&mut arguments) }
    }

    /// An attribute that is a number.
    pub fn number(&self, name: &str) -> Option<i64> {
        let all = &self.attributes;
        // SAFETY: the lists have `count` entries; names are byte strings; scalars of this kind are 64 bits.
        unsafe {
            let (names, kinds) = (list(all.names, all.count), list(all.kinds, all.count));
            let at = names
                .iter()
                .position(|text| list((**text).start, (**text).length as i64) == name.as_bytes())?;
            let scalar = list(all.values, all.count)[at];
            (kinds[at] == SCALAR && (*scalar).kind == INT64).then(|| (*scalar).value.cast::<i64>().read())
        }
    }

    /// The arguments.
    ///
    /// # Errors
    /// For arrays of other numbers than doubles.
    pub fn arguments(&self) -> Result<Vec<Doubles>, String> {
        doubles(&self.arguments)
    }

    /// The results.
    ///
    /// # Errors
    /// As for arguments.
    pub fn results(&self) -> Result<Vec<Doubles>, String> {
        doubles(&self.results)
    }
}

fn doubles(values: &Values) -> Result<Vec<Doubles>, String> {
    // SAFETY: the list has `count` entries; all arguments and results of this version are buffers, whose
    // lengths are `rank` numbers.
    let buffers = unsafe { list(values.values, values.count) };
    let read = |buffer: &*const Buffer| {
        // SAFETY: as above.
        let (buffer, lengths) = unsafe { (&**buffer, list((**buffer).lengths, (**buffer).rank)) };
        if buffer.kind != FLOAT64 {
            return Err("costate: the arrays must be float64; set jax_enable_x64".to_owned());
        }
        let shape = lengths.iter().map(|&length| usize::try_from(length).unwrap_or(0)).collect();
        Ok(Doubles { data: buffer.data.cast(), shape })
    };
    buffers.iter().map(read).collect()
}
