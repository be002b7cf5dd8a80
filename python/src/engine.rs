//! What computes a quantity, on any number of threads.

use crate::cores::{Core, Lanes};
use crate::plan::Plan;
use crate::workspace::Workspace;
use std::sync::{Mutex, PoisonError};

/// What computes a quantity: workspaces for any number of threads, each for one state and for four at once.
pub struct Engine {
    new_core: Box<dyn Fn() -> Box<dyn Core> + Send + Sync>,
    /// Workspaces that nobody uses.
    free: Mutex<Vec<Workspace>>,
    new_lanes: Box<dyn Fn() -> Option<Box<dyn Lanes>> + Send + Sync>,
    /// Whether one state takes so little time that others need not be let in meanwhile.
    pub short: bool,
}

impl Engine {
    /// An engine whose workspaces `core` makes.
    pub fn new(core: impl Fn() -> Box<dyn Core> + Send + Sync + 'static) -> Self {
        Self { new_core: Box::new(core), free: Mutex::default(), new_lanes: Box::new(|| None), short: false }
    }

    /// The same with lanes for four states, which are made for the first batch of a workspace.
    pub fn with_lanes(self, lanes: impl Fn() -> Option<Box<dyn Lanes>> + Send + Sync + 'static) -> Self {
        Self { new_lanes: Box::new(lanes), ..self }
    }

    /// The same, saying whether one state takes a few microseconds at most.
    pub fn short(self, short: bool) -> Self {
        Self { short, ..self }
    }

    /// Makes the lanes of a workspace; whether there are any.
    pub fn lanes(&self, workspace: &mut Workspace) -> bool {
        workspace.with_lanes(&self.new_lanes)
    }

    /// Runs `work` with a workspace that nobody else uses.
    #[inline]
    pub fn with<R>(&self, plan: &Plan, work: impl FnOnce(&mut Workspace) -> R) -> R {
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut workspace = free.unwrap_or_else(|| Workspace::new((self.new_core)()));
        workspace.fit(plan);
        let result = work(&mut workspace);
        self.free.lock().unwrap_or_else(PoisonError::into_inner).push(workspace);
        result
    }
}
