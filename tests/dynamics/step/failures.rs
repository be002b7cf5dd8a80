//! What steps refuse, and what is left of a workspace afterwards.

use super::{FREE, SWING, flat, robot};
use costate::derivative::largest;
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::LagrangianSecondOrder;
use costate::step::{ImplicitMidpoint, RungeKutta4, SemiImplicitEuler, Step, StepError, StoermerVerlet};
use costate::{EvalError, LengthError};

type AnyStep = Box<dyn Step<f64, Error = StepError<EvalError>>>;

/// Every scheme, by name.
fn all() -> Vec<(&'static str, AnyStep)> {
    let arm = robot("two_link.toml");
    let model = || HamiltonianSecondOrder::new(&arm);
    vec![
        ("RK4", Box::new(RungeKutta4::new(model()))),
        ("Euler", Box::new(SemiImplicitEuler::new(LagrangianSecondOrder::new(&arm)))),
        ("Verlet", Box::new(StoermerVerlet::new(model()))),
        ("midpoint", Box::new(ImplicitMidpoint::new(model()))),
    ]
}

#[test]
fn an_equation_without_solution_is_reported_and_the_workspace_stays_usable() {
    let arm = robot("two_link.toml");
    let mut verlet = StoermerVerlet::new(HamiltonianSecondOrder::<f64>::new(&arm));
    let mut midpoint = ImplicitMidpoint::new(HamiltonianSecondOrder::<f64>::new(&arm));
    let fast = [0.3, -0.8, 100.0, -80.0];
    for step in [&mut verlet as &mut dyn Step<f64, Error = _>, &mut midpoint] {
        let good = step.evaluate(&SWING, &FREE, 0.01).unwrap().to_vec();
        let mut refused = 0;
        for exponent in 0..300 {
            let h = 10_f64.powi(exponent);
            match step.contract(&fast, &FREE, h, &fast) {
                Ok(found) => {
                    assert!(largest(found.first.next).is_finite() && largest(&flat(found.xx)).is_finite())
                }
                Err(StepError::NotConverged { iterations, change }) => {
                    assert!(iterations <= 20 && change > 1e-13, "{h}: {iterations} {change}");
                    refused += 1;
                }
                Err(error) => panic!("{h}: {error}"),
            }
        }
        assert!(refused > 250, "{refused}");
        let error = step.evaluate(&fast, &FREE, 1e20).unwrap_err();
        assert!(error.to_string().contains("take a shorter step"), "{error}");
        assert_eq!(step.evaluate(&SWING, &FREE, 0.01).unwrap(), good);
    }
}

#[test]
fn the_model_refuses_states_that_are_not_numbers() {
    for (name, mut step) in all() {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut x = SWING;
            x[1] = bad;
            let error = step.evaluate(&x, &FREE, 0.01).unwrap_err();
            assert!(
                matches!(&error, StepError::Dynamics(EvalError::NonFinite { index: 1, .. })),
                "{name}: {error}"
            );
            assert!(error.to_string().contains("elbow"), "{name}: {error}");
            let error = step.linearise(&SWING, &[0.0, bad], 0.01).unwrap_err();
            assert!(
                matches!(&error, StepError::Dynamics(EvalError::NonFinite { what: "u", .. })),
                "{name}: {error}"
            );
            for h in [bad, -bad] {
                let error = step.contract(&SWING, &FREE, h, &SWING).unwrap_err();
                assert_eq!(error, StepError::NonFiniteDuration, "{name}");
            }
            let error = step.contract(&SWING, &FREE, 0.01, &[0.0, 0.0, bad, 0.0]).unwrap_err();
            assert!(
                matches!(&error, StepError::Dynamics(EvalError::NonFinite { what: "y", .. })),
                "{name}: {error}"
            );
        }
        assert!(step.contract(&SWING, &FREE, 0.01, &SWING).is_ok(), "{name}");
    }
}

#[test]
fn wrong_lengths_are_refused_by_name() {
    for (name, mut step) in all() {
        let wrong = |what, expected, found| StepError::WrongLength(LengthError { what, expected, found });
        assert_eq!(step.evaluate(&SWING[..3], &FREE, 0.01).unwrap_err(), wrong("x", 4, 3), "{name}");
        assert_eq!(step.linearise(&SWING, &SWING, 0.01).unwrap_err(), wrong("u", 2, 4), "{name}");
        assert_eq!(step.contract(&SWING, &FREE, 0.01, &FREE).unwrap_err(), wrong("y", 4, 2), "{name}");
    }
}
