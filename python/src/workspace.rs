//! The workspace of a thread.

use crate::cores::{Core, Lanes};
use crate::errors::Failure;
use crate::fours::Fours;
use crate::plan::{ONE, Plan, ZERO};
use costate_jit::finite_states;

/// What one thread computes with: a core, and buffers for one state and for four.
pub struct Workspace {
    core: Box<dyn Core>,
    lanes: Option<Box<dyn Lanes>>,
    one: Vec<f64>,
    four: Fours,
}

impl Workspace {
    /// Without room for states yet.
    pub fn new(core: Box<dyn Core>) -> Self {
        Self { core, lanes: None, one: Vec::new(), four: Fours::default() }
    }

    /// Makes what computes four states at once, unless it is there.
    pub fn with_lanes(&mut self, new: impl FnOnce() -> Option<Box<dyn Lanes>>) -> bool {
        if self.lanes.is_none() {
            self.lanes = new();
        }
        self.lanes.is_some()
    }

    /// Makes room for four states of this plan.
    pub fn fit_four(&mut self, plan: &Plan) {
        self.four.fit(plan.size());
        let buffer = self.four.numbers();
        (buffer[ONE], buffer[ZERO]) = ([1.0; 4], [0.0; 4]);
    }

    /// The numbers of four states; their arguments are written here.
    #[inline]
    pub fn four(&mut self, plan: &Plan) -> &mut [[f64; 4]] {
        &mut self.four.numbers()[..plan.size()]
    }

    /// Evaluates these states; of which it is certain.
    #[inline(always)]
    pub fn evaluate_four(&mut self, plan: &Plan) -> [bool; 4] {
        let Some(lanes) = &mut self.lanes else { return [false; 4] };
        let buffer = &mut self.four.numbers()[..plan.size()];
        let (inputs, outputs) = buffer[..plan.core_outputs.end].split_at_mut(plan.core_outputs.start);
        let mut certain = lanes.evaluate(&inputs[plan.core_inputs.clone()], outputs);
        plan.multiply(buffer);
        // Lanes have looked at their own results.
        let products = &buffer[plan.core_outputs.end..];
        if !products.is_empty() {
            certain.iter_mut().zip(finite_states(products)).for_each(|(certain, finite)| *certain &= finite);
        }
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
