//! Hands a motion of the direct method to the verification that does not know it.

use super::costates::costates;
use super::verify::Again;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::at_node::AtNode;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::power::Powers;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::spline::Spline;
use crate::direct::points::closed_points::ClosedPoints;
use crate::direct::points::values::{PointDynamics, Points};
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::problem::loop_rows::Loops;
use crate::result::verification::{Check, Verification};
use crate::task::accelerations::ToolAccelerations;
use crate::task::build::TaskRows;
use crate::task::functions::{PathFunction, TaskFunctions};
use crate::verify::cost::cost;
use crate::verify::dynamics::{InverseDynamics, Trees};
use crate::verify::limits::{Excess, Quantity, excesses};
use crate::verify::motion::defects;
use crate::verify::optimality::{self, Conditions, Multipliers, Prices};
use crate::verify::running::Running;
use crate::verify::splits::Splits;
use costate::EvalError;

/// Seed of random times: the same motion is verified in the same way.
const SEED: u64 = 43;

/// What the verification found, and what it wants to see on a finer mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Independent {
    pub verification: Verification,
    /// For each interval what it adds to the largest value that fails, in parts of its tolerance; empty where
    /// nothing fails.
    pub blame: Vec<f64>,
    /// Places in s at which something narrow happens.
    pub narrow: Vec<f64>,
}

/// Verifies a motion whose points are contracted. `size` is that of the cost, `again` its integration by an
/// explicit method, where that was done. Unless the cost `is_compared` with that on a finer mesh, the gap
/// alone says what the mesh costs: it must be within the tolerance then.
pub(crate) fn verify<D: PointDynamics>(
    (problem, rows): (&Problem, &TaskRows),
    options: &SolverOptions,
    interior: &mut Interior<D>,
    solver_cost: f64,
    again: Option<&Again>,
    is_compared: bool,
) -> Independent {
    let mut found = Independent::default();
    let gap_allowed = if is_compared { constants::GAP } else { 1.0 } * options.tolerance;
    if options.verify != Verify::Full {
        return found;
    }
    let (tolerance, size) = (options.tolerance, interior.figures.size);
    let path = interior.spline.path();
    let splits = Splits::new(problem, &path);
    let mesh = &interior.spline.mesh;
    let inner = splits.segments().filter(|(_, [from, _])| *from > 0.0);
    found.narrow = inner.map(|(k, [from, _])| mesh.nodes[k] + from * mesh.width(k)).collect();
    let mut dynamics: Box<dyn InverseDynamics> = match &problem.loops {
        Some(loops) => Box::new(ClosedDynamics::new(loops)),
        None => Box::new(Trees::new(&problem.robots())),
    };
    let mut running = Running::new(problem, rows);
    let (limits, joints) = (problem.joint_limits(), problem.robot.dof());
    let names = problem.named_coordinates().0;
    let verification = &mut found.verification;
    let unknown = |error: &EvalError| Check::skipped(error.to_string());

    match cost(&path, &splits, &mut *dynamics, &mut running, [tolerance, size]) {
        Ok([own, penalty]) => {
            let error = (own.error + penalty.error) / size;
            verification.integrated_cost = Some(own.value);
            verification.quadrature_error = Some(error);
            let difference = (own.value + penalty.value - solver_cost).abs() / size + error;
            verification.cost = Check::of(difference, tolerance);
        }
        Err(error) => verification.cost = unknown(&error),
    }

    let sizes = path.sizes(constants::LEAST_SCALE, constants::REST, joints);
    let bound = constants::VERIFIED * tolerance.sqrt();
    let is_driven = problem.loops.is_none() && limits[..joints].iter().all(|l| l.torque[0] < l.torque[1]);
    let mut of_nodes = Vec::new();
    if let (Some(again), true) = (again, is_driven) {
        verification.dynamics = Check::of(again.miss, bound);
    }
    if !verification.dynamics.passes() {
        match defects((&path, &splits), &mut *dynamics, &limits, &sizes, joints, bound) {
            Ok(defects) => {
                let time = defects.worst.map(|(k, _)| path.pieces[k].start + path.pieces[k].length);
                let subject = defects.worst.map(|(_, i)| names[i].clone());
                verification.dynamics = Check::of(defects.sum(), bound).at(time, subject);
                of_nodes = defects.pieces;
            }
            Err(_) if verification.dynamics.fails() => {}
            Err(crate::numerics::radau::Failed::Evaluation(error)) => {
                verification.dynamics = unknown(&error);
            }
            Err(crate::numerics::radau::Failed::TooManySteps) => {
                verification.dynamics = Check::of(f64::INFINITY, bound);
            }
        }
    }

    let excesses = excesses(problem, (&path, &splits), &mut *dynamics, rows, joints, SEED);
    let mut of_limits = None;
    match &excesses {
        Ok(all) => {
            let is_smooth = mesh.shape.is_smooth();
            let worst = |jumps: bool| {
                let own = all.iter().filter(|excess| self::jumps(excess.quantity, is_smooth) == Some(jumps));
                own.max_by(|a, b| a.part.total_cmp(&b.part))
            };
            let check = |worst: Option<&Excess>, allowed: f64| match worst {
                Some(worst) => {
                    let name = name_of(worst, rows, &names);
                    Check::of(worst.part, allowed).at(Some(worst.time), Some(name))
                }
                None => Check::of(0.0, allowed),
            };
            verification.limits = check(worst(false), 2.0 * constants::VIOLATION_BETWEEN);
            verification.overshoot = check(worst(true), constants::OVERSHOOT);
            of_limits = worst(false).map(|worst| worst.piece);
        }
        Err(error) => verification.limits = unknown(error),
    }

    let mut gaps = Vec::new();
    match why_not(problem, interior) {
        Some(reason) => verification.optimality = Check::skipped(reason),
        None => {
            let found = costates(interior);
            let costates = optimality::Costates {
                left: found.at_nodes[..found.before.len()].to_vec(),
                right: found.before,
                jumps: (0..interior.spline.mesh.intervals()).map(|k| jump(interior, k)).collect(),
            };
            // A cost of torques that was added belongs to the motion.
            let mut running = running.with_effort(interior.running.effort.clone());
            let mut sides = Sides::new(interior, rows);
            let conditions = Conditions {
                path: &path,
                splits: &splits,
                dynamics: &mut *dynamics,
                running: &mut running,
                multipliers: &mut sides,
                limits: &limits,
            };
            match optimality::check(conditions, &costates, tolerance, SEED) {
                Ok(found) => {
                    let (time, subject) = match found.worst {
                        Some((time, i)) => (Some(time), names.get(i).cloned()),
                        None => (None, None),
                    };
                    verification.optimality = Check::of(found.gap / size, gap_allowed).at(time, subject);
                    verification.stationarity = Some(found.stationarity);
                    verification.costate_defect = Some(found.defect);
                    gaps = found.causes(tolerance);
                }
                Err(crate::numerics::radau::Failed::Evaluation(error)) => {
                    verification.optimality = unknown(&error);
                }
                Err(crate::numerics::radau::Failed::TooManySteps) => {
                    verification.optimality = Check::of(f64::INFINITY, gap_allowed);
                }
            }
        }
    }

    found.blame = vec![0.0; path.pieces.len()];
    let mut blame = |parts: &[f64], scale: f64| {
        found.blame.iter_mut().zip(parts).for_each(|(to, part)| *to += part / scale);
    };
    if found.verification.optimality.fails() {
        blame(&gaps, gap_allowed * size);
    }
    if found.verification.dynamics.fails() {
        blame(&of_nodes, bound);
    }
    if found.verification.limits.fails()
        && let Some(piece) = of_limits
    {
        found.blame[piece] += 1.0;
    }
    found
}

