//! Gaits of RABBIT integrated again, by equations of motion and an integrator that share nothing with the
//! solver.
//!
//! A motion of the direct method is a quartic p on each interval. With its torques u(t), those of inverse
//! dynamics at p, p' and p'', the links obey the equations of motion but for a torque r(t) of the ground,
//! which a point contact does not give: r is zero at Gauss's points, where the solver has the equations, and
//! not between them. Let F_s be the state after the landing, legs exchanged, of the motion with the torques
//! u that has a given state at the time s. V. M. Alekseev's formula for perturbed equations is exact,
//!
//! ```text
//! F_0(p(0)) = F_T(p(T)) - integral over the step of DF_s(p(s)) (0, M^-1 e r(s)) ds
//! ```
//!
//! with e the direction of r (E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations
//! I, section I.14). On each interval with G = DF_s (0, M^-1 e) and R the integral of r from its start, which
//! collocation makes small,
//!
//! ```text
//! |integral of G r ds| <= |G R| at its end + integral of |G'| |R| ds
//! ```
//!
//! So a step that is integrated misses its start by no more than the solver's landing does and the sum of
//! this over all intervals, in each component.

use super::dormand_prince::integrated;
use super::gaits::{ROWS, largest_difference};
use super::rabbit_on_one_foot::{EXCHANGED, LINKS, Links, OneFoot, Torques, joints, links, swing_foot};
use super::walking::{CLEARANCE, FRICTION, LENGTH, slippery, walk};
use costate::lagrangian::Lagrangian;
use costate_control::Solution;
use nalgebra::{SMatrix, SVector};

/// Angles and rates of the links.
type State = SVector<f64, { 2 * LINKS }>;
/// These, the work of the motors, and their work where they drive (J).
type Along = SVector<f64, { 2 * LINKS + 2 }>;

/// Of a step of the integrator, relative.
const TOLERANCE: f64 = 1e-12;
/// Parts of an interval in which the bound is summed.
const PARTS: usize = 64;
/// By how much sums and differences may be off that make the bound.
const SAFETY: f64 = 1.5;

/// The quartics of an interval.
struct Piece {
    duration: f64,
    /// By powers of the part of the interval.
    powers: [Links; ROWS],
}

impl Piece {
    /// Through the rows of an interval.
    fn through(t: &[f64], q: &[Vec<f64>]) -> Self {
        let duration = t[ROWS - 1] - t[0];
        let at = |row: usize| (t[row] - t[0]) / duration;
        let inverse = SMatrix::<f64, ROWS, ROWS>::from_fn(|row, power| at(row).powi(power as i32));
        let inverse = inverse.try_inverse().unwrap();
        let powers =
            std::array::from_fn(|power| (0..ROWS).map(|row| inverse[(power, row)] * links(&q[row])).sum());
        Self { duration, powers }
    }

    /// Angles, rates and accelerations at a time (s) from its start.
    fn at(&self, t: f64) -> [Links; 3] {
        let x = t / self.duration;
        let [mut a, mut w, mut acc] = [Links::zeros(); 3];
        for power in self.powers.iter().rev() {
            acc = acc * x + 2.0 * w;
            w = w * x + a;
            a = a * x + power;
        }
        [a, w / self.duration, acc / self.duration.powi(2)]
    }

    fn torques(&self, robot: &OneFoot, t: f64) -> (Torques, f64) {
        let [a, w, acc] = self.at(t);
        robot.torques([&a, &w, &acc])
    }
}

fn pieces(solution: &Solution) -> Vec<Piece> {
    let motion = &solution.trajectory;
    let intervals = motion.t.chunks_exact(ROWS).zip(motion.q.chunks_exact(ROWS));
    intervals.map(|(t, q)| Piece::through(t, q)).collect()
}

fn state(a: &Links, w: &Links) -> State {
    State::from_fn(|i, _| if i < LINKS { a[i] } else { w[i - LINKS] })
}

fn parts(state: &[f64]) -> [Links; 2] {
    [Links::from_column_slice(&state[..LINKS]), Links::from_column_slice(&state[LINKS..2 * LINKS])]
}

