//! Hands a motion of the direct method to the verification that does not know it.

use super::interval_part::IntervalPart;
use super::verify::Again;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::at_node::AtNode;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::power::Powers;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::limits::tasks::Tasks;
use crate::direct::motion::shape::{MOST_POINTS, PLACES, POINTS};
use crate::direct::motion::spline::Spline;
use crate::direct::points::closed_points::ClosedPoints;
use crate::direct::points::values::{PointDynamics, Points};
use crate::extremal::penalty::Penalties;
use crate::numerics::dormand_prince::Stopped;
use crate::numerics::lagrange;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::problem::limits::JointLimits;
use crate::problem::loop_rows::Loops;
use crate::result::verification::{Check, Verification};
use crate::task::build::TaskRows;
use crate::verify::adjoint::{Conditions, Multipliers, Prices};
use crate::verify::cost::cost;
use crate::verify::dynamics::{InverseDynamics, Trees};
use crate::verify::jerk_optimality::{has_controls, has_jerks};
use crate::verify::limits::{Excess, Quantity, excesses};
use crate::verify::motion::defects;
use crate::verify::optimality;
use crate::verify::running::Running;
use crate::verify::splits::Splits;
use costate::EvalError;

/// Seed of random times: the same motion is verified in the same way.
const SEED: u64 = 43;

/// What the verification found, and what it wants to see on a finer mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Independent {
    pub verification: Verification,
    /// Whether it was not stopped.
    pub is_complete: bool,
    /// What each interval adds to the values that fail, relative to their tolerances; empty without a
    /// verification.
    pub blame: Vec<f64>,
    /// Places in s at which something narrow happens.
    pub narrow: Vec<f64>,
}

/// Verifies a motion whose points are contracted. `size` is that of the cost, `again` its integration by an
/// explicit method, where that was done; `costs` are those of the intervals, as the solver has them. Unless
/// the cost `is_compared` with that on a finer mesh, the gap alone says what the mesh costs: that of torques
/// must be within the tolerance then; that of jerks, a loose bound, need not. It ends early where the search
/// is to stop, as `stops` says.
pub(crate) fn verify<D: PointDynamics>(
    (problem, rows): (&Problem, &TaskRows),
    options: &SolverOptions,
    interior: &mut Interior<D>,
    costs: &[f64],
    (again, is_compared): (Option<&Again>, bool),
    stops: &mut dyn FnMut() -> bool,
) -> Independent {
    let mut found = Independent { is_complete: true, ..Independent::default() };
    let gap_allowed = match (is_compared, interior.spline.mesh.shape.is_smooth()) {
        (_, true) => (constants::JERK_GAP * options.tolerance).max(constants::LEAST_JERK_GAP),
        (true, false) => constants::GAP * options.tolerance,
        (false, false) => options.tolerance,
    };
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
    let is_complete = &mut found.is_complete;
    let mut unknown = |stopped: &Stopped, allowed: f64| match stopped {
        Stopped::Evaluation(error) => Check::of(f64::INFINITY, allowed).at(None, Some(error.to_string())),
        Stopped::TooManySteps => Check::of(f64::INFINITY, allowed),
        Stopped::Interrupted => {
            *is_complete = false;
            Check::skipped("the search was stopped")
        }
    };

    let mut of_cost = Vec::new();
    match cost(&path, &splits, &mut *dynamics, &mut running, [tolerance, size], stops) {
        Ok([own, penalty]) => {
            let solver_cost: f64 = costs.iter().sum();
            let error = (own.error + penalty.error) / size;
            verification.integrated_cost = Some(own.value);
            verification.quadrature_error = Some(error);
            let difference = (own.value + penalty.value - solver_cost).abs() / size + error;
            verification.cost = Check::of(difference, tolerance);
            of_cost = costs.iter().zip(&own.parts).map(|(cost, own)| own - cost).collect();
            of_cost.iter_mut().zip(&penalty.parts).for_each(|(to, penalty)| *to += penalty);
            of_cost.iter_mut().for_each(|difference: &mut f64| *difference = difference.abs());
        }
        Err(stopped) => verification.cost = unknown(&stopped, tolerance),
    }

    let sizes = path.sizes(constants::LEAST_SCALE, constants::REST, joints);
    let bound = constants::VERIFIED * tolerance.sqrt();
    let is_driven = problem.loops.is_none() && limits[..joints].iter().all(|l| l.torque[0] < l.torque[1]);
    let mut of_nodes = Vec::new();
    if let (Some(again), true) = (again, is_driven) {
        verification.dynamics = Check::of(again.miss, bound);
    }
    if !verification.dynamics.passes() {
        match defects((&path, &splits), &mut *dynamics, &limits, &sizes, joints, bound, stops) {
            Ok(defects) => {
                let time = defects.worst.map(|(k, _)| path.pieces[k].start + path.pieces[k].length);
                let subject = defects.worst.map(|(_, i)| names[i].clone());
                verification.dynamics = Check::of(defects.sum(), bound).at(time, subject);
                of_nodes = defects.pieces;
            }
            // That it fails is known already.
            Err(Stopped::Evaluation(_) | Stopped::TooManySteps) if verification.dynamics.fails() => {}
            Err(stopped) => verification.dynamics = unknown(&stopped, bound),
        }
    }

    let excesses = excesses(problem, (&path, &splits), &mut *dynamics, rows, joints, SEED, stops);
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
        Err(stopped) => verification.limits = unknown(stopped, 2.0 * constants::VIOLATION_BETWEEN),
    }

    let mut gaps = Vec::new();
    match why_not(interior.spline.mesh.shape.is_smooth(), &limits, &running) {
        Some(reason) => verification.optimality = Check::skipped(reason),
        None => {
            let costates = costates(interior);
            // A cost of torques that was added belongs to the motion.
            let mut running = running.with_effort(interior.running.effort.clone());
            let mut sides = {
                let penalties = Penalties::new(problem.coordinates(), problem.penalty.as_ref());
                Sides::new(interior, &penalties, has_jerks(&limits, &running))
            };
            let conditions = Conditions {
                path: &path,
                splits: &splits,
                dynamics: &mut *dynamics,
                running: &mut running,
                multipliers: &mut sides,
                limits: &limits,
                stops,
            };
            match optimality::check(conditions, &costates, tolerance, SEED) {
                Ok(found) if found.counted == 0.0 => {
                    verification.optimality = Check::skipped("all of the motion is at limits of its state");
                }
                Err(Stopped::Evaluation(error)) => {
                    verification.optimality = Check::skipped(error.to_string())
                }
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
                Err(stopped) => verification.optimality = unknown(&stopped, gap_allowed),
            }
        }
    }

    found.blame = vec![0.0; path.pieces.len()];
    let mut blame = |parts: &[f64], scale: f64| {
        found.blame.iter_mut().zip(parts).for_each(|(to, part)| *to += part / scale);
    };
    if found.verification.cost.fails() {
        blame(&of_cost, tolerance * size);
    }
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

