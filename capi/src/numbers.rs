//! Arrays, texts and results of the caller.

use crate::status::Failure;
use crate::status::costate_status::{COSTATE_ARGUMENT, COSTATE_SIZE};
use std::ffi::{CStr, CString, c_char};

/// Copies numbers of the caller: they may overlap with results.
///
/// # Safety
/// `from` is null or points to as many numbers as `to` has.
pub unsafe fn read(name: &str, from: *const f64, to: &mut [f64]) -> Result<(), Failure> {
    if from.is_null() && !to.is_empty() {
        return Err(Failure::null(name));
    }
    if !to.is_empty() {
        // SAFETY: by the contract of this function.
        unsafe { std::ptr::copy(from, to.as_mut_ptr(), to.len()) };
    }
    Ok(())
}

/// Copies numbers to the caller.
///
/// # Safety
/// `to` is null or points to as many numbers as `from` has.
pub unsafe fn write(name: &str, from: &[f64], to: *mut f64) -> Result<(), Failure> {
    if to.is_null() && !from.is_empty() {
        return Err(Failure::null(name));
    }
    // SAFETY: by the contract of this function.
    unsafe { write_if(from, to) };
    Ok(())
}

/// Copies numbers to the caller, who does not want them where `to` is null.
///
/// # Safety
/// `to` is null or points to as many numbers as `from` has.
pub unsafe fn write_if(from: &[f64], to: *mut f64) {
    if !to.is_null() && !from.is_empty() {
        // SAFETY: by the contract of this function.
        unsafe { std::ptr::copy(from.as_ptr(), to, from.len()) };
    }
}

/// Sets a result of the caller.
///
/// # Safety
/// `to` is null or can be written to.
pub unsafe fn set<T>(name: &str, to: *mut T, value: T) -> Result<(), Failure> {
    if to.is_null() {
        return Err(Failure::null(name));
    }
    // SAFETY: by the contract of this function.
    unsafe { to.write(value) };
    Ok(())
}

/// A text of the caller.
///
/// # Safety
/// `text` is null or ends with a zero byte.
pub unsafe fn text<'a>(name: &str, text: *const c_char) -> Result<&'a str, Failure> {
    if text.is_null() {
        return Err(Failure::null(name));
    }
    // SAFETY: by the contract of this function.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| Failure::new(COSTATE_ARGUMENT, format_args!("{name} is not UTF-8")))
}

/// A name for C; a zero byte in it becomes a blank.
pub fn name(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// The number of entries that the caller assumes must be that of the robot.
pub fn check_size(expected: usize, found: usize) -> Result<(), Failure> {
    if expected == found {
        return Ok(());
    }
    Err(Failure::new(
        COSTATE_SIZE,
        format_args!("n is {found}; the robot has {expected} joints that move by themselves"),
    ))
}
