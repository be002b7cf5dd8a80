//! The best motion with a landing on the way, by shooting.

use super::{Arm, END, Phase, State, with_costate};
use nalgebra::{SMatrix, SVector, Vector2, Vector4};

/// Least `∫ u^2 / 2 dt`.
fn optimal(_: f64, z: &State) -> Vector2<f64> {
    Vector2::new(-z[6], -z[7])
}

/// y(0), nu and t_1.
type Unknowns = SVector<f64, 6>;

/// An extremal: what misses, the cost, and H* before less that after the landing.
struct Shot {
    residual: Unknowns,
    cost: f64,
    step_of_h: f64,
}

/// Where the arm ends: on the wall, at rest, so far from `near` along it.
struct Ending {
    near: Vector2<f64>,
    along: Vector2<f64>,
    across: Vector2<f64>,
    target: Vector2<f64>,
}

/// The motion with these unknowns. Conditions: g = 0 and the same H* at the landing, or t_1 as it is given;
/// Z'(q - near) and Z'p as they are to be at the end, J y_q = 0 and J y_p = 0.
fn shoot(arm: &mut Arm, from: &Vector4<f64>, end: &Ending, w: &Unknowns, instant: Option<f64>) -> Shot {
    let (nu, t) = (w[4], w[5]);
    let start = with_costate(from, &w.fixed_rows::<4>(0).into_owned());
    let (before, first) = arm.move_on(Phase::InAir, [0.0, t], &start);
    let (gap, g_q) = arm.gap(&before);
    let mut after = before;
    (0..2).for_each(|i| after[4 + i] -= nu * g_q[i]);
    let [h_before, h_after] =
        [(Phase::InAir, before), (Phase::OnWall, after)].map(|(phase, z)| arm.rate(phase, t, &z).2);
    let (last, second) = arm.move_on(Phase::OnWall, [t, END], &after);
    let two = |first: usize| Vector2::new(last[first], last[first + 1]);
    let step_of_h = h_before - h_after;
    let residual = Unknowns::from([
        gap,
        instant.map_or(step_of_h, |given| t - given),
        end.along.dot(&(two(0) - end.near)) - end.target[0],
        end.along.dot(&two(2)) - end.target[1],
        end.across.dot(&two(4)),
        end.across.dot(&two(6)),
    ]);
    Shot { residual, cost: first + second, step_of_h }
}

/// Newton's method with differences.
fn solved(
    arm: &mut Arm,
    from: &Vector4<f64>,
    end: &Ending,
    start: &Unknowns,
    instant: Option<f64>,
) -> (Unknowns, Shot) {
    let mut w = *start;
    for _ in 0..30 {
        let shot = shoot(arm, from, end, &w, instant);
        if shot.residual.amax() < 1e-11 {
            return (w, shot);
        }
        let step = 1e-6;
        let mut jacobian = SMatrix::<f64, 6, 6>::zeros();
        for j in 0..6 {
            let [above, below] = [step, -step].map(|step| {
                let mut at = w;
                at[j] += step;
                shoot(arm, from, end, &at, instant).residual
            });
            jacobian.set_column(j, &((above - below) / (2.0 * step)));
        }
        let change = jacobian.lu().solve(&shot.residual).unwrap();
        w -= change * (2.0 / change.amax()).min(0.02 / change[5].abs()).min(1.0);
    }
    let shot = shoot(arm, from, end, &w, instant);
    assert!(shot.residual.amax() < 1e-9, "{}", shot.residual);
    (w, shot)
}

/// An optimal landing: the cost of the best motions that land at given instants is least where H* is
/// continuous, and its derivative by the start is the costate there.
#[test]
fn the_best_instant_of_a_landing_is_where_the_hamiltonian_is_continuous() {
    let mut arm = Arm::new(optimal);
    let from = arm.start([0.9, 0.9], [-1.0, -0.8]);
    // Without torques it is an extremal for the end that it comes to.
    let (t, landed) = arm.landing(&with_costate(&from, &Vector4::zeros()));
    let (last, _) = arm.move_on(Phase::OnWall, [t, END], &landed);
    let (_, across) = arm.gap(&last);
    let along = Vector2::new(-across[1], across[0]).normalize();
    let near = Vector2::new(last[0], last[1]);
    let glide = along.dot(&Vector2::new(last[2], last[3]));
    let mut w = Unknowns::from([0.0, 0.0, 0.0, 0.0, 0.0, t]);
    let mut end = Ending { near, along, across, target: Vector2::new(0.0, glide) };
    // To rest, somewhat aside.
    let mut shot = shoot(&mut arm, &from, &end, &w, None);
    assert!(shot.residual.amax() < 1e-12, "{}", shot.residual);
    for k in 1..=10 {
        let part = f64::from(k) / 10.0;
        end.target = Vector2::new(0.15 * part, glide * (1.0 - part));
        (w, shot) = solved(&mut arm, &from, &end, &w, None);
    }
    println!(
        "y(0) {:?} nu {} t_1 {} cost {} step {:.1e}",
        &w.as_slice()[..4],
        w[4],
        w[5],
        shot.cost,
        shot.step_of_h
    );
    assert!(w[4].abs() > 0.05 && (w[5] - t).abs() > 1e-3, "the landing has moved from {t}: {w}");
    let best = shot.cost;
    for side in [-1.0, 1.0] {
        let (mut other, mut before) = (w, best);
        for _ in 0..3 {
            let at = other[5] + 0.005 * side;
            let (moved, shot) = solved(&mut arm, &from, &end, &other, Some(at));
            assert!(shot.cost > before, "{at}: {} {before}", shot.cost);
            let step = 1e-5;
            let [later, earlier] =
                [step, -step].map(|step| solved(&mut arm, &from, &end, &moved, Some(at + step)).1.cost);
            let slope = (later - earlier) / (2.0 * step);
            println!("t_1 {at} cost {} slope {slope} {}", shot.cost, shot.step_of_h);
            assert!(
                (slope - shot.step_of_h).abs() < 1e-5 * slope.abs().max(1.0),
                "{slope} {}",
                shot.step_of_h
            );
            (other, before) = (moved, shot.cost);
        }
    }
    for i in 0..4 {
        let step = 1e-5;
        let [above, below] = [step, -step].map(|step| {
            let mut x = from;
            x[i] += step;
            solved(&mut arm, &x, &end, &w, None).1.cost
        });
        let slope = (above - below) / (2.0 * step);
        assert!((slope - w[i]).abs() < 1e-5 * w.amax(), "{i}: {slope} {}", w[i]);
    }
}
