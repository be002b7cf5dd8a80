//! The quantities of a model, at one state and at four.

use crate::error::JitError;
use crate::lanes::JitLanes;
use crate::quantity::JitQuantity;
use costate::EvalError;
use costate::codegen::{CodegenError, Coordinates, Quantity};
use costate::robot::Robot;
use costate::scalar::F64x4;
use std::sync::Arc;

/// f, f_x and y'f_xx, by their positions.
pub trait Quantities<S> {
    /// Number of entries of all results.
    fn outputs(&self, which: usize) -> usize;

    /// Evaluates one of them.
    ///
    /// # Errors
    /// Why a state is refused.
    fn evaluate(&mut self, which: usize, inputs: &[S], outputs: &mut [S]) -> Result<(), EvalError>;
}

impl Quantities<f64> for [JitQuantity; 3] {
    fn outputs(&self, which: usize) -> usize {
        self[which].outputs()
    }

    fn evaluate(&mut self, which: usize, inputs: &[f64], outputs: &mut [f64]) -> Result<(), EvalError> {
        self[which].evaluate(inputs, outputs)
    }
}

/// Three quantities by machine code for four states, and for one where that is not certain of a state.
#[derive(Clone, Debug)]
pub struct Fours {
    lanes: Arc<[JitLanes; 3]>,
    one: [JitQuantity; 3],
    inputs: Vec<[f64; 4]>,
    outputs: Vec<[f64; 4]>,
    /// Arguments and results of one state.
    alone: [Vec<f64>; 2],
}

impl Fours {
    /// Records and compiles the quantities; `one` are the same ones.
    pub(crate) fn new(
        robot: &Robot,
        quantities: [Quantity; 3],
        coordinates: Coordinates,
        one: [JitQuantity; 3],
    ) -> Result<Result<Self, JitError>, CodegenError> {
        let mut lanes = Vec::with_capacity(quantities.len());
        for quantity in quantities {
            match JitLanes::new(robot, quantity, coordinates)? {
                Ok(code) => lanes.push(code),
                Err(reason) => return Ok(Err(reason)),
            }
        }
        let most = |length: fn(&JitQuantity) -> usize| one.iter().map(length).max().unwrap_or(0);
        let (inputs, outputs) = (most(JitQuantity::inputs), most(JitQuantity::outputs));
        let Ok(lanes) = <[JitLanes; 3]>::try_from(lanes) else { return Ok(Err(JitError::NotAsked)) };
        Ok(Ok(Self {
            lanes: Arc::new(lanes),
            one,
            inputs: vec![[0.0; 4]; inputs],
            outputs: vec![[0.0; 4]; outputs],
            alone: [vec![0.0; inputs], vec![0.0; outputs]],
        }))
    }

    /// Evaluates one lane.
    #[cold]
    fn alone(
        &mut self,
        which: usize,
        lane: usize,
        inputs: &[F64x4],
        outputs: &mut [F64x4],
    ) -> Result<(), EvalError> {
        let [given, found] = &mut self.alone;
        let (given, found) = (&mut given[..inputs.len()], &mut found[..outputs.len()]);
        given.iter_mut().zip(inputs).for_each(|(to, from)| *to = from.lane(lane));
        self.one[which].evaluate(given, found)?;
        outputs.iter_mut().zip(&*found).for_each(|(to, &from)| to.as_mut_slice()[lane] = from);
        Ok(())
    }
}

impl Quantities<F64x4> for Fours {
    fn outputs(&self, which: usize) -> usize {
        self.lanes[which].outputs()
    }

    fn evaluate(&mut self, which: usize, inputs: &[F64x4], outputs: &mut [F64x4]) -> Result<(), EvalError> {
        let (given, found) = (&mut self.inputs[..inputs.len()], &mut self.outputs[..outputs.len()]);
        given.iter_mut().zip(inputs).for_each(|(to, from)| to.copy_from_slice(from.as_slice()));
        let certain = self.lanes[which].evaluate(given, found)?;
        outputs.iter_mut().zip(&*found).for_each(|(to, from)| to.as_mut_slice().copy_from_slice(from));
        (0..4).filter(|&lane| !certain[lane]).try_for_each(|lane| self.alone(which, lane, inputs, outputs))
    }
}
