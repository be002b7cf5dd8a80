//! The gradient of a function of the end through a landing, for given torques.

use super::{Arm, END, Phase, State, costate, with_costate};
use nalgebra::{Vector2, Vector4};

/// Torques that do not depend on the costate.
fn given(t: f64, _: &State) -> Vector2<f64> {
    Vector2::new((3.0 * t).sin() - 0.4, 0.5 - t * t)
}

/// Which instant the tip is caught at.
#[derive(Clone, Copy)]
enum Instant {
    /// When it reaches the wall.
    Free,
    /// This one, wherever the tip is.
    Given(f64),
}

/// For given torques the costate at the start is the gradient of a function of the end.
#[test]
fn the_gradient_through_a_landing_needs_the_jump_of_the_costate_if_the_instant_is_free() {
    let mut arm = Arm::new(given);
    let weights = Vector4::new(0.7, -0.4, 0.9, 0.5);
    let from = arm.start([0.9, 0.9], [-1.0, -0.8]);
    let end = |arm: &mut Arm, x: &Vector4<f64>, instant: Instant| {
        let start = with_costate(x, &Vector4::zeros());
        let (t, landed) = match instant {
            Instant::Free => arm.landing(&start),
            Instant::Given(t) => (t, arm.move_on(Phase::InAir, [0.0, t], &start).0),
        };
        let (end, _) = arm.move_on(Phase::OnWall, [t, END], &landed);
        (t, landed, end)
    };
    for instant in [Instant::Free, Instant::Given(0.25)] {
        let (t, landed, last) = end(&mut arm, &from, instant);
        assert!(0.1 < t && t < 0.8, "{t}");
        let last = with_costate(&last.fixed_rows::<4>(0).into_owned(), &weights);
        let (after, _) = arm.move_on(Phase::OnWall, [END, t], &last);
        let y = costate(&after);
        // H* is continuous: nu g_q . v- = y . (F+ - F-).
        let u = given(t, &landed);
        let [before_impact, after_impact] =
            [Phase::InAir, Phase::OnWall].map(|phase| arm.flow(phase, &landed, &u).0);
        let (_, g_q) = arm.gap(&landed);
        let nu = y.dot(&(after_impact - before_impact)) / g_q.dot(&before_impact.fixed_rows::<2>(0));
        let jumped = y + Vector4::new(nu * g_q[0], nu * g_q[1], 0.0, 0.0);
        assert!(nu.abs() > 0.05, "{nu}");
        let [continuous, jumping] = [y, jumped].map(|y| {
            let x = landed.fixed_rows::<4>(0).into_owned();
            costate(&arm.move_on(Phase::InAir, [t, 0.0], &with_costate(&x, &y)).0)
        });
        let step = 1e-5;
        let gradient = Vector4::from_fn(|i, _| {
            let mut at = |side: f64| {
                let mut x = from;
                x[i] += side * step;
                weights.dot(&end(&mut arm, &x, instant).2.fixed_rows::<4>(0))
            };
            (at(1.0) - at(-1.0)) / (2.0 * step)
        });
        let (right, wrong) = match instant {
            Instant::Free => (jumping, continuous),
            Instant::Given(_) => (continuous, jumping),
        };
        assert!((gradient - right).amax() < 1e-7, "{t}: {gradient} {right}");
        assert!((gradient - wrong).amax() > 1e-2, "{t}: {gradient} {wrong}");
    }
}
