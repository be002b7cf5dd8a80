//! The figures of a solution as names and values.

use crate::numbers::{scientific, short};
use crate::units;
use costate::robot::{ConstraintKind, escape_hidden, printable};
use costate_control::{
    Certificate, Check, CheckOutcome, FinalTime, GaitReport, Method, Motion, Problem, Solution, Verification,
    Verify,
};

/// Whether the final time is free.
pub(crate) fn time_is_free(problem: &Problem) -> bool {
    matches!(problem.time, FinalTime::Free { .. })
}

/// What the bounds of a problem without a motion would have to be, with units.
pub(crate) struct Needed<'a> {
    pub joint: &'a str,
    pub factor: String,
    pub time: String,
    pub u: String,
    pub bound: String,
}

impl<'a> Needed<'a> {
    pub fn new(problem: &Problem, solution: &'a Solution) -> Option<Self> {
        let violation = solution.motion.bound_violation?;
        let joint = solution.robot.joints.get(violation.control)?;
        let kind = problem.robot.independent_joints().nth(violation.control)?.kind;
        let unit = units::of_joint(kind, units::EFFORT);
        Some(Self {
            joint,
            factor: short(violation.factor, 4),
            time: format!("{} s", short(violation.time, 4)),
            u: format!("{} {unit}", short(violation.u, 4)),
            bound: format!("{} {unit}", short(violation.bound, 4)),
        })
    }
}

/// Units of the kinds of limits.
pub(crate) fn limit_units(kind: &str) -> units::Units {
    match kind {
        "position" => units::POSITION,
        "rate" => units::RATE,
        "acceleration" => units::ACCELERATION,
        "power" => units::POWER,
        "jerk" => units::JERK,
        "torque_rate" => units::EFFORT_RATE,
        "ground_force" => units::FORCE,
        "landing_impulse" => units::IMPULSE,
        _ => units::EFFORT,
    }
}

/// Name and value of each figure of a solution.
pub fn figures(problem: &Problem, solution: &Solution) -> Vec<(&'static str, String)> {
    let motion = &solution.motion;
    let iterations = ("Newton iterations", solution.newton_iterations.to_string());
    if let Some(Needed { joint, factor, time, u, bound }) = Needed::new(problem, solution) {
        return vec![
            ("bounds needed", format!("{factor} times as wide")),
            ("at joint", joint.to_owned()),
            ("at time", time),
            ("control there", u),
            ("its bound", bound),
            iterations,
        ];
    }
    if solution.trajectory.t.is_empty() {
        return vec![iterations];
    }
    let mut figures = vec![("cost", short(motion.cost, 12))];
    if problem.penalty.is_some() {
        figures.push(("cost of penalties", short(motion.penalty_cost, 6)));
    }
    if motion.smoothing > 0.0 {
        let bound = match motion.smoothing_bound {
            bound if bound > 0.0 => format!(", which costs at most {} relative", scientific(bound)),
            _ => String::new(),
        };
        figures.push(("smoothing left", format!("{}{bound}", scientific(motion.smoothing))));
    }
    let [position, rate] = [units::POSITION, units::RATE].map(|unit| units::of_robot(&problem.robot, unit));
    figures.push(("final time", format!("{} s", short(motion.final_time, 10))));
    if let [start] = &solution.starts[..]
        && start.looks > 1
    {
        figures.push(("guess", format!("{}, the best of {}", start.guess, start.looks)));
    }
    let vias: Vec<String> = solution.trajectory.via_times.iter().map(|&time| short(time, 6)).collect();
    if !vias.is_empty() && solution.gait.is_none() {
        figures.push(("vias at", format!("{} s", vias.join(", "))));
    }
    let polished = solution.polish.as_ref();
    if let Some(report) = polished {
        let cost = match (report.outcome.is_polished(), report.direct_total, report.polished_total) {
            (true, Some(cost), _) => format!("; the direct method's cost {}", short(cost, 12)),
            (false, _, Some(cost)) => format!("; its cost {}", short(cost, 12)),
            _ => String::new(),
        };
        figures.push(("shown", format!("{}{cost}", report.reason())));
    }
    let extremal = polished.is_some_and(|report| report.outcome.is_polished());
    if solution.options.method == Method::Direct && !extremal {
        figures.extend(verification(motion));
        figures.extend(direct_figures(problem, solution));
        let mesh = format!("{} intervals, {} nodes", solution.intervals(), solution.mesh_nodes());
        figures.extend([iterations, ("mesh", mesh)]);
        return figures;
    }
    figures.extend([
        ("H*", format!("{} cost/s", short(motion.hamiltonian, 10))),
        ("drift of H*", format!("{} relative", scientific(motion.hamiltonian_drift))),
        ("end defect", defect(solution.end_defect, motion.verification, &format!("{position}, {rate}"))),
        ("shooting defect", defect(motion.shooting_defect, motion.verification, "relative")),
        iterations,
        ("mesh nodes", solution.nodes().to_string()),
        ("conjugate time", conjugate(problem, motion)),
    ]);
    figures.extend(verification(motion));
    if extremal {
        figures.extend(limit_figures(problem, solution));
    }
    if !motion.switches.is_empty() {
        figures.push(("switches", motion.switches.len().to_string()));
    }
    figures
}

