//! Guesses of long motions: to a pose in which it costs little to rest, a rest there, and on to the end.
//!
//! Torques hold a robot against gravity. A motion that takes all of a long time pays for that all along; one
//! that goes fast and rests somewhere in between pays less, and optimal motions have this form (a turnpike:
//! E. Trelat, E. Zuazua, The turnpike property in finite-dimensional nonlinear optimal control, J.
//! Differential Equations 258, 2015). From the cubic over the whole time Newton's method does not find it.
//!
//! For a way from rest to rest along a given curve, within the time t, inverse dynamics give `tau = g + h /
//! t^2` with the torques g that hold the robot. So an effort costs `S t + X / t + D / t^3`, and each way
//! takes the time at which this, less what rest costs meanwhile, is least.

use super::rest_pose::Rest;
use crate::constants::waiting as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::shape::{PLACES, WEIGHTS};
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::{PointDynamics, Points};
use crate::options::SolverOptions;
use crate::problem::limits::JointLimits;
use crate::problem::{FinalTime, Problem};
use costate::EvalError;
use costate::lagrangian::Lagrangian;

/// Replaces the guess of a long motion by one that rests in between, where that costs less. The ends of the
/// problem are places where its tools are as they shall be.
///
/// # Errors
/// Positions at which the dynamics cannot be evaluated.
pub(super) fn rest_between<D: PointDynamics>(
    problem: &Problem,
    options: &SolverOptions,
    interior: &mut Interior<D>,
) -> Result<(), EvalError> {
    let FinalTime::Fixed(time) = problem.time else { return Ok(()) };
    let n = interior.spline.dof;
    let ends = [0, 1].map(|end| {
        let mut state = vec![0.0; 2 * n];
        interior.spline.end(interior.spline.mesh.phases().min(end), &mut state);
        state
    });
    let rests = ends.iter().all(|state| state[n..].iter().all(|v| *v == 0.0));
    let simple = problem.vias.is_empty() && problem.periodic.is_none() && problem.loops.is_none();
    let costs = interior.running.effort.iter().any(|r| *r > 0.0);
    let [from, to] = ends.each_ref().map(|state| &state[..n]);
    if !(simple && rests && costs && is_slow([from, to], time, interior)?) {
        return Ok(());
    }
    let (limits, effort) = (problem.joint_limits(), interior.running.effort.clone());
    let model = Lagrangian::new(&problem.robot);
    let mut plans = Ways { model, ends: [from, to], effort: &effort, limits: &limits }.plans(time)?;
    plans.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let straight = interior.spline.clone();
    let Some([exceeded, cost]) = interior.figures_of(&straight) else { return Ok(()) };
    interior.spline = straight;
    for plan in plans {
        let moves = plan.rest[0] > 0.0 || plan.rest[1] < time;
        if !moves || plan.cost > constants::CHEAPER * cost {
            break;
        }
        let shape = interior.spline.mesh.shape;
        let nodes = plan.nodes(time);
        if shape.points_of(nodes.len() - 1) > options.max_nodes {
            break;
        }
        let at = |_: usize, s: f64, z: &mut [f64]| plan.at([from, to], time, s * time, z);
        let mut spline = Spline::through(n, Mesh::new(nodes, shape), vec![time], at);
        for end in 0..2 {
            let (place, own) = (spline.end_unknowns(end), interior.spline.end_unknowns(end));
            spline.unknowns[place].copy_from_slice(&interior.spline.unknowns[own]);
        }
        let kept = std::mem::take(&mut interior.spline);
        let found = interior.figures_of(&spline);
        if found.is_some_and(|[most, found]| {
            most <= exceeded.max(constants::ROOM) && found < constants::CHEAPER * cost
        }) {
            interior.spline = spline;
            return Ok(());
        }
        interior.spline = kept;
    }
    Ok(())
}

