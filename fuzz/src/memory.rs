//! Heap memory in use and its peak.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

static USED: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

/// Memory that no single input may reach: requests beyond it fail, so that the machine survives.
const MOST: usize = 4 << 30;

/// The allocator of the system, with a count of bytes.
pub struct Counting;

fn add(bytes: usize) -> bool {
    let used = USED.fetch_add(bytes, Relaxed) + bytes;
    PEAK.fetch_max(used, Relaxed);
    used <= MOST
}

fn subtract(bytes: usize) {
    USED.fetch_sub(bytes, Relaxed);
}

// SAFETY: every call is passed on to the allocator of the system, or fails with a null pointer.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if !add(layout.size()) {
            subtract(layout.size());
            return std::ptr::null_mut();
        }
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if !add(layout.size()) {
            subtract(layout.size());
            return std::ptr::null_mut();
        }
        // SAFETY: as the caller promises.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        subtract(layout.size());
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // Both blocks exist while the content is copied.
        if !add(size) {
            subtract(size);
            return std::ptr::null_mut();
        }
        // SAFETY: as the caller promises.
        let moved = unsafe { System.realloc(pointer, layout, size) };
        subtract(if moved.is_null() { size } else { layout.size() });
        moved
    }
}

/// Bytes in use.
pub fn used() -> usize {
    USED.load(Relaxed)
}

/// The most bytes in use since the last call.
pub fn restart_peak() -> usize {
    PEAK.swap(used(), Relaxed)
}
