//! Second derivatives of the direct method: which motions of a mesh are local minima.

use crate::sledge;
use costate::scalar::Scalar;
use costate_control::{
    BoundaryState, Certificate, Method, MotionLimits, Polish, Problem, RunningCost, Solver, SolverOptions,
    Status, UserTerm,
};

/// -k q^2 / 2.
struct Repelled(f64);

impl RunningCost for Repelled {
    fn evaluate<S: Scalar>(&self, q: &[S], _v: &[S]) -> S {
        (q[0] * q[0]).times(-0.5 * self.0)
    }
}

/// A mass that may stay at 0, where the cost `1/2 (q''^2 - k q^2)` is stationary. Its second variation is
/// positive as long as k is below the first eigenvalue of `q'''' = k q`, that of a beam whose end is held,
/// hinged or free.
#[test]
fn a_motion_is_a_minimum_up_to_the_first_eigenvalue_of_a_beam() {
    let held = BoundaryState::fixed(&[0.0], &[0.0]);
    let hinged = held.clone().with_v_free(&[0]);
    let free = hinged.clone().with_q_free(&[0]);
    // S. Timoshenko, Vibration Problems in Engineering: cos b cosh b = 1, tan b = tanh b, cos b cosh b = -1.
    for (end, b) in [(held, 4.730_040_745_f64), (hinged, 3.926_602_312), (free, 1.875_104_069)] {
        for (part, expected) in [(0.98, Certificate::LocalMinimumOnMesh), (1.02, Certificate::NotChecked)] {
            let problem = Problem::rest_to_rest(sledge(), &[0.0], &[0.0], 1.0)
                .with_end(end.clone())
                .with_limits(MotionLimits::none().with_q_min(vec![-0.1]).with_q_max(vec![0.1]))
                .with_term(UserTerm::new(Repelled(part * b.powi(4))));
            let options = SolverOptions::of(Method::Direct).with_polish(Polish::Never);
            let motion = Solver::new(&problem, options).unwrap().solve().motion;
            assert_eq!((motion.status, motion.certificate), (Status::Converged, expected), "{part} {b}");
        }
    }
}
