//! Names of the methods that compute several states at once.

/// Machine code for vectors of four numbers.
pub const FOUR: &str = "machine code, 4 states at once";
/// Batches on one thread.
pub const LANES_4: &str = "batch over F64x4";
pub const LANES_8: &str = "batch over F64x8";
/// Batches over the widest lanes that pay on this processor, and over all threads.
pub const THREADS: &str = "batch over lanes and threads";

/// States computed by one call of a method.
pub fn states(route: &str) -> usize {
    match route {
        FOUR => 4,
        LANES_4 | LANES_8 => 16,
        THREADS => 512,
        _ => 1,
    }
}
