//! A quantity of a robot at the speed of machine code, or by the generic code where there is none.

use crate::compiled::{Compiled, DEFAULT_LIMIT};
use crate::error::JitError;
use crate::generic::Generic;
use costate::EvalError;
use costate::codegen::{Argument, CodegenError, Coordinates, Options, Outcome, Quantity, robot_program};
use costate::robot::Robot;
use std::fmt;

/// One quantity of one robot: recorded, compiled, and checked as the generic code is.
///
/// Arguments and results are those of [`robot_program`], each slice all of them one after the other, matrices row by row.
///
/// ```
/// use costate::codegen::{Coordinates, Quantity};
/// use costate::robot::Robot;
/// use costate_jit::Evaluator;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut f_x = Evaluator::new(&robot, Quantity::FX, Coordinates::Hamiltonian)?;
/// println!("{}", f_x.status()); // how it is computed, and why not otherwise
/// let mut results = vec![0.0; f_x.outputs()];
/// f_x.evaluate(&[0.3, -0.8, 1.0, 0.5, 0.0, 0.0], &mut results)?; // q, p, u
/// let (f, f_x) = results.split_at(4);
/// # assert!(f_x.len() == 16 && f[0] != 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Evaluator {
    arguments: Vec<Argument>,
    results: Vec<Outcome>,
    inputs: usize,
    outputs: usize,
    steps: usize,
    compiled: Result<Compiled, JitError>,
    generic: Generic,
}

/// How an [`Evaluator`] computes.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Status<'a> {
    /// Machine code.
    Compiled {
        /// Steps of the program.
        steps: usize,
        /// Bytes of machine code.
        bytes: usize,
    },
    /// The generic code.
    Generic {
        /// Why there is no machine code.
        reason: &'a JitError,
    },
}

impl fmt::Display for Status<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Compiled { steps, bytes } => write!(f, "machine code: {steps} steps, {bytes} bytes"),
            Self::Generic { reason } => write!(f, "generic code: {reason}"),
        }
    }
}

impl Evaluator {
    /// Records and compiles a quantity; see [`Quantity`] for arguments and results.
    ///
    /// That it could not be compiled is no error: see [`status`](Self::status).
    ///
    /// # Errors
    /// [`CodegenError::Quantity`] where there is no such quantity in these coordinates.
    pub fn new(robot: &Robot, quantity: Quantity, coordinates: Coordinates) -> Result<Self, CodegenError> {
        Self::with_limit(robot, quantity, coordinates, DEFAULT_LIMIT)
    }

    /// As [`new`](Self::new), compiled only if the program has at most `limit` steps; 0 for the generic code.
    ///
    /// # Errors
    /// [`CodegenError::Quantity`].
    pub fn with_limit(
        robot: &Robot,
        quantity: Quantity,
        coordinates: Coordinates,
        limit: usize,
    ) -> Result<Self, CodegenError> {
        let program = robot_program(robot, quantity, coordinates, &Options::default())?;
        Ok(Self {
            arguments: program.arguments().to_vec(),
            results: program.results().to_vec(),
            inputs: program.inputs(),
            outputs: program.outputs(),
            steps: program.steps(),
            compiled: match limit {
                0 => Err(JitError::TooLong { steps: program.steps(), limit }),
                limit => Compiled::with_limit(&program, limit),
            },
            generic: Generic::new(robot, quantity, coordinates),
        })
    }

    /// How it computes.
    pub fn status(&self) -> Status<'_> {
        match &self.compiled {
            Ok(compiled) => Status::Compiled { steps: self.steps, bytes: compiled.code_len() },
            Err(reason) => Status::Generic { reason },
        }
    }

    /// The arguments, in order.
    pub fn arguments(&self) -> &[Argument] {
        &self.arguments
    }

    /// The results, in order; where their entries were among the steps is of no use here.
    pub fn results(&self) -> &[Outcome] {
        &self.results
    }

    /// Number of entries of all arguments.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of entries of all results.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Evaluates the quantity; nothing is allocated.
    ///
    /// Machine code does not look at the pivots of the mass matrix. Where an argument or a result is not finite, the
    /// generic code computes once more and says why. **A mass matrix that is singular but for rounding gives large numbers without
    /// meaning**, where the generic code has an error: ask that one where such poses can be met. Outputs may have been written
    /// before an error is found.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`], [`EvalError::NonFinite`]; [`EvalError::SingularMassMatrix`] only where a pivot vanishes so
    /// completely that results are not finite.
    pub fn evaluate(&mut self, inputs: &[f64], outputs: &mut [f64]) -> Result<(), EvalError> {
        let lengths = [("inputs", self.inputs, inputs.len()), ("outputs", self.outputs, outputs.len())];
        for (what, expected, found) in lengths {
            if expected != found {
                return Err(EvalError::WrongLength { what, expected, found });
            }
        }
        if let Ok(compiled) = &self.compiled {
            compiled.call(inputs, outputs)?;
            if all_finite(inputs) && all_finite(outputs) {
                return Ok(());
            }
        }
        self.generic.evaluate(inputs, outputs)
    }
}

/// Whether every number is finite: `0 x` is 0 for those and not a number for the others.
fn all_finite(values: &[f64]) -> bool {
    let mut sums = [0.0; 8];
    let (chunks, rest) = values.as_chunks::<8>();
    for chunk in chunks {
        sums.iter_mut().zip(chunk).for_each(|(sum, value)| *sum += 0.0 * value);
    }
    rest.iter().chain(&sums).fold(0.0, |sum, value| sum + 0.0 * value) == 0.0
}