/// Along the pieces from a state, with their torques. `see` gets angles, rates and accelerations after each
/// step of the integrator.
fn integrate(robot: &OneFoot, pieces: &[Piece], from: &State, mut see: impl FnMut([&Links; 3])) -> Along {
    let mut y = Along::zeros();
    y.fixed_rows_mut::<{ 2 * LINKS }>(0).copy_from(from);
    for piece in pieces {
        let motion = |t: f64, y: &Along| {
            let ([a, w], (tau, _)) = (parts(y.as_slice()), piece.torques(robot, t));
            (a, w, robot.accelerations(&a, &w, tau), tau)
        };
        let rates = |t: f64, y: &Along| {
            let (_, w, acc, tau) = motion(t, y);
            let turns = [w[1] - w[0], w[2] - w[1], w[3] - w[0], w[4] - w[3]];
            let powers = tau.iter().zip(turns).map(|(tau, turns)| tau * turns);
            let works: [f64; 2] = [powers.clone().sum(), powers.map(|power: f64| power.max(0.0)).sum()];
            Along::from_iterator(w.iter().chain(acc.iter()).copied().chain(works))
        };
        y = integrated(y, piece.duration, TOLERANCE, rates, |t, y| {
            let (a, w, acc, _) = motion(t, y);
            see([&a, &w, &acc]);
        });
    }
    y
}

/// The state with which the next step begins, legs exchanged, and the impulse of the landing (N s).
fn landed(robot: &OneFoot, before: &[f64]) -> (State, [f64; 2]) {
    let [a, w] = parts(before);
    let (after, impulse) = robot.landed(&a, &w);
    let exchanged = |links: Links| Links::from(EXCHANGED.map(|link| links[link]));
    (state(&exchanged(a), &exchanged(after)), impulse)
}

/// How much more than the landing of the solver the integrated one may miss, in each component.
fn bound(robot: &OneFoot, pieces: &[Piece]) -> State {
    // The effect of an impulse of the ground of 1 N m s at the start of each piece, and at the end.
    let by_impulse = |k: usize| {
        const SMALL: f64 = 1e-4;
        let [a, w, _] =
            if k < pieces.len() { pieces[k].at(0.0) } else { pieces[k - 1].at(pieces[k - 1].duration) };
        let after = |impulse: f64| {
            let from = state(&a, &(w + impulse * robot.turned(&a)));
            landed(robot, integrate(robot, &pieces[k..], &from, |_| ()).as_slice()).0
        };
        (after(SMALL) - after(-SMALL)) / (2.0 * SMALL)
    };
    let effects: Vec<State> = (0..=pieces.len()).map(by_impulse).collect();
    let mut sum = State::zeros();
    for (piece, effects) in pieces.iter().zip(effects.windows(2)) {
        let part = piece.duration / PARTS as f64;
        let change = (effects[1] - effects[0]).abs() / piece.duration;
        let mut missing = 0.0;
        for k in 0..PARTS {
            let by = piece.torques(robot, (k as f64 + 0.5) * part).1 * part;
            sum += change * (missing + 0.5 * by).abs() * part;
            missing += by;
        }
        sum += effects[1].abs() * missing.abs();
    }
    SAFETY * sum
}

