//! The workspace of a thread.

use crate::cores::{Core, Lanes};
use crate::errors::Failure;
use crate::plan::{ONE, Plan};

/// What one thread computes with: a core, and buffers for one state and for four.
pub struct Workspace {
    core: Box<dyn Core>,
    lanes: Option<Box<dyn Lanes>>,
    pub one: Vec<f64>,
    pub four: Vec<[f64; 4]>,
}

impl Workspace {
    /// Without room for states yet.
    pub fn new(core: Box<dyn Core>) -> Self {
        Self { core, lanes: None, one: Vec::new(), four: Vec::new() }
    }

    /// Makes what computes four states at once, unless it is there.
    pub fn with_lanes(&mut self, new: impl FnOnce() -> Option<Box<dyn Lanes>>) -> bool {
        if self.lanes.is_none() {
            self.lanes = new();
        }
        self.lanes.is_some()
    }

    /// Evaluates four states; of which it is certain.
    pub fn evaluate_four(&mut self, plan: &Plan) -> [bool; 4] {
        let Some(lanes) = &mut self.lanes else { return [false; 4] };
        let buffer = &mut self.four[..plan.size()];
        let (inputs, outputs) = buffer[..plan.core_outputs.end].split_at_mut(plan.core_outputs.start);
        let mut certain = lanes.evaluate(&inputs[plan.core_inputs.clone()], outputs);
        plan.multiply(buffer);
        // Lanes have looked at their own results.
        let mut sums = [0.0; 4];
        for four in &buffer[plan.core_outputs.end..] {
            sums.iter_mut().zip(four).for_each(|(sum, number)| *sum += 0.0 * number);
        }
        certain.iter_mut().zip(sums).for_each(|(certain, sum)| *certain &= sum == 0.0);
        certain
    }

    /// Makes room for one state of this plan.
    #[inline]
    pub fn fit(&mut self, plan: &Plan) {
        if self.one.len() < plan.size() {
            self.one.resize(plan.size(), 0.0);
        }
        self.one[ONE] = 1.0;
    }

    /// The numbers of one state; its arguments are written here.
    #[inline]
    pub fn state(&mut self, plan: &Plan) -> &mut [f64] {
        &mut self.one[..plan.size()]
    }

    /// Evaluates that state.
    ///
    /// # Errors
    /// Why it is refused.
    #[inline]
    pub fn evaluate(&mut self, plan: &Plan) -> Result<(), Failure> {
        let buffer = &mut self.one[..plan.size()];
        let (inputs, outputs) = buffer[..plan.core_outputs.end].split_at_mut(plan.core_outputs.start);
        self.core.evaluate(&inputs[plan.core_inputs.clone()], outputs)?;
        plan.multiply(buffer);
        Ok(())
    }
}