/// The costates at both ends of each interval: minus the derivatives of the Lagrange function of what remains
/// by the state there.
fn costates<D: PointDynamics>(interior: &mut Interior<D>) -> optimality::Costates {
    let spline = &interior.spline.clone();
    let mut part = IntervalPart::new(spline, interior.rows());
    let mut found = optimality::Costates::default();
    for k in 0..spline.mesh.intervals() {
        part.take(interior, k);
        found.left.push(part.by_node(spline, k, -1.0));
        found.right.push(part.by_node(spline, k + 1, 1.0));
        found.jumps.push(jump(interior, k));
    }
    found
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
fn why_not(is_smooth: bool, limits: &[JointLimits], running: &Running) -> Option<&'static str> {
    (is_smooth && !has_controls(limits, running))
        .then_some("continuous accelerations: some jerks are neither limited nor cost anything")
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

    /// With the weights of the point.
    fn contract_point(
        &mut self,
        phase: usize,
        z: &[f64],
        [tau, tau_z]: [&mut [f64]; 2],
    ) -> Result<(), EvalError> {
        let n = tau.len();
        self.point.resize(n, [0, 0], std::iter::once(1));
        self.point.z.copy_from_slice(&z[..3 * n]);
        self.phases[phase].contract_some(&mut self.point, 0..1)?;
        tau.copy_from_slice(&self.point.tau);
        tau_z.copy_from_slice(&self.point.tau_z);
        Ok(())
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
        self.point.weights.fill(0.0);
        self.contract_point(phase, z, [tau, tau_z])
    }

    fn contract(
        &mut self,
        phase: usize,
        z: &[f64],
        weights: &[f64],
        [tau, tau_z, hessian]: [&mut [f64]; 3],
    ) -> Result<(), EvalError> {
        self.point.weights.clear();
        self.point.weights.extend_from_slice(weights);
        self.contract_point(phase, z, [tau, tau_z])?;
        hessian.copy_from_slice(&self.point.hessian);
        Ok(())
    }
}

