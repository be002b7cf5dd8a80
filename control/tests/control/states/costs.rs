//! Running costs l(x, u).

use super::{Model, costs, told};
use costate::derivative::Function;
use costate::dynamics::{Automatic, AutomaticCost, QuadraticCost};
use costate::scalar::Scalar;
use costate_control::{
    Certificate, DirectDynamics, DynamicsProblem, EndState, FinalTime, Objective, SolverOptions,
};

/// x^2 + 0.5 x u + u^2/2.
#[derive(Clone)]
struct Crossed;

impl Function for Crossed {
    type Workspace<S: Scalar> = ();
    type Error = std::convert::Infallible;
    fn inputs(&self) -> usize {
        2
    }
    fn outputs(&self) -> usize {
        1
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], l: &mut [S]) -> Result<(), Self::Error> {
        l[0] = z[0] * z[0] + (z[0] * z[1]).times(0.5) + (z[1] * z[1]).times(0.5);
        Ok(())
    }
}

fn from(x: f64, time: f64, controls: usize) -> DynamicsProblem {
    let end = EndState::fixed(&[0.0]).with_free(&[0]);
    DynamicsProblem::new(EndState::fixed(&[x]), end, FinalTime::Fixed(time), controls)
}

/// x' = 0.3 x + u over a long time: J = p x^2/2 with 0.6 p + 2 = (p + 0.5)^2, and u = -(p + 0.5) x.
#[test]
fn a_cross_term_gives_the_value_of_riccati() {
    let problem = from(1.5, 8.0, 1).with_cost(Objective::new(0.0, vec![0.0]));
    let cost = AutomaticCost::<Crossed>::running(Crossed, 1);
    let model = Automatic::<Model>::new(Model::Linear(0.3));
    let mut task = DirectDynamics::with_running_cost(model, cost, &problem).unwrap();
    let motion = told(task.solve(&SolverOptions::default().with_tolerance(1e-6)).unwrap());
    let p = 1.79_f64.sqrt() - 0.2;
    costs(&motion, 0.5 * p * 1.5 * 1.5);
    assert!((motion.u[1][0] + (p + 0.5) * motion.x[1][0]).abs() < 1e-3);
    assert!((motion.y[1][0] + p * motion.x[1][0]).abs() < 1e-3);
}

#[test]
fn a_cost_of_wrong_length_is_refused() {
    let model = || Automatic::<Model>::new(Model::Linear(0.3));
    let problem = from(1.0, 1.0, 1);
    let refused = |cost| DirectDynamics::with_running_cost(model(), cost, &problem).unwrap_err().to_string();
    assert_eq!(
        refused(QuadraticCost::running(&[1.0, 1.0], &[1.0])),
        "x of the running cost has length 2, the model needs 1"
    );
    assert_eq!(
        refused(QuadraticCost::running(&[1.0], &[1.0, 1.0])),
        "u of the running cost has length 2, the model needs 1"
    );
}

/// Nothing to choose: J is the integral of exp(-2 t)/2.
#[test]
fn a_model_may_have_no_controls() {
    let cost = QuadraticCost::terminal(&[1.0]);
    let mut task =
        DirectDynamics::with_running_cost(Automatic::<Model>::new(Model::Decay), cost, &from(1.0, 1.0, 0))
            .unwrap();
    let motion = told(task.solve(&SolverOptions::default().with_tolerance(1e-6)).unwrap());
    costs(&motion, 0.25 * (1.0 - (-2.0_f64).exp()));
    assert!(motion.u.iter().all(Vec::is_empty));
}

/// x' = u, l = u^2/2 - 8 x^2, x = 0 at both ends, |x| <= 1: rest is stationary, but half a period of a sine
/// costs less where pi^2/T^2 < 16: in a time of 1, not in 0.7.
#[test]
fn a_saddle_has_no_certificate() {
    for (time, certificate) in [(1.0, Certificate::NotChecked), (0.7, Certificate::LocalMinimumOnMesh)] {
        let end = EndState::fixed(&[0.0]);
        let problem = DynamicsProblem::new(end.clone(), end, FinalTime::Fixed(time), 1);
        let cost = QuadraticCost::terminal(&[-16.0]);
        let model = Automatic::<Model>::new(Model::Linear(0.0));
        let mut task = DirectDynamics::with_running_cost(model, cost, &problem)
            .unwrap()
            .with_state_limits(&[-1.0], &[1.0])
            .unwrap();
        let motion = told(task.solve(&SolverOptions::default().with_tolerance(1e-6)).unwrap());
        assert!(motion.status.is_converged() && motion.cost.abs() < 1e-9, "{time}");
        assert_eq!(motion.certificate, certificate);
    }
}
