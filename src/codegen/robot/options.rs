//! Options of programs of robots.

/// How the program of a quantity of a robot is recorded.
///
/// ```
/// use costate::codegen::ProgramOptions;
///
/// let options = ProgramOptions::default().with_parameters(true).with_limit(25_000);
/// assert!(options.parameters && !options.only && options.limit == 25_000);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ProgramOptions {
    /// Leave out all results but the quantity itself.
    pub only: bool,
    /// Masses, lengths and other constants are one more argument, `parameters`, instead of numbers in the
    /// program: see [`parameter_values`](super::parameter_values). Directions of joints remain numbers. The
    /// program has about twice as many operations.
    pub parameters: bool,
    /// Most steps of the program. The recording stops after
    /// [`OPERATIONS_PER_STEP`](crate::codegen::OPERATIONS_PER_STEP) operations for each of them, so time and
    /// memory are bounded. Unlimited by default.
    pub limit: usize,
}

impl Default for ProgramOptions {
    fn default() -> Self {
        Self { only: false, parameters: false, limit: usize::MAX }
    }
}

impl ProgramOptions {
    /// The same with [`only`](Self::only).
    #[must_use]
    pub fn with_only(self, only: bool) -> Self {
        Self { only, ..self }
    }

    /// The same with [`parameters`](Self::parameters).
    #[must_use]
    pub fn with_parameters(self, parameters: bool) -> Self {
        Self { parameters, ..self }
    }

    /// The same with this [`limit`](Self::limit).
    #[must_use]
    pub fn with_limit(self, limit: usize) -> Self {
        Self { limit, ..self }
    }
}
