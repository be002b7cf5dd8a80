//! Newton steps allocate nothing, whatever the problem asks for.

use super::start::Again;
use crate::direct::interior::iterate::Interior;
use crate::direct::interior::iterate::tests::started_with;
use crate::direct::motion::shape::Shape;
use crate::direct::points::values::PointDynamics;
use crate::problem::{Payload, Via};
use costate_test_support::allocations::allocations;

/// Two vias, of which the first changes what is carried.
fn vias() -> [Via; 2] {
    let tip = Payload::point("joint:elbow", 0.5, [1.0, 0.0, 0.0]);
    let first = Via::at(&[0.4, 0.3]).with_q_free(&[1]).with_payload(tip);
    [first, Via::at(&[0.8, -0.2]).with_v(&[0.1, 0.2]).with_time(0.6)]
}

/// Steps after others, in which there came to be room for what only some steps need.
fn steps_allocate_nothing<D: PointDynamics>(mut interior: Interior<D>, what: &str) {
    interior.reserve(&mut Again::new(2, &[]));
    interior.iterate(1e-9, 25, |_, _| None).unwrap();
    let before = interior.figures.iterations;
    let found = allocations(|| {
        let _ = interior.iterate(1e-9, 25, |_, _| None).unwrap();
    });
    let steps = interior.figures.iterations - before;
    assert!(found == 0 && steps > 0, "{what}: {found} allocations in {steps} steps");
}

#[test]
fn steps_with_vias_jerks_and_torque_rates_allocate_nothing() {
    for (shape, name) in [(Shape::Quartic, "quartics"), (Shape::Quintic, "quintics")] {
        steps_allocate_nothing(started_with(shape, &[]), name);
        steps_allocate_nothing(started_with(shape, &vias()), &format!("{name} with vias"));
    }
}

#[test]
fn steps_of_the_elastic_phase_allocate_nothing() {
    for vias in [&[][..], &vias()] {
        let mut interior = started_with(Shape::Quartic, vias);
        interior.relax(None).unwrap();
        steps_allocate_nothing(interior, &format!("elastic with {} vias", vias.len()));
    }
}
