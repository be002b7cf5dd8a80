//! Where motions of robots with floating and spherical joints begin.

use super::task::FreeTask;
use super::unsolved::Unsolved;
use crate::constants::free_motions::PLACES;
use crate::cubics::{Disturbance, JointState, cubic};
use crate::problem::free_joints::{normalised, orientation};
use crate::result::free_entries::FreeEntries;
use crate::result::trajectory::Trajectory;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{FreeJoint, FreeKind};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// States and controls at times.
pub(super) struct Guess {
    pub t: Vec<f64>,
    pub x: Vec<Vec<f64>>,
    pub u: Vec<Vec<f64>>,
}

/// A saved motion.
pub(super) fn of_motion(task: &FreeTask<'_>, motion: &Trajectory) -> Guess {
    let once = motion.with_each_time_once();
    let robot = &task.problem.robot;
    let x = once.q.iter().zip(&once.p).map(|(q, p)| [normalised(robot, q), p.clone()].concat()).collect();
    let u = once.u.iter().map(|row| task.driven.iter().map(|&i| row[i]).collect()).collect();
    Guess { t: once.t, x, u }
}

/// Cubics of positions, and turns about the axes that lead from start to end, the short way round; of
/// further starts the other way round too, with waves in positions. What floats without a motor falls as
/// gravity says: Newton's method finds no way from a momentum that is far off. Controls are those of the
/// momenta.
pub(super) fn simple(task: &FreeTask<'_>, seed: u64, number: usize) -> Result<Guess, Unsolved> {
    let path = Path::new(task, seed, number);
    let time = task.problem.time.value();
    let (n, nq) = (task.dof(), task.nq());
    let mut model = Hamiltonian::<f64>::new(&task.problem.robot);
    let mut guess = Guess { t: Vec::new(), x: Vec::new(), u: Vec::new() };
    let mut falls = task.problem.free_falls()?;
    let none = vec![0.0; n];
    let mut forces = Vec::new();
    for k in 0..=PLACES {
        let s = k as f64 / PLACES as f64;
        let (mut q, mut v) = path.at(s);
        for fall in &mut falls {
            fall.place(s * time, &mut q, &mut v, &mut model)?;
        }
        let p = model.momentum(&q, &v)?.to_vec();
        forces.push(model.evaluate(&q, &p, &none)?[n..].to_vec());
        guess.t.push(s * time);
        guess.x.push([q, p].concat());
    }
    let step = time / PLACES as f64;
    for (k, force) in forces.iter().enumerate() {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(PLACES));
        let control = |&i: &usize| {
            let change = guess.x[after][nq + i] - guess.x[before][nq + i];
            let rate = change / ((after - before) as f64 * step);
            (rate - force[i]) / task.problem.gain[i]
        };
        let u: Vec<f64> = task.driven.iter().map(control).collect();
        guess.u.push(u);
    }
    Ok(guess)
}

/// A way from start to end.
struct Path<'a> {
    task: &'a FreeTask<'a>,
    disturbance: Disturbance,
    free: Vec<FreeEntries>,
    /// The rotation vector of each joint from start to end.
    turns: Vec<Vector3<f64>>,
    /// dq/dt at both ends.
    rates: [Vec<f64>; 2],
}

impl<'a> Path<'a> {
    fn new(task: &'a FreeTask<'a>, seed: u64, number: usize) -> Self {
        let (problem, nq) = (task.problem, task.nq());
        let free = FreeEntries::of(&problem.robot);
        let states = [(&task.start, &problem.start.v), (&task.end.x, &problem.end.v)];
        let rates = states.map(|(x, v)| FreeEntries::rates(&free, &x[..nq], v));
        let turn = |free: &FreeJoint| {
            let start = orientation(free, &task.start);
            let short = (start.inverse() * orientation(free, &task.end.x)).scaled_axis();
            match (short.try_normalize(0.0), number % 2) {
                (Some(axis), 1) => short - axis * std::f64::consts::TAU,
                _ => short,
            }
        };
        Self {
            // The other way round is a guess of its own.
            disturbance: Disturbance::draw(problem, seed, if number == 1 { 0 } else { number }),
            turns: problem.robot.free_joints().iter().map(turn).collect(),
            task,
            free,
            rates,
        }
    }

    /// q and v at s = t/T.
    fn at(&self, s: f64) -> (Vec<f64>, Vec<f64>) {
        let (problem, nq) = (self.task.problem, self.task.nq());
        let time = problem.time.value();
        let (mut q, mut rates) = (vec![0.0; nq], vec![0.0; nq]);
        let mut set = |entry: usize| {
            let state = |x: &[f64], rates: &[f64]| JointState { q: x[entry], v: rates[entry] };
            let (from, to) =
                (state(&self.task.start, &self.rates[0]), state(&self.task.end.x, &self.rates[1]));
            let at = self.disturbance.add(entry, time, s, cubic(from, to, time, s));
            (q[entry], rates[entry]) = (at.q, at.v);
        };
        problem.robot.plain_entries().for_each(|(entry, _)| set(entry));
        for free in problem.robot.free_joints().iter().filter(|free| free.kind == FreeKind::Floating) {
            (free.position..free.position + 3).for_each(&mut set);
        }
        let (part, slope) = (s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / time);
        for (free, turn) in problem.robot.free_joints().iter().zip(&self.turns) {
            let at = free.quaternion();
            let x = &self.task.start;
            let start = Quaternion::new(x[at + 3], x[at], x[at + 1], x[at + 2]);
            let turned = start * UnitQuaternion::from_scaled_axis(turn * part).into_inner();
            let rate = turned * Quaternion::from_imag(turn * slope) * 0.5;
            q[at..at + 4].copy_from_slice(turned.coords.as_slice());
            rates[at..at + 4].copy_from_slice(rate.coords.as_slice());
        }
        let v = FreeEntries::velocities(&self.free, &mut q, &rates);
        (q, v)
    }
}
