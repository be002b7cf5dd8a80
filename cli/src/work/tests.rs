//! Estimates against figures that were measured.

use super::{Method, Order, Work, refuse_excessive, refuse_excessive_count};
use costate::Coordinates;
use costate::robot::{JointSpec, LinkInertia, Robot};

fn chain(n: usize) -> Robot {
    let joint = |k: usize| {
        let spec = JointSpec::revolute(format!("j{k}")).axis([0.0, 1.0, 0.3]);
        let spec = spec.carrying(LinkInertia::point(1.0, [0.1, 0.0, -0.3])).armature(0.1);
        if k == 0 { spec } else { spec.on(format!("j{}", k - 1)) }
    };
    (0..n).map(joint).fold(Robot::builder("chain"), |builder, joint| builder.joint(joint)).build().unwrap()
}

#[test]
fn long_chains_are_excessive_and_robots_are_not() {
    for (n, excessive) in [(6, false), (12, false), (20, false), (200, true)] {
        for (method, coordinates) in [Method::HyperDual, Method::Nested, Method::Tensors]
            .into_iter()
            .flat_map(|method| Coordinates::ALL.map(|coordinates| (method, coordinates)))
        {
            let work = Work::of_state(&chain(n), coordinates, method, Order::Second);
            assert_eq!(work.is_excessive(), excessive, "{n} {method:?} {work}");
        }
        assert_eq!(refuse_excessive(&chain(n), false).is_err(), excessive, "{n}");
        assert_eq!(refuse_excessive_count(&chain(n), false).is_err(), excessive, "{n}");
        assert!(refuse_excessive(&chain(n), true).is_ok(), "{n}");
    }
    // Measured: more than 90 s.
    assert!(refuse_excessive_count(&chain(50), false).is_err());
}

#[test]
fn frames_have_their_work() {
    let (short, long) = (chain(6), chain(600));
    for method in [Method::Analytic, Method::HyperDual, Method::Nested] {
        let all = |robot, order| Work::of_frame(robot, method, order).times(256);
        assert!(!all(&short, Order::Second).is_excessive(), "{method:?}");
        assert!(all(&long, Order::Second).is_excessive(), "{method:?}");
    }
    let first = Work::of_frame(&long, Method::Analytic, Order::First);
    assert!(!first.times(256).is_excessive());
    let both = first.times(2).and(first);
    assert_eq!((both.operations, both.bytes), (0.0, 3.0 * first.bytes));
}

/// Measured on chains of revolute joints (MB).
#[test]
fn memory_is_estimated_within_a_factor_of_two() {
    use Coordinates::{Hamiltonian, Lagrangian};
    use Order::{First, Second};
    for (n, coordinates, method, order, megabytes) in [
        (1000, Hamiltonian, Method::Analytic, First, 605.0),
        (1000, Hamiltonian, Method::Analytic, Second, 815.0),
        (1000, Lagrangian, Method::Analytic, First, 890.0),
        (1000, Lagrangian, Method::Analytic, Second, 1500.0),
        (100, Hamiltonian, Method::Tensors, First, 620.0),
        (200, Hamiltonian, Method::Tensors, First, 9700.0),
        (100, Hamiltonian, Method::HyperDual, Second, 43.0),
        (1000, Hamiltonian, Method::Nested, First, 6100.0),
        (200, Lagrangian, Method::Nested, First, 378.0),
    ] {
        let work = Work::of_state(&chain(n), coordinates, method, order);
        let ratio = work.bytes / (1e6 * megabytes);
        assert!((0.5..2.0).contains(&ratio), "{n} {coordinates:?} {method:?} {order:?}: {work}");
    }
}
