//! A compiled program.

/// Results from arguments.
pub type Call = Box<dyn FnMut(&[f64], &mut [f64])>;

/// A compiled program.
pub struct Candidate {
    pub bytes: usize,
    pub call: Call,
}

impl Candidate {
    /// Code of this many bytes (0 where unknown) that fills the results.
    pub fn new(bytes: usize, call: impl FnMut(&[f64], &mut [f64]) + 'static) -> Self {
        Self { bytes, call: Box::new(call) }
    }
}