/// Whether a limit of positions or rates is active at an end of an interval: its multiplier, without unit, is
/// larger than its slack. With continuous accelerations, any limit at a point of the interval but those of
/// the controls. Or whether a penalty is above zero there, which is the multiplier of what it stands for.
fn is_on_arc<D>(interior: &Interior<D>, penalties: &Penalties, has_jerks: bool, k: usize) -> bool {
    let (barrier, mesh, n) = (&interior.barrier, &interior.spline.mesh, interior.spline.dof);
    let is_active = |at: usize| barrier.is_limit(at) && interior.is_active(at);
    let points = mesh.first_point(k)..mesh.first_point(k) + mesh.shape.places().len();
    let rates = if mesh.shape.is_smooth() { POINTS * k..POINTS * (k + 1) } else { 0..0 };
    let is_torque_rate = |at: usize| barrier.side(at).limited == Limited::TorqueRate;
    let is_penalised = |p: usize| {
        let (q, v) = interior.points.z(p)[..2 * n].split_at(n);
        (0..n).any(|i| penalties.position(i, q[i]).first != 0.0 || penalties.rate(i, v[i]).first != 0.0)
    };
    barrier.at_node(k).chain(barrier.at_node(k + 1)).any(is_active)
        || (mesh.shape.is_smooth() && points.clone().flat_map(|p| barrier.at_point(p)).any(is_active))
        || (has_jerks
            && rates.flat_map(|p| barrier.at_gauss_point(p)).any(|at| is_active(at) && is_torque_rate(at)))
        || (penalties.any() && points.clone().any(is_penalised))
}

/// The multipliers of all limits of an iterate.
struct Sides<'a> {
    spline: &'a Spline,
    barrier: &'a Barrier,
    powers: &'a Powers,
    /// Per second, all sides of one point after the other.
    densities: Vec<f64>,
    /// Those of jerks and rates of torques at Gauss's points.
    rate_densities: Vec<f64>,
    /// With continuous accelerations the parts of an interval between those that a point stands for: as wide
    /// as its weight. Multipliers are constant there, so that what they add up to is that of the points.
    breaks: Vec<f64>,
    /// For each interval whether it [is on an arc](is_on_arc), where the gap does not count.
    arcs: Vec<bool>,
    tasks: Tasks,
    /// The rows of tasks at one place.
    point: Points,
    /// What limits of single torques add, which nothing reads.
    own: Vec<f64>,
}

impl<'a> Sides<'a> {
    fn new<D>(interior: &'a Interior<D>, penalties: &Penalties, has_jerks: bool) -> Self {
        let Interior { spline, barrier, model, .. } = interior;
        let n = spline.dof;
        let sides = barrier.sides().len();
        let of = |at: usize| if barrier.is_on(at) { barrier.multiplier[at] } else { 0.0 };
        let mut densities = Vec::with_capacity(sides * spline.mesh.points());
        for p in 0..spline.mesh.points() {
            let place = spline.mesh.interval_of(p);
            for (i, at) in barrier.at_point(p).enumerate() {
                let sum = if barrier.is_hull(i) { barrier.by_value(place, i, of) } else { of(at) };
                densities.push(sum / spline.weight(p));
            }
        }
        let mut rate_densities = Vec::new();
        for p in 0..spline.mesh.gauss_points() {
            let place @ (k, _) = (p / POINTS, p % POINTS);
            let weight = spline.mesh.gauss_point(p).1 * spline.clock(k);
            for (number, at) in (sides..).zip(barrier.at_gauss_point(p)) {
                let sum = if barrier.is_hull(number) { barrier.by_value(place, number, of) } else { of(at) };
                rate_densities.push(sum / weight);
            }
        }
        let mut breaks = Vec::new();
        if spline.mesh.shape.is_smooth() {
            let mut sum = 0.0;
            for weight in spline.mesh.shape.weights() {
                sum += weight;
                breaks.push(sum);
            }
            breaks.pop();
        }
        Self {
            spline,
            barrier,
            powers: &model.powers,
            densities,
            rate_densities,
            breaks,
            arcs: (0..spline.mesh.intervals())
                .map(|k| is_on_arc(interior, penalties, has_jerks, k))
                .collect(),
            tasks: model.tasks.clone(),
            point: Points::default(),
            own: vec![0.0; n],
        }
    }

