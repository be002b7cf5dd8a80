//! Workspaces behind handles: made, used by one thread at a time, deleted.

use crate::numbers::set;
use crate::status::Failure;
use std::sync::{Mutex, PoisonError};

/// A workspace, which any thread may use. Calls of several threads on one handle wait for each other.
///
/// Each handle is a structure of its own and not an instance of a generic one, so that cbindgen finds its
/// name and its documentation. `handle!` implements this trait.
pub trait Handle: Sized {
    type Workspace: Send;

    fn new(workspace: Mutex<Self::Workspace>) -> Self;
    fn workspace(&self) -> &Mutex<Self::Workspace>;

    /// Gives a new handle to the caller.
    ///
    /// # Safety
    /// `to` is null or can be written to.
    unsafe fn give(
        name: &str,
        to: *mut *mut Self,
        workspace: Result<Self::Workspace, Failure>,
    ) -> Result<(), Failure> {
        // A caller who ignores the result finds no stray pointer.
        // SAFETY: by the contract of this function.
        unsafe { set(name, to, std::ptr::null_mut()) }?;
        let handle = Box::into_raw(Box::new(Self::new(Mutex::new(workspace?))));
        // SAFETY: as above.
        unsafe { set(name, to, handle) }
    }

    /// Works with the workspace of a handle.
    ///
    /// # Safety
    /// `handle` is null or was given and not deleted.
    unsafe fn with<R>(
        name: &str,
        handle: *const Self,
        work: impl FnOnce(&mut Self::Workspace) -> Result<R, Failure>,
    ) -> Result<R, Failure> {
        // SAFETY: by the contract of this function.
        let handle = unsafe { handle.as_ref() }.ok_or_else(|| Failure::null(name))?;
        work(&mut handle.workspace().lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Deletes a handle.
    ///
    /// # Safety
    /// `handle` is null, or was given and is not used again.
    unsafe fn delete(handle: *mut Self) {
        if !handle.is_null() {
            // SAFETY: `give` has made it by `Box::into_raw`.
            drop(unsafe { Box::from_raw(handle) });
        }
    }
}

/// Implements `Handle` for a structure around the lock of its workspace.
macro_rules! handle {
    ($handle:ty, $workspace:ty) => {
        impl Handle for $handle {
            type Workspace = $workspace;

            fn new(workspace: Mutex<$workspace>) -> Self {
                Self(workspace)
            }

            fn workspace(&self) -> &Mutex<$workspace> {
                &self.0
            }
        }
    };
}
pub(crate) use handle;
