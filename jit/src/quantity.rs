//! A quantity of a robot by machine code, or by the generic code where there is none.

use crate::code::Code;
use crate::compiled::Compiled;
use crate::error::JitError;
use crate::limit::limit_for;
use costate::EvalError;
use costate::codegen::{CodegenError, Coordinates, Quantity, REGULAR, RobotQuantity, Shape, guarded_program};
use costate::configuration::Quaternions;
use costate::robot::Robot;
use std::fmt;
use std::sync::Arc;

/// One quantity of one robot: recorded, compiled, and checked like the generic code.
///
/// Arguments and results are those of [`robot_program`](costate::codegen::robot_program), each slice all of
/// them one after the other, matrices row by row.
///
/// ```
/// use costate::codegen::{Coordinates, Quantity};
/// use costate::robot::Robot;
/// use costate_jit::JitQuantity;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut f_x = JitQuantity::new(&robot, Quantity::FX, Coordinates::Hamiltonian)?;
/// println!("{}", f_x.backend()); // machine code or generic code, and why
/// let mut results = vec![0.0; f_x.outputs()];
/// f_x.evaluate(&[0.3, -0.8, 1.0, 0.5, 0.0, 0.0], &mut results)?; // q, p, u
/// let (f, f_x) = results.split_at(4);
/// # assert!(f_x.len() == 16 && f[0] != 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A clone is a workspace for another thread; it runs the same machine code.
#[derive(Clone)]
pub struct JitQuantity {
    compiled: Arc<Result<Machine, JitError>>,
    generic: RobotQuantity<f64>,
    quaternions: Arc<Quaternions>,
}

/// Machine code of a quantity.
#[derive(Debug)]
struct Machine {
    code: Compiled,
}

/// How a [`JitQuantity`] computes.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Backend<'a> {
    /// Machine code.
    Compiled {
        /// Steps of one call, see [`Compiled::steps`].
        steps: usize,
        /// Bytes of machine code.
        bytes: usize,
    },
    /// The generic code.
    Generic {
        /// The reason why there is no machine code.
        reason: &'a JitError,
    },
}

impl fmt::Display for Backend<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Compiled { steps, bytes } => write!(f, "machine code: {steps} steps, {bytes} bytes"),
            Self::Generic { reason } => write!(f, "generic code: {reason}"),
        }
    }
}

impl JitQuantity {
    /// Records and compiles a quantity of at most [`limit_of`](crate::limit_of) steps, a third of them for
    /// quantities without derivatives; see [`Quantity`] for arguments and
    /// results.
    ///
    /// A quantity that cannot be compiled is no error: [`backend`](Self::backend) has the reason.
    ///
    /// # Errors
    /// [`CodegenError::Quantity`] where the quantity is not defined in these coordinates.
    pub fn new(robot: &Robot, quantity: Quantity, coordinates: Coordinates) -> Result<Self, CodegenError> {
        Self::with_limit(robot, quantity, coordinates, limit_for(robot, quantity))
    }

    /// As [`new`](Self::new), compiled only if the program has at most `limit` steps; 0 selects the generic
    /// code.
    ///
    /// A program that is much too long is not recorded to its end: memory is bounded by the limit for every
    /// robot.
    ///
    /// # Errors
    /// [`CodegenError::Quantity`] where the quantity is not defined in these coordinates.
    pub fn with_limit(
        robot: &Robot,
        quantity: Quantity,
        coordinates: Coordinates,
        limit: usize,
    ) -> Result<Self, CodegenError> {
        let generic = RobotQuantity::new(robot, quantity, coordinates)?;
        let compiled = Arc::new(Machine::new(robot, quantity, coordinates, limit)?);
        Ok(Self { compiled, generic, quaternions: Arc::new(Quaternions::of(robot)) })
    }

    /// How it computes.
    pub fn backend(&self) -> Backend<'_> {
        match &*self.compiled {
            Ok(Machine { code }) => Backend::Compiled { steps: code.steps(), bytes: code.code_len() },
            Err(reason) => Backend::Generic { reason },
        }
    }

    /// The arguments, in order.
    pub fn arguments(&self) -> &[Shape] {
        self.generic.arguments()
    }

    /// The results, in order.
    pub fn results(&self) -> &[Shape] {
        self.generic.results()
    }

    /// Number of entries of all arguments.
    pub fn inputs(&self) -> usize {
        self.generic.inputs()
    }

    /// Number of entries of all results.
    pub fn outputs(&self) -> usize {
        self.generic.outputs()
    }

    /// Evaluates the quantity; nothing is allocated.
    ///
    /// Machine code also computes the guard of [`guarded_program`](costate::codegen::guarded_program). Where
    /// the guard does not exclude a singular mass matrix, and where an argument or a result is not finite or
    /// a quaternion has another length than 1, the generic code computes the quantity again: result and error
    /// are then its own. Outputs may be written before an error is found.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`], [`EvalError::NonFinite`], [`EvalError::NotUnit`],
    /// [`EvalError::SingularMassMatrix`].
    pub fn evaluate(&mut self, inputs: &[f64], outputs: &mut [f64]) -> Result<(), EvalError> {
        if let Ok(Machine { code }) = &*self.compiled {
            let guard = code.call_guarded(inputs, outputs)?;
            // q is the first argument.
            let is_unit = self.quaternions.first_not_unit(|k| inputs[k]).is_none();
            if guard < REGULAR && is_unit && all_finite(inputs) && all_finite(outputs) {
                return Ok(());
            }
        }
        self.generic.evaluate(inputs, outputs)
    }
}

impl Machine {
    /// Machine code of at most `limit` steps, or the reason why there is none.
    fn new(
        robot: &Robot,
        quantity: Quantity,
        coordinates: Coordinates,
        limit: usize,
    ) -> Result<Result<Self, JitError>, CodegenError> {
        if limit == 0 {
            return Ok(Err(JitError::NotAsked));
        }
        if let Err(reason) = Code::supported() {
            return Ok(Err(reason));
        }
        let program = match guarded_program(robot, quantity, coordinates, limit) {
            Ok(program) => program,
            Err(error) => return JitError::of_length(error).map(Err),
        };
        let code = Compiled::compile(&program, limit, quantity.inverts(coordinates));
        Ok(code.map(|code| Self { code }))
    }
}

impl fmt::Debug for JitQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut f = f.debug_struct("JitQuantity");
        f.field("arguments", &self.arguments()).field("results", &self.results());
        f.field("compiled", &self.compiled).finish_non_exhaustive()
    }
}

/// Whether every number is finite: `0 x` is 0 if x is finite, and not a number otherwise.
fn all_finite(values: &[f64]) -> bool {
    let mut sums = [0.0; 8];
    let (chunks, rest) = values.as_chunks::<8>();
    for chunk in chunks {
        sums.iter_mut().zip(chunk).for_each(|(sum, value)| *sum += 0.0 * value);
    }
    rest.iter().chain(&sums).fold(0.0, |sum, value| sum + 0.0 * value) == 0.0
}