/// Whether a quantity may jump along a motion; `None` for torques that may, which are cut to their limits.
fn jumps(quantity: Quantity, is_smooth: bool) -> Option<bool> {
    match quantity {
        Quantity::Position | Quantity::Rate | Quantity::Task => Some(false),
        Quantity::Jerk | Quantity::TorqueRate => Some(true),
        Quantity::Torque if !is_smooth => None,
        _ => Some(!is_smooth),
    }
}

/// What a limit is about, in words.
fn name_of(excess: &Excess, rows: &TaskRows, names: &[String]) -> String {
    let kind = match excess.quantity {
        Quantity::Position => "position",
        Quantity::Rate => "rate",
        Quantity::Acceleration => "acceleration",
        Quantity::Jerk => "jerk",
        Quantity::Torque => "torque",
        Quantity::TorqueRate => "torque rate",
        Quantity::Power => "power",
        Quantity::TorqueSpeed => "torque at this rate",
        Quantity::Task | Quantity::ToolAcceleration => {
            let mut rows = rows.along.bounds().iter().chain(rows.accelerations.bounds());
            return excess
                .index
                .and_then(|index| rows.nth(index))
                .map_or(String::new(), |row| row.name.clone());
        }
    };
    match excess.index {
        Some(i) => format!("{kind} of joint '{}'", names[i]),
        None => format!("{kind} of all joints"),
    }
}