/// How the motion was verified, unless it was integrated again: defects say that.
fn verification(motion: &Motion) -> Option<(&'static str, String)> {
    let how = match motion.verification {
        Verify::Full => return None,
        Verify::Factors if motion.conditioning.is_finite() => {
            format!("by the factors, conditioning {}", scientific(motion.conditioning))
        }
        Verify::Factors => "by the estimated errors".into(),
        _ => "not done".into(),
    };
    Some(("verification", how))
}

/// Figures of the direct method: its estimate, the end, the limits.
fn direct_figures(problem: &Problem, solution: &Solution) -> Vec<(&'static str, String)> {
    let motion = &solution.motion;
    let unit = |unit| units::of_robot(&problem.robot, unit);
    let ends = format!("{}, {}", unit(units::POSITION), unit(units::RATE));
    let mut figures = vec![("end defect", defect(solution.end_defect, motion.verification, &ends))];
    if motion.shooting_defect.is_finite() {
        let parts =
            format!("{} relative, sum over 20 parts of the motion", scientific(motion.shooting_defect));
        figures.push(("shooting defect", parts));
    }
    // A saved motion does not have it.
    if let Some(&error) = motion.errors.first() {
        figures.push(("error of the cost", format!("{} relative, estimated", scientific(error))));
    }
    // Of the direct method on joints; smoothed problems are not compared.
    let is_compared =
        !motion.newton_decrement.is_nan() && !motion.duality_gap.is_nan() && motion.smoothing == 0.0;
    if motion.finer_mesh.is_finite() {
        let change = scientific(motion.finer_mesh);
        figures
            .push(("finer mesh", format!("changes the cost by {change}, relative, with halved intervals")));
    } else if is_compared && motion.verification == Verify::Full && motion.status.is_converged() {
        figures.push(("finer mesh", "not compared: it takes too many nodes or steps".into()));
    }
    figures.extend(solution.verified.iter().flat_map(|found| verified(found, motion.certificate)));
    if motion.stationarity.is_finite() {
        let stationarity = scientific(motion.stationarity);
        // The method in states has one figure for all conditions of first order.
        let residual = if motion.duality_gap.is_nan() {
            format!("{stationarity} relative, stationarity, complementarity and defects together")
        } else {
            format!(
                "stationarity {stationarity}, complementarity {}, relative",
                scientific(motion.duality_gap)
            )
        };
        figures.push(("residual", residual));
    }
    if !solution.constraints.is_empty() {
        let drift = solution.constraints.iter().map(|one| one.drift).fold(0.0, f64::max);
        let name = if solution.gait.is_some() { "drift of the feet" } else { "drift of the loops" };
        figures.push((name, format!("{} m, rad", scientific(drift))));
    }
    figures.extend(redundant_rows(problem, solution).map(|rows| ("redundant rows", rows)));
    figures.extend(solution.gait.iter().flat_map(|gait| gait_figures(gait, motion.final_time)));
    figures.extend(limit_figures(problem, solution));
    if motion.certificate == Certificate::LocalMinimumOnMesh {
        figures.push(("local minimum", ON_MESH.into()));
    }
    if motion.certificate == Certificate::SaddleOnMesh {
        figures.push(("local minimum", format!("no: a saddle {ON_MESH}, motions nearby cost less")));
    }
    figures
}