/// Whether it costs much more to hold the robot along the straight way than to move it, so that less time
/// would be cheaper.
fn is_slow<D: PointDynamics>(
    [from, to]: [&[f64]; 2],
    time: f64,
    interior: &mut Interior<D>,
) -> Result<bool, EvalError> {
    let n = from.len();
    let mut points = Points::default();
    points.resize_values(n, [0, 0], std::iter::once(5));
    for (p, z) in points.z.chunks_exact_mut(3 * n).enumerate() {
        for i in 0..n {
            // Start, middle, end; start and end with the accelerations of the cubic.
            z[i] = [from[i], 0.5 * (from[i] + to[i]), to[i], from[i], to[i]][p];
            let a = 6.0 * (to[i] - from[i]) / (time * time);
            z[2 * n + i] = [0.0, 0.0, 0.0, a, -a][p];
        }
    }
    interior.model.dynamics.evaluate_some(&mut points, 0..5)?;
    let effort = &interior.running.effort;
    let sum = |of: &dyn Fn(usize) -> f64| (0..n).map(|i| effort[i] * of(i) * of(i)).sum::<f64>();
    let hold = |p: usize| sum(&|i| points.tau(p)[i]);
    let move_it = |p: usize| sum(&|i| points.tau(p)[i] - points.tau(p - if p == 3 { 3 } else { 2 })[i]);
    Ok(hold(0) + 4.0 * hold(1) + hold(2) > constants::SLOW * (move_it(3) + move_it(4)))
}

/// What a way costs, and the least time that limits leave it.
struct Way {
    hold: f64,
    cross: f64,
    inertia: f64,
    shortest: f64,
}

impl Way {
    /// The time up to `most` at which the way costs least beside a rest of this cost a second, and by how
    /// much it costs more than such a rest.
    fn best(&self, most: f64, rest: f64) -> Option<(f64, f64)> {
        let more = |t: f64| (self.hold - rest) * t + self.cross / t + self.inertia / (t * t * t);
        let times = (0..constants::TIMES).map(|k| most * 2.0_f64.powf(-constants::OCTAVES * f64::from(k)));
        let times = times.filter(|&t| t >= self.shortest).map(|t| (t, more(t)));
        times.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Rest at a pose, from the first time to the second one.
struct Plan {
    pose: Vec<f64>,
    rest: [f64; 2],
    cost: f64,
}

impl Plan {
    /// The nodes: equal intervals on both ways, wider and wider ones towards the middle of the rest.
    fn nodes(&self, time: f64) -> Vec<f64> {
        let [from, to] = self.rest;
        let each = |way: f64| way / constants::INTERVALS as f64;
        let widths = match (from > 0.0, to < time) {
            (true, true) => [each(from), each(time - to)],
            (true, false) => [each(from); 2],
            _ => [each(time - to); 2],
        };
        let way = |from: f64, length: f64| {
            let count = if length > 0.0 { constants::INTERVALS } else { 0 };
            (0..count).map(move |k| from + length * k as f64 / constants::INTERVALS as f64)
        };
        let middle = 0.5 * (from + to);
        let mut left = vec![from];
        let mut right = vec![to];
        for (side, places) in [&mut left, &mut right].into_iter().enumerate() {
            let (mut width, sign) = (widths[side], if side == 0 { 1.0 } else { -1.0 });
            let mut place = places[0] + sign * width;
            while (middle - place) * sign > 0.5 * width {
                places.push(place);
                width *= constants::WIDER;
                place += sign * width;
            }
        }
        let rest = left.into_iter().chain(right.into_iter().rev());
        let inner = way(0.0, from).chain(rest).chain(way(to, time - to).skip(1));
        let mut nodes: Vec<f64> = inner.map(|t| t / time).filter(|s| *s > 0.0 && *s < 1.0).collect();
        nodes.insert(0, 0.0);
        nodes.push(1.0);
        nodes
    }

    /// q and its first two derivatives in s = t/T.
    fn at(&self, ends: [&[f64]; 2], time: f64, t: f64, z: &mut [f64]) {
        let n = self.pose.len();
        let [rest, leave] = self.rest;
        let pose = &self.pose[..];
        let (from, to, length, since) = if t < rest {
            (ends[0], pose, rest, t)
        } else if t > leave {
            (pose, ends[1], time - leave, t - leave)
        } else {
            (pose, pose, 1.0, 0.0)
        };
        let (x, scale) = (since / length, time / length);
        let cubic = [x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x) * scale, (6.0 - 12.0 * x) * scale * scale];
        for (order, factor) in cubic.into_iter().enumerate() {
            for i in 0..n {
                let start = if order == 0 { from[i] } else { 0.0 };
                z[n * order + i] = start + factor * (to[i] - from[i]);
            }
        }
    }
}

struct Ways<'a> {
    model: Lagrangian<f64>,
    /// Positions at the start and at the end.
    ends: [&'a [f64]; 2],
    effort: &'a [f64],
    limits: &'a [JointLimits],
}

impl Ways<'_> {
    /// Plans with a rest at one of several poses: both ends, the middle, and the poses near them in which the
    /// robot rests at the least cost.
    fn plans(&mut self, time: f64) -> Result<Vec<Plan>, EvalError> {
        let ([start, end], effort) = (self.ends, self.effort);
        let middle: Vec<f64> = start.iter().zip(end).map(|(a, b)| 0.5 * (a + b)).collect();
        let room = |limits: &JointLimits| {
            let [lower, upper] = limits.q;
            let part = constants::ROOM * (upper - lower);
            if part.is_finite() { [lower + part, upper - part] } else { [lower, upper] }
        };
        let within: Vec<[f64; 2]> = self.limits.iter().map(room).collect();
        let mut plans = Vec::new();
        for (k, from) in [start, end, &middle[..]].into_iter().enumerate() {
            let mut rest = Rest { model: &mut self.model, effort, limits: &within };
            let near = rest.near(from)?;
            let poses = if k < 2 { vec![from.to_vec(), near] } else { vec![near] };
            for pose in poses {
                let rest = Rest { model: &mut self.model, effort, limits: &within }.cost(&pose)?;
                plans.extend(self.plan(pose, rest, time)?);
            }
        }
        Ok(plans)
    }

