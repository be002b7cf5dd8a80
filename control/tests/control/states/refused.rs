//! What is refused, by name.

use super::{FREE, Model, cart, task};
use costate::dynamics::Automatic;
use costate_control::{
    DirectDynamics, DirectDynamicsError, DynamicsProblem, EndState, FinalTime, SolverOptions,
};

#[test]
fn limits_are_refused_by_component() {
    let problem = cart(FinalTime::Fixed(1.0));
    let cart = || task(Model::Cart, &problem);
    let empty = cart().with_state_limits(&[-FREE, 1.0], &[FREE, 1.0]).unwrap_err();
    assert_eq!(empty, DirectDynamicsError::Empty { component: 1, low: 1.0, high: 1.0 });
    let nan = cart().with_state_limits(&[f64::NAN, 0.0], &[FREE, 1.0]).unwrap_err();
    assert!(matches!(nan, DirectDynamicsError::Empty { component: 0, .. }), "{nan}");
    let outside = cart().with_state_limits(&[-1.0, -1.0], &[0.5, 1.0]).unwrap_err();
    assert_eq!(outside.to_string(), "end.x[0] = 1 is outside of its limits [-1, 0.5]");
    let length = cart().with_state_limits(&[0.0], &[1.0, 1.0]).unwrap_err();
    assert_eq!(length.to_string(), "x_min has length 1, the model needs 2");
}

#[test]
fn options_out_of_range_are_refused() {
    let problem = cart(FinalTime::Fixed(1.0));
    for tolerance in [f64::NAN, 0.0, -1.0] {
        let error = task(Model::Cart, &problem).solve(&SolverOptions::default().with_tolerance(tolerance));
        let error = error.unwrap_err();
        assert!(matches!(error, DirectDynamicsError::Options(_)), "{error}");
        assert!(error.to_string().contains("tolerance"), "{error}");
    }
}

#[test]
fn a_model_without_states_is_refused() {
    let problem = DynamicsProblem::new(EndState::fixed(&[]), EndState::fixed(&[]), FinalTime::Fixed(1.0), 1);
    let refused = DirectDynamics::new(Automatic::<Model>::new(Model::Nothing), &problem);
    assert_eq!(refused.unwrap_err(), DirectDynamicsError::NoStates);
}

#[test]
fn guesses_are_refused_by_list() {
    let problem = cart(FinalTime::Fixed(1.0));
    let (t, x, u) = ([0.0, 1.0], vec![vec![0.0, 0.0], vec![1.0, 0.0]], vec![vec![1.0], vec![-1.0]]);
    let refused = |t: &[f64], x: &[Vec<f64>], u: &[Vec<f64>]| {
        task(Model::Cart, &problem).with_guess(t, x, u).unwrap_err().to_string()
    };
    assert!(task(Model::Cart, &problem).with_guess(&t, &x, &u).is_ok());
    for times in [[0.0, 0.0], [1.0, 0.0], [0.0, f64::NAN], [0.0, FREE]] {
        assert!(refused(&times, &x, &u).starts_with("t of the guess"));
    }
    assert!(refused(&[], &[], &[]).starts_with("t of the guess"));
    let short = "u of the guess has 1 entries for 2 times: give one for each time";
    assert_eq!(refused(&t, &x, &u[..1]), short);
    assert_eq!(refused(&t, &u, &u), "x of the guess has length 1, the model needs 2");
    assert_eq!(refused(&t, &x, &[vec![1.0], vec![FREE]]), "u of the guess = inf: must be finite");
}