/// What the verification found that does not use the points of the solver: the cost, and what the maximum
/// principle says; of dynamics and limits only what fails.
fn verified(verification: &Verification, certificate: Certificate) -> Vec<(&'static str, String)> {
    let mut figures = Vec::new();
    let relative = |check: &Check| check.value.map_or_else(|| "unknown".into(), scientific);
    if let Some(cost) = verification.integrated_cost {
        let differs = relative(&verification.cost);
        figures.push((
            "verified cost",
            format!("{}, by adaptive quadrature, within {differs}", short(cost, 12)),
        ));
    }
    let optimality = &verification.optimality;
    let text = match (optimality.outcome, &optimality.subject) {
        (CheckOutcome::NotVerified, Some(reason)) => format!("not verified: {}", escape_hidden(reason)),
        (CheckOutcome::NotVerified, None) => "not verified".into(),
        _ if certificate == Certificate::SaddleOnMesh => {
            format!("costs at least {} more than a motion nearby, relative", relative(optimality))
        }
        _ => format!("costs at most {} more than the optimum nearby, relative", relative(optimality)),
    };
    figures.push(("optimality", text));
    let overshoot = &verification.overshoot;
    if overshoot.fails() {
        let of =
            overshoot.subject.as_deref().map_or_else(String::new, |of| format!(", {}", escape_hidden(of)));
        let text = format!("{} of the range of a limit beside a jump{of}", relative(overshoot));
        figures.push(("overshoot", text));
    }
    figures.extend(verification.reason().map(|reason| ("not verified", escape_hidden(&reason).to_string())));
    figures
}

/// The rows of constraints that depend on others, by name.
fn redundant_rows(problem: &Problem, solution: &Solution) -> Option<String> {
    let constraints = problem.robot.constraints();
    let (mut names, mut count) = (Vec::new(), 0);
    for (told, constraint) in solution.constraints.iter().zip(constraints) {
        let row = |row: &usize| match &constraint.kind {
            ConstraintKind::Frames { rows, .. } => rows.get(*row).map(|row| row.name()),
            _ => None,
        };
        let rows: Vec<&str> = told.redundant.iter().filter_map(row).collect();
        let name = printable(&constraint.name);
        match told.redundant.len() {
            0 => {}
            _ if rows.is_empty() => names.push(format!("'{name}'")),
            _ => names.push(format!("'{name}' {}", rows.join(" "))),
        }
        count += told.redundant.len();
    }
    let all: usize = constraints.iter().map(|one| one.kind.rows()).sum();
    (count > 0).then(|| format!("{count} of {all}, left out, their forces zero: {}", names.join(", ")))
}