/// What the multipliers of limits at a node make of the costates there; `None` without multipliers.
fn jump<D>(interior: &Interior<D>, k: usize) -> Option<Vec<f64>> {
    let Interior { spline, barrier, .. } = interior;
    let (n, at_node) = (spline.dof, AtNode::new(spline, k));
    let mut jump = None;
    for at in barrier.at_node(k).filter(|&at| barrier.is_on(at)) {
        let (side, value) = (barrier.side(at), at_node.of(barrier.side(at)));
        let i = value.unknown - spline.node() * k;
        // The unknown of a rate is v times the time of its phase, or v.
        let clock = if i < n { 1.0 } else { spline.clock_at(k) };
        let jumps: &mut Vec<f64> = jump.get_or_insert_with(|| vec![0.0; 2 * n]);
        jumps[i] -= clock * value.scale * side.sign * barrier.multiplier[at];
    }
    jump
}

/// Why the optimality of a motion cannot be verified.
fn why_not<D>(problem: &Problem, interior: &Interior<D>) -> Option<&'static str> {
    if interior.spline.mesh.shape.is_smooth() {
        return Some("continuous accelerations: costates of accelerations are not integrated");
    }
    if problem.penalty.is_some() {
        return Some("penalties: costates at nodes do not resolve their corners");
    }
    let walks = problem.loops.as_ref().is_some_and(|loops| loops.walk.is_some());
    walks.then_some("gaits: multipliers of feet are not integrated")
}

/// Inverse dynamics of robots with constraints, one point at a time.
struct ClosedDynamics {
    phases: Vec<ClosedPoints>,
    point: Points,
}

impl ClosedDynamics {
    fn new(loops: &Loops) -> Self {
        let phases = (0..loops.phases.len()).map(|phase| ClosedPoints::new(loops, phase)).collect();
        Self { phases, point: Points::default() }
    }
}

impl InverseDynamics for ClosedDynamics {
    fn torques(&mut self, phase: usize, z: &[f64], tau: &mut [f64]) -> Result<(), EvalError> {
        self.phases[phase].inverse_dynamics(z, tau)
    }

    fn linearise(
        &mut self,
        phase: usize,
        z: &[f64],
        tau: &mut [f64],
        tau_z: &mut [f64],
    ) -> Result<(), EvalError> {
        let n = tau.len();
        self.point.resize(n, [0, 0], std::iter::once(1));
        self.point.z.copy_from_slice(&z[..3 * n]);
        self.point.weights.fill(0.0);
        self.phases[phase].contract_some(&mut self.point, 0..1)?;
        tau.copy_from_slice(&self.point.tau);
        tau_z.copy_from_slice(&self.point.tau_z);
        Ok(())
    }
}

/// Whether a limit of positions or rates is active at an end of an interval: its multiplier, without unit, is
/// larger than its slack.
fn is_on_arc<D>(interior: &Interior<D>, k: usize) -> bool {
    let barrier = &interior.barrier;
    let is_active = |at: usize| {
        let unit = barrier.weight[at] * barrier.unit[at] * interior.figures.size;
        barrier.is_on(at) && barrier.multiplier[at] > barrier.slack[at] * barrier.unit[at] * unit
    };
    barrier.at_node(k).chain(barrier.at_node(k + 1)).any(is_active)
}

/// The multipliers of all limits of an iterate.
struct Sides<'a> {
    spline: &'a Spline,
    barrier: &'a Barrier,
    powers: &'a Powers,
    /// Per second, all sides of one point after the other.
    densities: Vec<f64>,
    /// For each interval whether a limit of positions or rates is active at an end of it.
    arcs: Vec<bool>,
    along: TaskFunctions,
    accelerations: ToolAccelerations,
    /// Weights of second derivatives, all zero; values and Jacobians of rows.
    weights: Vec<f64>,
    g: Vec<f64>,
    jacobian: Vec<f64>,
    hessian: Vec<f64>,
    /// What limits of single torques add, which nothing reads.
    own: Vec<f64>,
}

