//! Errors of compilation.

use costate::codegen::CodegenError;

/// The reason why there is no machine code for a program. The generic code can still evaluate it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JitError {
    /// The processor is not supported.
    #[error(
        "machine code needs an x86-64 processor with AVX2 and FMA; this one ({architecture}) is not supported; \
         use the generic code, or source text from `costate codegen`"
    )]
    Processor {
        /// The architecture that the library was compiled for.
        architecture: &'static str,
    },
    /// The program is longer than the limit.
    #[error(
        "the program has {steps} steps, the limit is {limit}: straight-line code much larger than the processor's caches \
         is slower than loops. Use the generic code, choose a smaller quantity (y_f_x, y_f_xx_d), or raise the limit with \
         Compiled::<f64>::with_limit or JitQuantity::with_limit"
    )]
    TooLong {
        /// Its length, [`Program::steps`](costate::codegen::Program::steps).
        steps: usize,
        /// Most steps.
        limit: usize,
    },
    /// The recording was stopped before it was a program.
    #[error(
        "the recording was stopped after {operations} operations, which make more than {limit} steps, the limit: \
         straight-line code much larger than the processor's caches is slower than loops. Use the generic code, choose a \
         smaller quantity (y_f_x, y_f_xx_d), or raise the limit with JitQuantity::with_limit"
    )]
    GivenUp {
        /// Operations that were recorded.
        operations: usize,
        /// Most steps.
        limit: usize,
    },
    /// The robot is too large to record a quantity that contains its mass matrix.
    #[error(
        "the mass matrix of {joints} joints alone has {entries} entries, too many for a program of at most {limit} steps; \
         use the generic code"
    )]
    LargeRobot {
        /// Number of joints.
        joints: usize,
        /// Entries of the mass matrix, each pair of symmetric ones once.
        entries: usize,
        /// Most steps.
        limit: usize,
    },
    /// The limit is 0.
    #[error("no machine code was requested (limit 0)")]
    NotAsked,
    /// Arguments, results, constants or intermediate values are too many to be addressed.
    #[error("the program has {found} {what}, at most {limit} can be addressed; use the generic code")]
    TooWide {
        /// The kind of values.
        what: &'static str,
        /// Their number.
        found: usize,
        /// Most that can be addressed.
        limit: usize,
    },
    /// A node that uses the value of a later one, or a choice without a comparison.
    #[error("node {node} of the program is not computed from nodes before it; record the program anew")]
    Malformed {
        /// Its position.
        node: usize,
    },
    /// The system gave no memory, or did not allow its execution.
    #[error(
        "no executable memory: {0}; allow the process to execute memory that it wrote, or use the generic code"
    )]
    Memory(#[from] std::io::Error),
}

impl JitError {
    /// The reason in an error of recording, if it is the length of the program.
    ///
    /// # Errors
    /// Any other error of recording.
    pub(crate) fn of_length(error: CodegenError) -> Result<Self, CodegenError> {
        match error {
            CodegenError::TooLarge { steps, limit, .. } => Ok(Self::TooLong { steps, limit }),
            CodegenError::LongRecording { operations, limit, .. } => Ok(Self::GivenUp { operations, limit }),
            CodegenError::LargeRobot { joints, entries, limit, .. } => {
                Ok(Self::LargeRobot { joints, entries, limit })
            }
            error => Err(error),
        }
    }
}