/// Figures of a step of a gait.
fn gait_figures(gait: &GaitReport, duration: f64) -> Vec<(&'static str, String)> {
    let double = gait.double_support.map(|time| {
        let part = 100.0 * time / duration;
        ("double support", format!("{} s, {part:.2} % of the step", short(time, 6)))
    });
    let [x, z] = [0, 2].map(|axis| gait.impulses.iter().map(|impulse| impulse[axis]).sum::<f64>());
    let speed = [("speed", format!("{:.4} m/s", gait.speed))];
    let others = [
        ("cost of transport", format!("{:.4}", gait.cost_of_transport)),
        ("work", format!("{:.3} J, {:.3} J of braking", gait.work, gait.braking)),
        ("landing", format!("{z:.3} N s up, {x:.3} N s ahead, {:.3} J lost", gait.loss)),
        ("gait", format!("closes to {} rad, m, rad/s, m/s", scientific(gait.miss))),
    ];
    speed.into_iter().chain(double).chain(others).collect()
}

/// What the second derivatives of the direct method show.
const ON_MESH: &str = "among the motions of its mesh";

/// Distances and rates of feet, forces and impulses on them.
pub(crate) const FEET: &str = "worst violation of clearances and foot forces";

/// Figures of the hard limits.
fn limit_figures(problem: &Problem, solution: &Solution) -> Vec<(&'static str, String)> {
    let unit = |unit| units::of_robot(&problem.robot, unit);
    let (mut figures, mut active) = (Vec::new(), 0);
    for (kind, usage) in solution.limits.kinds() {
        let Some(usage) = usage else { continue };
        let name = match kind {
            "position" => "beyond position limits",
            "rate" => "beyond rate limits",
            "acceleration" => "beyond acceleration limits",
            "jerk" => "beyond jerk limits",
            "torque_rate" => "beyond torque-rate limits",
            "power" => "beyond power limits",
            "torque_speed" => "beyond torque-speed limits",
            "ground_force" => "beyond ground-force limits",
            "landing_impulse" => "beyond landing-impulse limits",
            "task" if solution.gait.is_some() => FEET,
            "task" => "beyond tools and clearances",
            _ => "beyond torque limits",
        };
        let unit = match kind {
            // Of the one that is violated most; the documents list them.
            "task" if solution.gait.is_some() => String::new(),
            "task" => " m, rad or m/s".to_owned(),
            _ => format!(" {}", unit(limit_units(kind))),
        };
        let (at_points, between) = (scientific(usage.at_points), scientific(usage.between));
        let cut = if kind == "torque" && usage.between > 0.0 { ", cut off in what is written" } else { "" };
        figures.push((name, format!("{at_points}{unit}, {between} between points{cut}")));
        let mut sides: Vec<_> = usage.active.iter().map(|span| (&span.name, &span.side)).collect();
        sides.sort();
        sides.dedup();
        active += sides.len();
    }
    if !solution.limits.is_empty() {
        figures.push(("active limits", active.to_string()));
    }
    figures
}

/// A defect with its unit; it is not finite if nothing was integrated or if the integration stopped.
fn defect(value: f64, done: Verify, unit: &str) -> String {
    match done {
        _ if value.is_finite() => format!("{} {unit}", scientific(value)),
        Verify::Full => "the integration stopped".into(),
        _ => "not checked".into(),
    }
}

/// Jacobi fields compare motions that take the same time.
fn conjugate(problem: &Problem, motion: &Motion) -> String {
    match (motion.conjugate_time, motion.certificate) {
        (Some(time), _) if motion.conjugate_multiplicity > 1 => {
            format!("{} s, {} fields: not a minimum", short(time, 8), motion.conjugate_multiplicity)
        }
        (Some(time), _) => format!("{} s: not a minimum", short(time, 8)),
        (None, Certificate::LocalMinimum) if time_is_free(problem) => {
            "none: a local minimum in this time".into()
        }
        (None, Certificate::LocalMinimum) => "none: a local minimum".into(),
        (None, Certificate::LocalMinimumOnMesh) => {
            format!("not checked; before the polish a local minimum {ON_MESH}")
        }
        (None, Certificate::SaddleOnMesh) => {
            format!("not checked; before the polish a saddle {ON_MESH}")
        }
        _ => "not checked".into(),
    }
}
