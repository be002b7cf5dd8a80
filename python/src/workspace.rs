//! The workspace of a thread.

use crate::cores::Core;
use crate::errors::Failure;
use crate::plan::{ONE, Plan};

/// What one thread computes with: a core, and buffers for one state and for four.
pub struct Workspace {
    core: Box<dyn Core>,
    pub one: Vec<f64>,
    pub four: Vec<[f64; 4]>,
}

impl Workspace {
    /// Without room for states yet.
    pub fn new(core: Box<dyn Core>) -> Self {
        Self { core, one: Vec::new(), four: Vec::new() }
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
        let (inputs, outputs) = self.one[..plan.size()].split_at_mut(plan.core_outputs.start);
        self.core.evaluate(&inputs[plan.core_inputs.clone()], outputs)
    }
}