impl<'a> Sides<'a> {
    fn new<D>(interior: &'a Interior<D>, rows: &TaskRows) -> Self {
        let Interior { spline, barrier, model, .. } = interior;
        let n = spline.dof;
        let mut densities = Vec::with_capacity(barrier.sides().len() * spline.mesh.points());
        for p in 0..spline.mesh.points() {
            let place = spline.mesh.interval_of(p);
            for (i, at) in barrier.at_point(p).enumerate() {
                let of = |at: usize| if barrier.is_on(at) { barrier.multiplier[at] } else { 0.0 };
                let sum = if barrier.is_hull(i) { barrier.by_value(place, i, of) } else { of(at) };
                densities.push(sum / spline.weight(p));
            }
        }
        let (along, accelerations) = (rows.along.clone(), rows.accelerations.clone());
        let count = along.rows().max(accelerations.bounds().len());
        Self {
            spline,
            barrier,
            powers: &model.powers,
            densities,
            arcs: (0..spline.mesh.intervals()).map(|k| is_on_arc(interior, k)).collect(),
            along,
            accelerations,
            weights: vec![0.0; count],
            g: vec![0.0; count],
            jacobian: vec![0.0; 3 * n * count],
            hessian: vec![0.0; 9 * n * n],
            own: vec![0.0; n],
        }
    }

    /// The density of a side at the part x of an interval, between those of its points.
    fn density(&self, k: usize, parts: &[f64], i: usize) -> f64 {
        let (count, first) = (self.barrier.sides().len(), self.spline.mesh.first_point(k));
        parts.iter().enumerate().map(|(j, part)| part * self.densities[count * (first + j) + i]).sum()
    }
}

impl Multipliers for Sides<'_> {
    fn counts(&self, piece: usize) -> bool {
        !self.arcs[piece]
    }

    fn add(&mut self, k: usize, x: f64, z: &[f64], tau: &[f64], to: &mut Prices) -> Result<(), EvalError> {
        let (n, shape) = (tau.len(), self.spline.mesh.shape);
        let parts = shape.parts(x);
        let parts = &parts[..shape.places().len()];
        let sides: &[Side] = self.barrier.sides();
        let slack = |side: &Side, density: f64, value: f64| match side.is_equation {
            true => 0.0,
            false => density.max(0.0) * side.sign * (value - side.bound),
        };
        let mut has_rows = [false; 2];
        for (i, side) in sides.iter().enumerate() {
            let density = self.density(k, parts, i);
            if density == 0.0 {
                continue;
            }
            let price = -side.sign * density;
            match side.limited {
                Limited::Position | Limited::Rate | Limited::Acceleration => {
                    let at = side.index(n);
                    to.by_z[at] += price;
                    to.slack += slack(side, density, z[at]);
                }
                Limited::Power | Limited::TorqueSpeed => {
                    let (row, v) = (side.joint, &z[n..2 * n]);
                    // The torque of one joint is within its own range.
                    let is_own = self.powers.joint(row).is_some();
                    let by_torque = if is_own { &mut self.own } else { &mut to.by_torque };
                    self.powers.add_price(row, price, v, tau, [&mut to.by_z[n..2 * n], by_torque]);
                    if !is_own {
                        to.slack += slack(side, density, self.powers.value(row, v, tau));
                    }
                }
                Limited::Task => has_rows[0] = true,
                Limited::ToolAcceleration => has_rows[1] = true,
                Limited::Torque | Limited::Jerk | Limited::TorqueRate => {}
            }
        }
        if has_rows[0] {
            let (q, v) = (&z[..n], &z[n..2 * n]);
            let rows = self.along.rows();
            self.along.enter(Some(self.spline.mesh.phase(k)));
            self.along.contract(
                q,
                v,
                &self.weights[..rows],
                &mut self.g[..rows],
                &mut self.jacobian[..2 * n * rows],
                &mut self.hessian[..4 * n * n],
            )?;
            for (i, side) in sides.iter().enumerate().filter(|(_, side)| side.limited == Limited::Task) {
                let density = self.density(k, parts, i);
                let row = &self.jacobian[2 * n * side.joint..][..2 * n];
                to.by_z.iter_mut().zip(row).for_each(|(to, entry)| *to -= side.sign * density * entry);
                to.slack += slack(side, density, self.g[side.joint]);
            }
        }
        if has_rows[1] {
            let rows = self.accelerations.bounds().len();
            let (g, jacobian) = (&mut self.g[..rows], &mut self.jacobian[..3 * n * rows]);
            self.accelerations.contract(z, &self.weights[..rows], g, jacobian, &mut self.hessian)?;
            for (i, side) in sides.iter().enumerate() {
                if side.limited == Limited::ToolAcceleration {
                    let (density, row) = (self.density(k, parts, i), side.joint - self.powers.rows());
                    let entries = &self.jacobian[3 * n * row..][..3 * n];
                    to.by_z
                        .iter_mut()
                        .zip(entries)
                        .for_each(|(to, entry)| *to -= side.sign * density * entry);
                    to.slack += slack(side, density, self.g[row]);
                }
            }
        }
        Ok(())
    }
}