/// Integrates a gait again: it must come back to its start, keep its energy, press the ground within this
/// friction and swing its foot above it. Gives the largest friction that it uses.
fn check(solution: &Solution, friction: f64) -> f64 {
    let (robot, pieces, motion) = (OneFoot::new(), pieces(solution), &solution.trajectory);
    assert_eq!(motion.t.len(), ROWS * pieces.len());
    // The quartics are those of the motion; at Gauss's points their torques and forces are those told.
    let force = &solution.constraints[0].force;
    let [mut rates, mut torques, mut missing, mut forces] = [0.0_f64; 4];
    for (k, row) in (0..motion.t.len()).map(|row| (row / ROWS, row)) {
        let [a, w, acc] = pieces[k].at(motion.t[row] - motion.t[ROWS * k]);
        rates = rates.max((w - links(&motion.v[row])).amax());
        if (1..ROWS - 1).contains(&(row % ROWS)) {
            let (tau, left) = robot.torques([&a, &w, &acc]);
            let [x, z] = robot.ground([&a, &w, &acc]);
            missing = missing.max(left.abs());
            torques = torques.max(largest_difference(&tau, &motion.u[row][3..]));
            forces = forces.max(largest_difference(&[x, 0.0, z], &force[row]));
        }
    }
    let ([a, w, _], last) = (pieces[0].at(0.0), &pieces[pieces.len() - 1]);
    let start = state(&a, &w);
    let [mut lowest, mut lightest, mut steepest] = [f64::INFINITY, f64::INFINITY, 0.0];
    let end = integrate(&robot, &pieces, &start, |[a, w, acc]| {
        let [x, z] = swing_foot(a);
        lowest = lowest.min(z - CLEARANCE * (1.0 - (x / LENGTH).powi(2)));
        let [along, up] = robot.ground([a, w, acc]);
        (lightest, steepest) = (lightest.min(up), steepest.max(along.abs() / up));
    });
    let (after, impulse) = landed(&robot, end.as_slice());
    let by_solver =
        landed(&robot, state(&last.at(last.duration)[0], &last.at(last.duration)[1]).as_slice()).0;
    let (own, miss, bound) = ((by_solver - start).abs(), (after - start).abs(), bound(&robot, &pieces));
    let energy = |state: &[f64]| {
        let [a, w] = parts(state);
        robot.energy(&a, &w)
    };
    let [work, driving] = [end[2 * LINKS], end[2 * LINKS + 1]];
    let [begins, ends, lands] = [energy(start.as_slice()), energy(end.as_slice()), energy(after.as_slice())];
    let gait = solution.gait.as_ref().unwrap();
    println!(
        "{} intervals; at points: rates {rates:.1e} torques {torques:.1e} missing {missing:.1e} forces \
         {forces:.1e}; own {:.1e} miss {:.1e} bound {:.1e}; lowest {lowest:.1e} lightest {lightest:.3} steepest \
         {steepest:.6}; impulse {impulse:?}; work {work:.9} {driving:.9}; energy {begins:.9} {ends:.9} {lands:.9}; \
         {gait:?}",
        pieces.len(),
        own.max(),
        miss.max(),
        bound.max(),
    );
    assert!(rates < 1e-9 && torques < 1e-4 && missing < 1e-4 && forces < 1e-3);
    assert!((ends - begins - work).abs() < 1e-8, "{begins} {ends} {work}");
    assert!(
        (ends - lands - gait.loss).abs() < 1e-5 && (lands - begins).abs() < 1e-5,
        "{ends} {lands} {begins}"
    );
    assert!((driving - gait.work).abs() < 1e-3 * driving, "{driving}");
    assert!(largest_difference(&[impulse[0], 0.0, impulse[1]], &gait.impulses[0]) < 1e-4, "{impulse:?}");
    assert!(
        lightest > 0.0 && steepest <= friction * 1.001 && lowest > -1e-5,
        "{lightest} {steepest} {lowest}"
    );
    assert!(bound.max() < 5e-4 && miss.max() < 5e-6, "{bound} {miss}");
    assert!(bound.iter().zip(&own).zip(&miss).all(|((bound, own), miss)| *miss <= own + bound + 1e-9));
    steepest
}

/// The equations are those of robots/rabbit.toml: inverse dynamics of the robot with a force and a torque of
/// the ground on its foot.
#[test]
fn the_equations_are_those_of_rabbit() {
    let robot = OneFoot::new();
    let some = |first: f64| Links::from_fn(|i, _| (first + 1.7 * i as f64).sin());
    let motion = [&some(0.3), &some(1.0), &some(2.0)];
    let [q, v, a] = joints(motion);
    let found = Lagrangian::<f64>::new(&walk().0.robot).inverse_dynamics(&q, &v, &a).unwrap().to_vec();
    let ([hip, knee, other_hip, other_knee], missing) = robot.torques(motion);
    let [x, z] = robot.ground(motion);
    // The foot is below the hips by (q[0], q[1]), and below the knee by the tibia.
    let tibia = [0.4 * motion[0][4].sin(), 0.4 * motion[0][4].cos()];
    let moment = |[ahead, up]: [f64; 2]| missing + z * ahead - x * up;
    let about_hips = moment([q[0], q[1]]);
    let expected = [x, z, about_hips, hip, knee, about_hips + other_hip, moment(tibia) + other_knee];
    assert!(largest_difference(&found, &expected) < 1e-10, "{found:?} {expected:?}");
    assert!((links(&q) - motion[0]).amax() < 1e-14, "{q:?}");
    let again = robot.accelerations(motion[0], motion[1], [hip, knee, other_hip, other_knee]);
    let without = again + missing * robot.turned(motion[0]);
    assert!((without - motion[2]).amax() < 1e-10, "{without} {}", motion[2]);
}

#[test]
fn a_step_comes_back_to_its_start() {
    let used = check(&walk().1, FRICTION);
    // The ground is rougher than the cheapest gait needs.
    assert!(used < 0.9 * FRICTION, "{used}");
}

#[test]
fn a_step_on_slippery_ground_comes_back_to_its_start() {
    let (friction, solution) = slippery();
    let used = check(solution, *friction);
    assert!(used > 0.99 * friction && used < 1.001 * friction, "{used} {friction}");
}
