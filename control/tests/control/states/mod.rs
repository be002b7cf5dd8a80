//! `DirectDynamics`: models of a user by the direct method, in their states.

mod bounds;
mod closed_forms;
mod costs;
mod endings;
mod refused;

use costate::derivative::Function;
use costate::dynamics::Automatic;
use costate::scalar::Scalar;
use costate_control::{DirectDynamics, DynamicsProblem, EndState, FinalTime, SolverOptions, StateMotion};

const FREE: f64 = f64::INFINITY;

/// One of these models.
#[derive(Clone, Copy)]
enum Model {
    /// (position, rate), u = acceleration.
    Cart,
    /// So many of them, all positions first.
    Carts(usize),
    /// The same with a drag of 0.7/s.
    Drag,
    /// Point mass on a rod of 1 m, u = torque.
    Pendulum,
    /// x' = -x + sin(u), which is not affine in u.
    Sine,
    /// (x, y), u = heading at speed 1.
    Boat,
    /// x' = sqrt(x) + u, which is not a number below 0.
    Root,
    /// x' = a x + u.
    Linear(f64),
    /// x' = -x, without controls.
    Decay,
    /// No states, one control.
    Nothing,
}

impl Function for Model {
    type Workspace<S: Scalar> = ();
    type Error = std::convert::Infallible;
    fn inputs(&self) -> usize {
        match self {
            Self::Carts(count) => 3 * count,
            Self::Decay => 1,
            _ => self.outputs() + 1,
        }
    }
    fn outputs(&self) -> usize {
        match self {
            Self::Carts(count) => 2 * count,
            Self::Sine | Self::Root | Self::Linear(_) | Self::Decay => 1,
            Self::Nothing => 0,
            _ => 2,
        }
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], f: &mut [S]) -> Result<(), Self::Error> {
        match *self {
            Self::Cart => (f[0], f[1]) = (z[1], z[2]),
            Self::Carts(count) => f.copy_from_slice(&z[count..]),
            Self::Drag => (f[0], f[1]) = (z[1], z[2] - S::from_f64(0.7) * z[1]),
            Self::Pendulum => (f[0], f[1]) = (z[1], z[2] - S::from_f64(9.81) * z[0].sin_cos().0),
            Self::Sine => f[0] = z[1].sin_cos().0 - z[0],
            Self::Root => f[0] = z[0].sqrt() + z[1],
            Self::Linear(a) => f[0] = z[0].times(a) + z[1],
            Self::Decay => f[0] = -z[0],
            Self::Boat => (f[0], f[1]) = (z[2].sin_cos().1, z[2].sin_cos().0 + S::from_f64(0.6)),
            Self::Nothing => {}
        }
        Ok(())
    }
}

fn task(model: Model, problem: &DynamicsProblem) -> DirectDynamics<Automatic<Model>> {
    DirectDynamics::new(Automatic::<Model>::new(model), problem).unwrap()
}

fn ends(from: &[f64], to: &[f64], time: FinalTime) -> DynamicsProblem {
    DynamicsProblem::new(EndState::fixed(from), EndState::fixed(to), time, 1)
}

fn cart(time: FinalTime) -> DynamicsProblem {
    ends(&[0.0, 0.0], &[1.0, 0.0], time)
}

fn solve(task: &mut DirectDynamics<Automatic<Model>>) -> StateMotion {
    told(task.solve(&SolverOptions::default().with_tolerance(1e-6)).unwrap())
}

/// Printed where a test fails.
fn told(motion: StateMotion) -> StateMotion {
    println!(
        "{:?} J {:.12} T {:.9} error {:.1e} end {:.1e} change {:.1e} residual {:.1e} steps {} on {} {:?} violation {:.1e}",
        motion.status,
        motion.cost,
        motion.final_time,
        motion.error,
        motion.end_error,
        motion.cost_change,
        motion.residual,
        motion.steps.len(),
        motion.intervals,
        motion.certificate,
        motion.largest_violation
    );
    motion
}

/// Whether it is solved at this cost to the tolerance, which is 1e-6 by default.
fn costs(motion: &StateMotion, cost: f64) {
    assert!(motion.status.is_converged(), "{:?}", motion.status);
    assert!((motion.cost - cost).abs() <= 1e-6 * cost.abs(), "{:.12} is not {cost:.12}", motion.cost);
    // What `solve` promises.
    assert!(motion.error <= 3e-4 && motion.end_error <= 3e-4 && motion.largest_violation <= 1e-4);
}
