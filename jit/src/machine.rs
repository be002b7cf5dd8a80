//! Machine code with all that it needs to run.

use crate::code::Code;
use crate::error::JitError;
use crate::number::Element;
use crate::place::Place;
use crate::plan::Function;
use crate::step::Steps;
use crate::translate::{Call, PairedInput, Stage, Translation, translate};
use std::mem::MaybeUninit;

/// Most numbers that one call may keep in memory; they are on the stack.
const MOST_SLOTS: usize = 1 << 13;

/// A program as machine code for numbers of one kind.
#[derive(Debug)]
pub struct Machine<T: Element> {
    code: Code,
    stages: Vec<Stage>,
    constants: Vec<T::Stored>,
    paired: Vec<PairedInput>,
    slots: usize,
    /// Number of operations.
    pub steps: usize,
    /// Numbers of arguments and results, without the guard.
    pub inputs: usize,
    pub outputs: usize,
    /// Whether the last result of the program is in slot 0 and not an output.
    guarded: bool,
}

impl<T: Element> Machine<T> {
    /// Compiles a program; its last result is no output if `guarded`, but what a [`call`](Self::call)
    /// returns.
    ///
    /// # Errors
    /// See [`JitError`].
    pub fn new(program: &Steps, guarded: bool) -> Result<Self, JitError> {
        Code::supported()?;
        let Translation { code, stages, constants, inputs: paired, slots } =
            translate(program, T::WIDTH, guarded)?;
        if slots > MOST_SLOTS {
            let what = "values that are alive at once";
            return Err(JitError::TooWide { what, found: slots, limit: MOST_SLOTS });
        }
        let constants = constants.into_iter().map(|constant| T::constant(constant).store()).collect();
        let (inputs, outputs) = (program.inputs.len(), program.results.len() - usize::from(guarded));
        Ok(Self {
            code: Code::new(&code)?,
            stages,
            constants,
            paired,
            slots,
            steps: program.count(),
            inputs,
            outputs,
            guarded,
        })
    }

    /// The machine code.
    pub fn bytes(&self) -> &[u8] {
        self.code.bytes()
    }

    /// Runs the program on arguments and results of these lengths; returns the guard, 0 where there is none.
    ///
    /// The caller has compared the lengths with [`inputs`](Self::inputs) and [`outputs`](Self::outputs).
    pub fn call(&self, inputs: &[T::Outer], outputs: &mut [T::Outer]) -> T::Outer {
        match self.slots {
            0..=512 => self.run::<512>(inputs, outputs),
            513..=2048 => self.run::<2048>(inputs, outputs),
            _ => self.run::<MOST_SLOTS>(inputs, outputs),
        }
    }

    /// Runs it with `SLOTS` numbers on the stack, at least as many as it needs.
    #[inline(never)]
    fn run<const SLOTS: usize>(&self, inputs: &[T::Outer], outputs: &mut [T::Outer]) -> T::Outer {
        // The code relies on these lengths.
        let (inputs, outputs) = (&inputs[..self.inputs], &mut outputs[..self.outputs]);
        let mut slots = [MaybeUninit::uninit(); SLOTS];
        for PairedInput { slot, inputs: pair } in &self.paired {
            let [first, second] = pair.map(|input| inputs[input as usize]);
            slots[*slot as usize].write(T::pair(first, second).store());
        }
        for stage in &self.stages {
            if let Some(entry) = stage.entry {
                // SAFETY: the code at `entry` was made for slices of just these lengths (`call` compares
                // those of inputs and outputs, the constants are its own, `SLOTS` is not below what it needs)
                // and reads of the slots only what it or a function stored; `new` made sure of the
                // processor.
                unsafe { self.code.run::<T>(entry, inputs, outputs, &self.constants, &mut slots) };
            }
            let (angles, others) = stage.calls.split_at(stage.angles);
            for group in angles.chunks(T::ANGLES) {
                let mut values = [[T::constant([0.0; 2]); 2]; 4];
                let angle = |k: usize| {
                    let call = group.get(k);
                    call.map_or(T::constant([0.0; 2]), |call| self.argument(call, inputs, outputs, &slots))
                };
                // SAFETY: `new` made sure of the processor.
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
            true => T::load(unsafe { slots[0].assume_init() }).result(),
            false => T::constant([0.0; 2]).result(),
        }
    }

    /// The argument of a function.
    #[inline]
    fn argument(
        &self,
        call: &Call,
        inputs: &[T::Outer],
        outputs: &[T::Outer],
        slots: &[MaybeUninit<T::Stored>],
    ) -> T {
        match call.argument {
            Place::Input(k) => T::argument(inputs[k as usize]),
            Place::Output(k) => T::argument(outputs[k as usize]),
            Place::Constant(k) => T::load(self.constants[k as usize]),
            // SAFETY: an argument has its slot from the step that computes it, which is in an earlier stage.
            Place::Slot(k) => T::load(unsafe { slots[k as usize].assume_init() }),
        }
    }
}

/// The values of a function into their slots.
#[inline]
fn store<T: Element>(call: &Call, values: [T; 2], slots: &mut [MaybeUninit<T::Stored>]) {
    for (slot, value) in call.values.iter().zip(values) {
        if let Some(slot) = *slot {
            slots[slot as usize].write(value.store());
        }
    }
}
