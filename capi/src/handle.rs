//! Workspaces behind handles: made, used by one thread at a time, deleted.

use crate::numbers::set;
use crate::status::Failure;
use std::sync::{Mutex, PoisonError};

/// A workspace, which any thread may use. Calls of several threads on one handle wait for each other.
pub struct Handle<T>(Mutex<T>);

impl<T: Send> Handle<T> {
    /// Gives a new handle to the caller.
    ///
    /// # Safety
    /// `to` is null or can be written to.
    pub unsafe fn give(name: &str, to: *mut *mut Self, value: Result<T, Failure>) -> Result<(), Failure> {
        // A caller who ignores the result finds no stray pointer.
        // SAFETY: by the contract of this function.
        unsafe { set(name, to, std::ptr::null_mut()) }?;
        let handle = Box::into_raw(Box::new(Self(Mutex::new(value?))));
        // SAFETY: as above.
        unsafe { set(name, to, handle) }
    }

    /// The workspace of a handle.
    ///
    /// # Safety
    /// `handle` is null or was given and not deleted.
    pub unsafe fn with<R>(
        name: &str,
        handle: *const Self,
        work: impl FnOnce(&mut T) -> Result<R, Failure>,
    ) -> Result<R, Failure> {
        // SAFETY: by the contract of this function.
        let Self(inner) = unsafe { handle.as_ref() }.ok_or_else(|| Failure::null(name))?;
        work(&mut inner.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Deletes a handle.
    ///
    /// # Safety
    /// `handle` is null, or was given and is not used again.
    pub unsafe fn delete(handle: *mut Self) {
        if !handle.is_null() {
            // SAFETY: `give` has made it by `Box::into_raw`.
            drop(unsafe { Box::from_raw(handle) });
        }
    }
}
