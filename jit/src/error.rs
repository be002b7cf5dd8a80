//! Why a program was not compiled.

/// Why there is no machine code for a program. It can still be evaluated by the generic code or step by step.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JitError {
    /// No machine code is made for this kind of processor.
    #[error(
        "machine code is only made for x86-64 processors with AVX2 and FMA, not for this one ({architecture}); \
         use the generic code, or source text from `costate codegen`"
    )]
    Processor {
        /// What the library was compiled for.
        architecture: &'static str,
    },
    /// The program is longer than the limit.
    #[error(
        "the program has {steps} steps, the limit is {limit}: straight-line code far larger than the processor's caches \
         is slower than loops. Use the generic code, ask for a smaller quantity (y_f_x, y_f_xx_d), or raise the limit with \
         Compiled::<f64>::with_limit or Evaluator::with_limit"
    )]
    TooLong {
        /// Its length, [`Program::steps`](costate::codegen::Program::steps).
        steps: usize,
        /// What is allowed.
        limit: usize,
    },
    /// The recording was given up before it was a program.
    #[error(
        "the recording had more than {operations} operations already, which makes more than {limit} steps, the limit: \
         straight-line code far larger than the processor's caches is slower than loops. Use the generic code, ask for a \
         smaller quantity (y_f_x, y_f_xx_d), or raise the limit with Evaluator::with_limit"
    )]
    GivenUp {
        /// How many were recorded.
        operations: usize,
        /// How many steps are allowed.
        limit: usize,
    },
    /// No machine code was asked for.
    #[error("no machine code was asked for (limit 0)")]
    NotAsked,
    /// Arguments, results, constants or intermediate values are too many to be addressed.
    #[error("the program has {found} {what}, at most {limit} can be addressed; use the generic code")]
    TooWide {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A node that uses the value of a later one, or a choice without a comparison.
    #[error("node {node} of the program is not computed from nodes before it; record the program anew")]
    Malformed {
        /// Its position.
        node: usize,
    },
    /// The system gave no memory, or did not let it be executed.
    #[error(
        "no executable memory: {0}; allow the process to execute memory that it wrote, or use the generic code"
    )]
    Memory(#[from] std::io::Error),
}
