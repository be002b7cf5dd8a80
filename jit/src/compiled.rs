//! A program as machine code that can be called.

use crate::code::Code;
use crate::error::JitError;
use crate::limit::{DEFAULT_LIMIT, LANES_LIMIT};
use crate::machine::Machine;
use crate::number::{JitNumber, Pair, Pairable, RunPairs};
use crate::pairs::paired;
use crate::step::Steps;
use costate::codegen::Program;
use costate::{EvalError, LengthError};
use std::convert::Infallible;

/// A program as machine code of this processor: for numbers, or for the numbers of four states at once.
///
/// ```
/// use costate::codegen::{Program, RecordedResult};
/// use costate::scalar::Scalar;
/// use costate_jit::Compiled;
///
/// let program = Program::record("polar", &[("z", 2)], |arguments| {
///     let (sin, cos) = arguments[0][1].sin_cos();
///     let radius = arguments[0][0];
///     vec![RecordedResult::vector("x", vec![radius * cos, radius * sin])]
/// })?;
/// if let Ok(compiled) = Compiled::new(&program) {
///     let mut x = [0.0; 2];
///     compiled.call(&[2.0, 0.3], &mut x)?;
///     assert!((x[0] - 2.0 * 0.3_f64.cos()).abs() < 1e-15);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Compiled<T: JitNumber = f64> {
    form: Form<T>,
    inputs: usize,
    outputs: usize,
}

/// The machine code of a program, step by step or with mirror images together.
#[derive(Debug)]
enum Form<T: JitNumber> {
    Single(Machine<T>),
    Pairs(T::Pairs),
}

/// Whether this processor can run machine code of this crate: ask before a program is recorded for it.
///
/// # Errors
/// [`JitError::Processor`].
pub fn supported() -> Result<(), JitError> {
    Code::supported()
}

impl Compiled {
    /// Compiles a program of at most [`DEFAULT_LIMIT`] steps.
    ///
    /// # Errors
    /// See [`JitError`].
    pub fn new(program: &Program) -> Result<Self, JitError> {
        Self::with_limit(program, DEFAULT_LIMIT)
    }
}

impl Compiled<[f64; 4]> {
    /// Compiles a program of at most [`LANES_LIMIT`] steps for four states at once: entry k of the inputs
    /// holds argument k of all four, entry k of the outputs result k.
    ///
    /// ```
    /// use costate::codegen::{Program, RecordedResult};
    /// use costate_jit::Compiled;
    ///
    /// let program = Program::record("square", &[("x", 1)], |arguments| {
    ///     let x = arguments[0][0];
    ///     vec![RecordedResult::vector("y", vec![x * x])]
    /// })?;
    /// if let Ok(compiled) = Compiled::lanes(&program) {
    ///     let mut y = [[0.0; 4]];
    ///     compiled.call(&[[1.0, 2.0, 3.0, 4.0]], &mut y)?;
    ///     assert_eq!(y, [[1.0, 4.0, 9.0, 16.0]]);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// See [`JitError`].
    pub fn lanes(program: &Program) -> Result<Self, JitError> {
        Self::with_limit(program, LANES_LIMIT)
    }
}

impl<T: JitNumber> Compiled<T> {
    /// Compiles a program of at most `limit` steps: `Compiled::<f64>::with_limit(..)`, or with `[f64; 4]`.
    ///
    /// # Errors
    /// See [`JitError`].
    pub fn with_limit(program: &Program, limit: usize) -> Result<Self, JitError> {
        Self::compile(program, limit, false)
    }

    /// The same for a program whose last result, one number, is not an output if `guarded`: see
    /// [`call_guarded`](Self::call_guarded).
    ///
    /// # Errors
    /// See [`JitError`].
    pub(crate) fn compile(program: &Program, limit: usize, guarded: bool) -> Result<Self, JitError> {
        Code::supported()?;
        let steps = program.steps();
        if steps > limit {
            return Err(JitError::TooLong { steps, limit });
        }
        let program_steps = Steps::of(program);
        let pairs = <T::Pairs as RunPairs<T>>::compile(&program_steps, program.symmetry(), guarded)?;
        let form = match pairs {
            Some(pairs) => Form::Pairs(pairs),
            None => Form::Single(Machine::new(&program_steps, guarded)?),
        };
        let (inputs, outputs) = (program.inputs(), program.outputs() - usize::from(guarded));
        Ok(Self { form, inputs, outputs })
    }

    /// Number of entries of all arguments.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of entries of all results.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Steps of one call: those of the program, or fewer where steps of two equal sides of a robot are one.
    pub fn steps(&self) -> usize {
        match &self.form {
            Form::Single(machine) => machine.steps,
            Form::Pairs(pairs) => pairs.steps(),
        }
    }

    /// Length of the machine code in bytes.
    pub fn code_len(&self) -> usize {
        self.code_bytes().len()
    }

    /// The machine code, for disassemblers: position-independent, one function or more.
    pub fn code_bytes(&self) -> &[u8] {
        match &self.form {
            Form::Single(machine) => machine.bytes(),
            Form::Pairs(pairs) => pairs.bytes(),
        }
    }

    /// Runs the program: all arguments one after the other in, all results likewise out, each row by row.
    ///
    /// Nothing is allocated and no value is checked: NaN and infinities pass through. Several threads may
    /// call at once.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]; the outputs are untouched then.
    pub fn call(&self, inputs: &[T], outputs: &mut [T]) -> Result<(), EvalError> {
        self.call_guarded(inputs, outputs).map(|_| ())
    }

    /// As [`call`](Self::call); returns the guard, 0 where there is none.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`].
    pub(crate) fn call_guarded(&self, inputs: &[T], outputs: &mut [T]) -> Result<T, EvalError> {
        let lengths = [("inputs", self.inputs, inputs.len()), ("outputs", self.outputs, outputs.len())];
        for (what, expected, found) in lengths {
            LengthError::check(what, expected, found)?;
        }
        Ok(match &self.form {
            Form::Single(machine) => machine.call(inputs, outputs),
            Form::Pairs(pairs) => pairs.run(inputs, outputs),
        })
    }
}

impl Pairable for f64 {
    type Pairs = Machine<Pair>;
}

impl RunPairs<f64> for Machine<Pair> {
    fn compile(program: &Steps, images: &[u32], guarded: bool) -> Result<Option<Self>, JitError> {
        paired(program, images).map(|pairs| Self::new(&pairs, guarded)).transpose()
    }
    fn steps(&self) -> usize {
        self.steps
    }
    fn bytes(&self) -> &[u8] {
        Self::bytes(self)
    }
    fn run(&self, inputs: &[f64], outputs: &mut [f64]) -> f64 {
        self.call(inputs, outputs)
    }
}

/// Lanes of four states leave no room for pairs.
impl Pairable for [f64; 4] {
    type Pairs = Infallible;
}

impl RunPairs<[f64; 4]> for Infallible {
    fn compile(_: &Steps, _: &[u32], _: bool) -> Result<Option<Self>, JitError> {
        Ok(None)
    }
    fn steps(&self) -> usize {
        match *self {}
    }
    fn bytes(&self) -> &[u8] {
        match *self {}
    }
    fn run(&self, _: &[[f64; 4]], _: &mut [[f64; 4]]) -> [f64; 4] {
        match *self {}
    }
}
