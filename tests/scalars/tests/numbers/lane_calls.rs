//! Calls with several states, one a lane: steps, and what one bad lane does.

use costate::EvalError;
use costate::configuration::ConfigurationSpace;
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::matrix::Block;
use costate::robot::Robot;
use costate::scalar::Lanes;
use costate::step::{ImplicitMidpoint, RungeKutta4, Step, StoermerVerlet};
use costate_test_support::random_robot::difference;
use std::f64::consts::FRAC_PI_2;

fn robot(name: &str) -> Robot {
    Robot::from_file(format!("{}/../../robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// Explicit and implicit steps: the iterations of the implicit ones end when all lanes have converged.
#[test]
fn steps_are_made_in_every_lane() {
    fn check<S: Step<f64>, L: Step<Lanes<wide::f64x4>>>(mut alone: S, mut lanes: L) {
        let (n, m) = (alone.states(), alone.controls());
        let x = |k: usize| (0..n).map(|i| 0.1 + 0.3 * ((i + 2 * k) as f64).cos()).collect::<Vec<_>>();
        let states: Vec<_> = (0..4).map(x).collect();
        let lane = |i: usize| Lanes::from_lanes(&states.iter().map(|x| x[i]).collect::<Vec<_>>());
        let (u, h) = (vec![0.4; m], 0.02);
        let (x, lifted): (Vec<_>, Vec<_>) =
            ((0..n).map(lane).collect(), u.iter().map(|&u| Lanes::from(u)).collect());
        let y = vec![1.0; n];
        let y_lanes: Vec<_> = y.iter().map(|&y| Lanes::from(y)).collect();
        let all = lanes.contract(&x, &lifted, Lanes::from(h), &y_lanes).unwrap();
        for (k, x) in states.iter().enumerate() {
            let one = alone.contract(x, &u, h, &y).unwrap();
            let of_lane = |block: Block<'_, Lanes<_>>| {
                block.iter_rows().flatten().map(|e| e.lane(k)).collect::<Vec<_>>()
            };
            let flat = |block: Block<'_, f64>| block.iter_rows().flatten().copied().collect::<Vec<_>>();
            let next: Vec<f64> = all.first.next.iter().map(|entry| entry.lane(k)).collect();
            assert!(difference(&next, one.first.next) < 1e-12);
            assert!(difference(&of_lane(all.first.phi_x), &flat(one.first.phi_x)) < 1e-12);
            assert!(difference(&of_lane(all.xx), &flat(one.xx)) < 1e-11);
        }
    }
    let ur5 = robot("ur5.urdf");
    check(
        RungeKutta4::new(HamiltonianSecondOrder::new(&ur5)),
        RungeKutta4::new(HamiltonianSecondOrder::new(&ur5)),
    );
    check(
        StoermerVerlet::new(HamiltonianSecondOrder::new(&ur5)),
        StoermerVerlet::new(HamiltonianSecondOrder::new(&ur5)),
    );
    check(
        ImplicitMidpoint::new(HamiltonianSecondOrder::new(&ur5)),
        ImplicitMidpoint::new(HamiltonianSecondOrder::new(&ur5)),
    );
}

/// One lane of a call that is not finite, or singular, is an error of the call: no lane is passed over.
#[test]
fn one_bad_lane_is_an_error_of_the_call() {
    let ur5 = robot("ur5.urdf");
    let mut hamiltonian = Hamiltonian::<Lanes<wide::f64x8>>::new(&ur5);
    let good = vec![Lanes::from(0.3); 6];
    assert!(hamiltonian.evaluate(&good, &good, &good).is_ok());
    for k in 0..8 {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut bad = good.clone();
            bad[2].as_mut_slice()[k] = value;
            let error = hamiltonian.evaluate(&good, &bad, &good).unwrap_err();
            assert!(matches!(error, EvalError::NonFinite { what: "p", index: 2, .. }), "{error}");
        }
    }
    let text = "name = 'gimbal'\n\
        [[joint]]\nname = 'z'\naxis = [0.0, 0.0, 1.0]\n\
        [[joint]]\nname = 'y'\naxis = [0.0, 1.0, 0.0]\n\
        [[joint]]\nname = 'x'\naxis = [1.0, 0.0, 0.0]\nmass = 1.0\ninertia = { xx = 0.2, yy = 0.3, zz = 0.4 }\n";
    let gimbal = costate::robot::file::parse(text, Default::default()).unwrap();
    let mut hamiltonian = Hamiltonian::<Lanes<wide::f64x4>>::new(&gimbal);
    for k in 0..4 {
        let mut q = vec![Lanes::from(0.3); 3];
        let p = vec![Lanes::from(0.1); 3];
        assert!(hamiltonian.evaluate(&q, &p, &p).is_ok());
        q[1].as_mut_slice()[k] = FRAC_PI_2;
        let error = hamiltonian.evaluate(&q, &p, &p).unwrap_err();
        assert!(matches!(error, EvalError::SingularMassMatrix { .. }), "{error}");
    }
}

/// So is a quaternion in one lane whose length is not 1.
#[test]
fn one_bad_quaternion_is_an_error_of_the_call() {
    let robot = robot("../tests/fixtures/free_tree.toml");
    let neutral = ConfigurationSpace::new(&robot).neutral();
    let mut hamiltonian = Hamiltonian::<Lanes<wide::f64x4>>::new(&robot);
    let p = vec![Lanes::from(0.1); robot.dof()];
    let good: Vec<_> = neutral.iter().map(|&q| Lanes::from(q)).collect();
    assert!(hamiltonian.evaluate(&good, &p, &p).is_ok());
    for free in robot.free_joints() {
        for k in 0..4 {
            let mut q = good.clone();
            q[free.quaternion() + 3].as_mut_slice()[k] = 1.1;
            let error = hamiltonian.evaluate(&q, &p, &p).unwrap_err();
            assert!(matches!(&error, EvalError::NotUnit { .. }), "{error}");
            assert!(error.to_string().contains(&free.name), "{error}");
        }
    }
}