    /// Parts of the values at the points of an interval at `x`: in the quadratic through them, or one of the
    /// point whose part of the interval it is.
    fn parts(&self, x: f64) -> [f64; MOST_POINTS] {
        let shape = self.spline.mesh.shape;
        if !shape.is_smooth() {
            return shape.parts(x);
        }
        let mut parts = [0.0; MOST_POINTS];
        parts[self.breaks.partition_point(|&place| place < x)] = 1.0;
        parts
    }

    /// The density of a side at the part x of an interval, between those of its points. That of a limit of
    /// the control is not negative, as what is linear or quadratic between the points may be beside a jump:
    /// with such a price any jump would be the best one. Limits of the state are integrated: what their
    /// densities add up to is that of the points.
    fn density(&self, k: usize, parts: &[f64], i: usize) -> f64 {
        let (sides, shape) = (self.barrier.sides(), self.spline.mesh.shape);
        let first = self.spline.mesh.first_point(k);
        let of = |j: usize| self.densities[sides.len() * (first + j) + i];
        let density: f64 = parts.iter().enumerate().map(|(j, part)| part * of(j)).sum();
        let is_price = !sides[i].is_equation && sides[i].limited.jumps(shape);
        if is_price { density.max(0.0) } else { density }
    }
}

impl Multipliers for Sides<'_> {
    fn counts(&self, piece: usize) -> bool {
        !self.arcs[piece]
    }

    fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    fn add_rates(&mut self, k: usize, x: f64, rates: &[f64], prices: &mut [f64]) -> f64 {
        let sides = self.barrier.rate_sides();
        let (parts, mut slack) = (lagrange::values(&PLACES, x), 0.0);
        for (i, side) in sides.iter().enumerate().filter(|(_, side)| side.limited == Limited::TorqueRate) {
            let at = |j: usize| self.rate_densities[sides.len() * (POINTS * k + j) + i];
            // As the other limits that may jump.
            let density: f64 = parts.iter().enumerate().map(|(j, part)| part * at(j)).sum();
            let density = density.max(0.0);
            prices[side.joint] -= side.sign * density;
            slack += density * side.sign * (rates[side.joint] - side.bound);
        }
        slack
    }

    fn add(&mut self, k: usize, x: f64, z: &[f64], tau: &[f64], to: &mut Prices) -> Result<(), EvalError> {
        let (n, shape) = (tau.len(), self.spline.mesh.shape);
        let parts = self.parts(x);
        let parts = &parts[..shape.places().len()];
        let sides: &[Side] = self.barrier.sides();
        let slack = |side: &Side, density: f64, value: f64| match side.is_equation {
            true => 0.0,
            false => density.max(0.0) * side.sign * (value - side.bound),
        };
        let mut has_rows = false;
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
                    let is_own = !shape.is_smooth() && self.powers.joint(row).is_some();
                    let by_torque = if is_own { &mut self.own } else { &mut to.by_torque };
                    self.powers.add_price(row, price, v, tau, [&mut to.by_z[n..2 * n], by_torque]);
                    if !is_own {
                        to.slack += slack(side, density, self.powers.value(row, v, tau));
                    }
                }
                Limited::Task | Limited::ToolAcceleration => has_rows = true,
                // With continuous accelerations torques are functions of the state.
                Limited::Torque if shape.is_smooth() => {
                    to.by_torque[side.joint] += price;
                    to.slack += slack(side, density, tau[side.joint]);
                }
                Limited::Torque | Limited::Jerk | Limited::TorqueRate => {}
            }
        }
        if has_rows {
            let mesh = &self.spline.mesh;
            let own = mesh.phase(k);
            let ends = (0..mesh.phases()).map(|phase| usize::from(phase >= own));
            self.point.resize(n, self.tasks.rows(), ends);
            self.point.z.copy_from_slice(z);
            self.tasks.contract_along(&mut self.point)?;
            for (i, side) in sides.iter().enumerate().filter(|(_, side)| side.limited.is_task()) {
                let (value, row) = match side.limited {
                    Limited::Task => {
                        (self.point.g[side.joint], &self.point.g_x[2 * n * side.joint..][..2 * n])
                    }
                    _ => (self.point.h[side.joint], &self.point.h_z[3 * n * side.joint..][..3 * n]),
                };
                let density = self.density(k, parts, i);
                to.by_z.iter_mut().zip(row).for_each(|(to, entry)| *to -= side.sign * density * entry);
                to.slack += slack(side, density, value);
            }
        }
        Ok(())
    }
}
