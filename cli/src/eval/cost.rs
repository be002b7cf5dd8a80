//! What takes minutes or gigabytes is refused before it starts.

use super::line::State;
use super::route::Route;
use crate::report::counted;
use crate::work::{Method, Order, Work};
use costate::Coordinates;
use costate::robot::Robot;

/// The work of states of one robot by one method.
pub struct Cost<'r> {
    robot: &'r Robot,
    route: Route,
    /// Of one state, with first and with second derivatives.
    states: [Work; 2],
    /// Of one frame, the same.
    frames: [Work; 2],
    force: bool,
}

impl<'r> Cost<'r> {
    pub fn new(robot: &'r Robot, route: Route, coordinates: Coordinates, force: bool) -> Self {
        let (method, _) = method(route);
        // Tensors are about dynamics.
        let of_frames = if method == Method::Tensors { Method::Analytic } else { method };
        let orders = [Order::First, Order::Second];
        Self {
            robot,
            route,
            states: orders.map(|order| Work::of_state(robot, coordinates, method, order)),
            frames: orders.map(|order| Work::of_frame(robot, of_frames, order)),
            force,
        }
    }

    /// Refuses a robot for which the derivatives of this order take too much time or memory.
    ///
    /// # Errors
    /// A message with the estimate, unless the user forces it.
    pub fn refuse_derivatives(&self, order: Order) -> Result<(), String> {
        let (work, derivatives) = match order {
            Order::First => (self.states[0], "derivatives"),
            Order::Second => (self.states[1], "second derivatives"),
        };
        if self.force || !work.is_excessive() {
            return Ok(());
        }
        let (method, route) = method(self.route);
        let other = if method == Method::Analytic { "a smaller robot" } else { "--route analytic" };
        Err(format!(
            "{derivatives} of {} joints by --route {route} take {work} for each state; use {other}, or --force to compute \
             them all the same",
            self.robot.dof()
        ))
    }

    /// Refuses a state whose frames take too much time or memory, together with its derivatives.
    ///
    /// # Errors
    /// A message with the estimate, unless the user forces it.
    pub fn refuse_frames(&self, state: &State) -> Result<(), String> {
        let Some(frames) = state.frames.as_ref().filter(|_| !self.force) else { return Ok(()) };
        let second = frames.iter().filter(|frame| frame.w.is_some()).count();
        let [of_first, of_second] = self.frames;
        let mut work = of_first.times(frames.len() - second).and(of_second.times(second));
        if state.motion.is_some() {
            work = work.and(self.states[usize::from(state.y.is_some())]);
        }
        if !work.is_excessive() {
            return Ok(());
        }
        Err(format!(
            "the line takes {work} with its {}; ask for fewer `frames`, or fewer `w` of them, or use --force",
            counted(frames.len(), "frame")
        ))
    }
}

/// What is computed, and the name of the flag.
fn method(route: Route) -> (Method, &'static str) {
    match route {
        Route::Analytic => (Method::Analytic, "analytic"),
        Route::Dual => (Method::Nested, "dual"),
        Route::Hyperdual => (Method::HyperDual, "hyperdual"),
        Route::Tensors => (Method::Tensors, "tensors"),
        #[cfg(feature = "jit")]
        Route::Jit => (Method::Analytic, "jit"),
    }
}