    /// The plan with a rest at a pose that costs so much a second; `None` without time for both ways.
    fn plan(&mut self, pose: Vec<f64>, rest: f64, time: f64) -> Result<Option<Plan>, EvalError> {
        let (mut cost, mut taken) = (rest * time, [0.0; 2]);
        let ends = [(self.ends[0], &pose[..]), (&pose[..], self.ends[1])];
        for (taken, (from, to)) in taken.iter_mut().zip(ends) {
            if from == to {
                continue;
            }
            let way = self.way(from, to)?;
            let Some((own, more)) = way.best(constants::LONGEST * time, rest) else { return Ok(None) };
            (*taken, cost) = (own, cost + more);
        }
        Ok(Some(Plan { pose, rest: [taken[0], time - taken[1]], cost }))
    }

    /// The cubic from rest to rest in one second, and what it costs within other times.
    fn way(&mut self, from: &[f64], to: &[f64]) -> Result<Way, EvalError> {
        let n = from.len();
        let (mut way, still) = (Way { hold: 0.0, cross: 0.0, inertia: 0.0, shortest: 0.0 }, vec![0.0; n]);
        for (limits, (from, to)) in self.limits.iter().zip(from.iter().zip(to)) {
            // The peak of the rate is 3/2 of its mean.
            way.shortest = way.shortest.max(1.5 * (to - from).abs() / (constants::OF_RATES * limits.v));
        }
        for interval in 0..constants::INTERVALS {
            for (place, weight) in PLACES.iter().zip(WEIGHTS) {
                let x = (interval as f64 + place) / constants::INTERVALS as f64;
                let at = |factor: f64| from.iter().zip(to).map(move |(from, to)| factor * (to - from));
                let q: Vec<f64> =
                    from.iter().zip(at(x * x * (3.0 - 2.0 * x))).map(|(q, way)| q + way).collect();
                let (v, a): (Vec<f64>, Vec<f64>) =
                    (at(6.0 * x * (1.0 - x)).collect(), at(6.0 - 12.0 * x).collect());
                let holds = self.model.inverse_dynamics(&q, &still, &still)?.to_vec();
                let tau = self.model.inverse_dynamics(&q, &v, &a)?;
                let part = weight / constants::INTERVALS as f64;
                for (r, (g, tau)) in self.effort.iter().zip(holds.iter().zip(tau)) {
                    let h = tau - g;
                    way.hold += 0.5 * part * r * g * g;
                    way.cross += part * r * g * h;
                    way.inertia += 0.5 * part * r * h * h;
                }
            }
        }
        Ok(way)
    }
}
