//! CPU time of this thread: other programs do not count.

use rustix::time::{ClockId, clock_gettime};

/// CPU time of this thread (s).
pub fn cpu_time() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
