//! A program as machine code that can be called.

use crate::code::Code;
use crate::error::JitError;
use crate::number::JitNumber;
use crate::place::Place;
use crate::plan::Function;
use crate::translate::{Call, Stage, Translation, translate};
use costate::codegen::Program;
use costate::{EvalError, LengthError};
use std::mem::MaybeUninit;

/// Default limit of steps for one state: longer straight-line code is slower than the loops of the generic
/// code, see docs/jit.md.
pub const DEFAULT_LIMIT: usize = 18_000;

/// Default limit of steps for four states at once, which do four times the work with the code that is read.
pub const LANES_LIMIT: usize = 100_000;

/// Most numbers that one call may keep in memory; they are on the stack.
const MOST_SLOTS: usize = 1 << 13;

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
    code: Code,
    stages: Vec<Stage>,
    constants: Vec<T::Stored>,
    slots: usize,
    inputs: usize,
    outputs: usize,
    /// Whether the last result of the program is in slot 0 and not an output.
    guarded: bool,
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
        let Translation { code, stages, constants, slots } = translate(program, T::WIDTH, guarded)?;
        if slots > MOST_SLOTS {
            let what = "values that are alive at once";
            return Err(JitError::TooWide { what, found: slots, limit: MOST_SLOTS });
        }
        let constants = constants.into_iter().map(|constant| T::splat(constant).store()).collect();
        let (inputs, outputs) = (program.inputs(), program.outputs() - usize::from(guarded));
        Ok(Self { code: Code::new(&code)?, stages, constants, slots, inputs, outputs, guarded })
    }

    /// Number of entries of all arguments.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of entries of all results.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Length of the machine code in bytes.
    pub fn code_len(&self) -> usize {
        self.code_bytes().len()
    }

    /// The machine code, for disassemblers: position-independent, one function or more.
    pub fn code_bytes(&self) -> &[u8] {
        self.code.bytes()
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
        Ok(match self.slots {
            0..=512 => self.run::<512>(inputs, outputs),
            513..=2048 => self.run::<2048>(inputs, outputs),
            _ => self.run::<MOST_SLOTS>(inputs, outputs),
        })
    }

    /// Runs it with `SLOTS` numbers on the stack, at least as many as it needs.
    #[inline(never)]
    fn run<const SLOTS: usize>(&self, inputs: &[T], outputs: &mut [T]) -> T {
        let mut slots = [MaybeUninit::uninit(); SLOTS];
        for stage in &self.stages {
            if let Some(entry) = stage.entry {
                // SAFETY: the code at `entry` was made for slices of just these lengths (`call` compares
                // those of inputs and outputs, the constants are its own, `SLOTS` is not below what it needs)
                // and reads of the slots only what it or a function stored; `with_limit` made sure of the
                // processor.
                unsafe { self.code.run(entry, inputs, outputs, &self.constants, &mut slots) };
            }
            let (angles, others) = stage.calls.split_at(stage.angles);
            for group in angles.chunks(T::ANGLES) {
                let mut values = [[T::splat(0.0); 2]; 4];
                let angle = |k: usize| {
                    let call = group.get(k);
                    call.map_or(T::splat(0.0), |call| self.argument(call, inputs, outputs, &slots))
                };
                // SAFETY: `with_limit` made sure of the processor.
                unsafe { T::sin_cos(angle, |k, both| values[k] = both) };
                group.iter().zip(values).for_each(|(call, values)| store(call, values, &mut slots));
            }
            for call in others {
                let argument = self.argument(call, inputs, outputs, &slots);
                let value = match call.function {
                    Function::Exp => argument.map_lanes(f64::exp),
                    Function::ExpM1 | Function::SinCos => argument.map_lanes(f64::exp_m1),
                };
                store(call, [value; 2], &mut slots);
            }
        }
        match self.guarded {
            // SAFETY: a stretch of code stored the result there, and nothing else uses the slot.
            true => T::load(unsafe { slots[0].assume_init() }),
            false => T::splat(0.0),
        }
    }

    /// The argument of a function.
    #[inline]
    fn argument(&self, call: &Call, inputs: &[T], outputs: &[T], slots: &[MaybeUninit<T::Stored>]) -> T {
        match call.argument {
            Place::Input(k) => inputs[k as usize],
            Place::Output(k) => outputs[k as usize],
            Place::Constant(k) => T::load(self.constants[k as usize]),
            // SAFETY: an argument has its slot from the step that computes it, which is in an earlier stage.
            Place::Slot(k) => T::load(unsafe { slots[k as usize].assume_init() }),
        }
    }
}

/// The values of a function into their slots.
#[inline]
fn store<T: JitNumber>(call: &Call, values: [T; 2], slots: &mut [MaybeUninit<T::Stored>]) {
    for (slot, value) in call.values.iter().zip(values) {
        if let Some(slot) = *slot {
            slots[slot as usize].write(value.store());
        }
    }
}
