//! The costate at a landing: the tip of the two-link arm hits a wall without rebound and slides along it.
//!
//! The state x = (q, p) is continuous; F changes from that of the open arm to that of the constrained one,
//! whose velocities are those after the impact. Where the instant t_1 is free, g(q(t_1)) = 0, y_p is
//! continuous and y_q jumps by a multiple of g_q, which the continuity of H* gives:
//!
//! ```text
//! y(t_1-) = y(t_1+) + nu (g_q, 0),    H*(t_1-) = H*(t_1+)
//! ```
//!
//! Where t_1 is given and the tip is caught wherever it is, y is continuous.

use costate::constraints::{ConstrainedHamiltonian, Constraints};
use costate::hamiltonian::Hamiltonian;
use costate::robot::{ConstraintRow, ConstraintSpec, Placement, Robot};
use nalgebra::{SMatrix, SVector, Vector2, Vector4};

/// Steps of order four before and after the landing.
const STEPS: usize = 200;
const END: f64 = 1.0;

/// (q, p, y_q, y_p).
type State = SVector<f64, 8>;

fn two_link() -> Robot {
    Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/two_link.toml")).unwrap()
}

/// The tip is on the wall at x = 1.2 m.
fn at_wall() -> Robot {
    let place = |x: f64| Placement::from_xyz_rpy([x, 0.0, 0.0], [0.0; 3]);
    let wall = ConstraintSpec::rows("wall", "elbow", "world", &[ConstraintRow::X]);
    two_link().with_constraint(wall.placed(place(1.0)).to_placed(place(1.2))).unwrap()
}

#[derive(Clone, Copy, PartialEq)]
enum Phase {
    InAir,
    OnWall,
}

/// Torques by the time and the costate.
type Control = fn(f64, &State) -> Vector2<f64>;

/// Least `∫ u^2 / 2 dt`.
fn optimal(_: f64, z: &State) -> Vector2<f64> {
    Vector2::new(-z[6], -z[7])
}

/// Torques that do not depend on the costate.
fn given(t: f64, _: &State) -> Vector2<f64> {
    Vector2::new((3.0 * t).sin() - 0.4, 0.5 - t * t)
}

struct Arm {
    free: Hamiltonian<f64>,
    held: ConstrainedHamiltonian<f64>,
    rows: Constraints<f64>,
    control: Control,
}

impl Arm {
    fn new(control: Control) -> Self {
        let (free, robot) = (Hamiltonian::new(&two_link()), at_wall());
        Self { free, held: ConstrainedHamiltonian::new(&robot), rows: Constraints::new(&robot), control }
    }

    /// x by q and v.
    fn start(&mut self, q: [f64; 2], v: [f64; 2]) -> Vector4<f64> {
        let p = self.free.momentum(&q, &v).unwrap();
        Vector4::new(q[0], q[1], p[0], p[1])
    }

    /// F and F_x.
    fn flow(&mut self, phase: Phase, z: &State, u: &Vector2<f64>) -> (Vector4<f64>, SMatrix<f64, 4, 4>) {
        let (q, p, u) = (&z.as_slice()[..2], &z.as_slice()[2..4], u.as_slice());
        let (f, f_x) = match phase {
            Phase::InAir => {
                let all = self.free.linearise(q, p, u).unwrap();
                (all.f().to_vec(), all.matrix().to_nalgebra())
            }
            Phase::OnWall => {
                let all = self.held.linearise(q, p, u).unwrap();
                (all.f().to_vec(), all.matrix().to_nalgebra())
            }
        };
        (Vector4::from_column_slice(&f), SMatrix::from_fn(|i, j| f_x[(i, j)]))
    }

    /// z', the running cost and H*.
    fn rate(&mut self, phase: Phase, t: f64, z: &State) -> (State, f64, f64) {
        let u = (self.control)(t, z);
        let (f, f_x) = self.flow(phase, z, &u);
        let y = z.fixed_rows::<4>(4).into_owned();
        let mut rate = State::zeros();
        rate.fixed_rows_mut::<4>(0).copy_from(&f);
        rate.fixed_rows_mut::<4>(4).copy_from(&-(f_x.transpose() * y));
        let cost = 0.5 * u.norm_squared();
        (rate, cost, cost + y.dot(&f))
    }

    /// From one instant to another, also backward; with the cost.
    fn move_on(&mut self, phase: Phase, [from, to]: [f64; 2], start: &State) -> (State, f64) {
        let dt = (to - from) / STEPS as f64;
        let (mut z, mut cost) = (*start, 0.0);
        for k in 0..STEPS {
            let t = from + k as f64 * dt;
            let (a, cost_a, _) = self.rate(phase, t, &z);
            let (b, cost_b, _) = self.rate(phase, t + 0.5 * dt, &(z + a * (0.5 * dt)));
            let (c, cost_c, _) = self.rate(phase, t + 0.5 * dt, &(z + b * (0.5 * dt)));
            let (d, cost_d, _) = self.rate(phase, t + dt, &(z + c * dt));
            z += (a + (b + c) * 2.0 + d) * (dt / 6.0);
            cost += dt / 6.0 * (cost_a + 2.0 * (cost_b + cost_c) + cost_d);
        }
        (z, cost)
    }

    /// g and g_q.
    fn gap(&mut self, z: &State) -> (f64, Vector2<f64>) {
        self.rows.set_position(&z.as_slice()[..2]).unwrap();
        let j = self.rows.jacobian();
        (self.rows.values()[0], Vector2::new(j[(0, 0)], j[(0, 1)]))
    }

    /// When the arm lands that starts so, and its state then: Newton's method for g(q(t)) = 0.
    fn landing(&mut self, start: &State) -> (f64, State) {
        let mut t = 0.3;
        for _ in 0..50 {
            let (z, _) = self.move_on(Phase::InAir, [0.0, t], start);
            let (gap, slope) = self.gap(&z);
            let (rate, _, _) = self.rate(Phase::InAir, t, &z);
            let step = gap / slope.dot(&rate.fixed_rows::<2>(0));
            if step.abs() < 1e-14 {
                return (t, z);
            }
            t -= step;
        }
        panic!("the arm does not land");
    }
}

fn with_costate(x: &Vector4<f64>, y: &Vector4<f64>) -> State {
    State::from_fn(|i, _| if i < 4 { x[i] } else { y[i - 4] })
}

fn costate(z: &State) -> Vector4<f64> {
    z.fixed_rows::<4>(4).into_owned()
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
