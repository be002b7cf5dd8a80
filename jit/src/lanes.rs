//! A quantity of a robot at four states at once.

use crate::code::Code;
use crate::compiled::Compiled;
use crate::error::JitError;
use crate::limit::LANES_LIMIT;
use costate::EvalError;
use costate::codegen::{CodegenError, Coordinates, Quantity, REGULAR, guarded_program};
use costate::configuration::Quaternions;
use costate::robot::Robot;
use costate_numerics::widest;

/// One quantity of one robot as machine code for four states at once, which checks each of them.
///
/// Arguments and results are those of [`JitQuantity`](crate::JitQuantity): entry k of a slice holds number k
/// of all four states. Several threads may use it at once.
///
/// ```
/// use costate::codegen::{Coordinates, Quantity};
/// use costate::robot::Robot;
/// use costate_jit::JitLanes;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// if let Ok(f) = JitLanes::new(&robot, Quantity::F, Coordinates::Hamiltonian)? {
///     let mut rates = [[0.0; 4]; 4];
///     let states = [[0.3, 0.1, f64::NAN, 0.2], [-0.8; 4], [1.0; 4], [0.5; 4], [0.0; 4], [0.0; 4]];
///     assert_eq!(f.evaluate(&states, &mut rates)?, [true, true, false, true]);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct JitLanes {
    code: Compiled<[f64; 4]>,
    quaternions: Quaternions,
}

impl JitLanes {
    /// Records and compiles a quantity of at most [`LANES_LIMIT`] steps, or says why there is no machine
    /// code.
    ///
    /// # Errors
    /// [`CodegenError::Quantity`] where the quantity is not defined in these coordinates.
    pub fn new(
        robot: &Robot,
        quantity: Quantity,
        coordinates: Coordinates,
    ) -> Result<Result<Self, JitError>, CodegenError> {
        if let Err(reason) = Code::supported() {
            return Ok(Err(reason));
        }
        let program = match guarded_program(robot, quantity, coordinates, LANES_LIMIT) {
            Ok(program) => program,
            Err(error) => return JitError::of_length(error).map(Err),
        };
        let code = Compiled::compile(&program, LANES_LIMIT, quantity.inverts(coordinates));
        Ok(code.map(|code| Self { code, quaternions: Quaternions::of(robot) }))
    }

    /// Number of entries of all arguments.
    pub fn inputs(&self) -> usize {
        self.code.inputs()
    }

    /// Number of entries of all results.
    pub fn outputs(&self) -> usize {
        self.code.outputs()
    }

    /// Evaluates four states; returns which of them are certain. Nothing is allocated.
    ///
    /// The others have an argument or a result that is not finite, a quaternion whose length is not 1, or a
    /// mass matrix that may be singular up to rounding: compute them by a
    /// [`JitQuantity`](crate::JitQuantity), whose result or error decides.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`].
    pub fn evaluate(&self, inputs: &[[f64; 4]], outputs: &mut [[f64; 4]]) -> Result<[bool; 4], EvalError> {
        let guard = self.code.call_guarded(inputs, outputs)?;
        let (given, found) = (finite_states(inputs), finite_states(outputs));
        // q is the first argument.
        let is_unit = |lane: usize| self.quaternions.first_not_unit(|k| inputs[k][lane]).is_none();
        Ok(std::array::from_fn(|lane| guard[lane] < REGULAR && given[lane] && found[lane] && is_unit(lane)))
    }
}

/// Of which of four states all numbers are finite; entry k holds number k of all four.
///
/// ```
/// let numbers = [[1.0, 2.0, f64::INFINITY, 4.0], [1.0, f64::NAN, 3.0, 4.0]];
/// assert_eq!(costate_jit::finite_states(&numbers), [true, false, false, true]);
/// ```
pub fn finite_states(numbers: &[[f64; 4]]) -> [bool; 4] {
    widest(
        #[inline(always)]
        || {
            // 0 x is 0 if x is finite, and not a number otherwise. Four sums do not wait for each other.
            let mut sums = [[0.0; 4]; 4];
            let (blocks, rest) = numbers.as_chunks::<4>();
            for block in blocks {
                add_nothing(&mut sums, block);
            }
            add_nothing(&mut sums, rest);
            let [a, b, c, d] = sums;
            std::array::from_fn(|lane| (a[lane] + b[lane]) + (c[lane] + d[lane]) == 0.0)
        },
    )
}

/// Adds 0 x of each number.
#[inline(always)]
fn add_nothing(sums: &mut [[f64; 4]; 4], numbers: &[[f64; 4]]) {
    for (sum, four) in sums.iter_mut().zip(numbers) {
        sum.iter_mut().zip(four).for_each(|(sum, number)| *sum += 0.0 * number);
    }
}
