//! A problem with a guess, ready to iterate.

use super::first::First;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::ends::Ends;
use crate::direct::limits::model::Model;
use crate::direct::limits::power::Powers;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::limits::tasks::Tasks;
use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::shape::Shape;
use crate::direct::points::phases::PhaseDynamics;
use crate::direct::points::robot_points::AnyPoints;
use crate::direct::points::running::Running;
use crate::options::SolverOptions;
use crate::problem::limits::JointLimits;
use crate::problem::narrow::Narrow;
use crate::problem::{FinalTime, Problem};
use crate::result::trajectory::Trajectory;
use crate::task::build::TaskRows;

/// Inverse dynamics of the robots of all phases.
pub(crate) type Dynamics = PhaseDynamics<AnyPoints>;

/// A problem with the guess of a start; on the mesh of a saved motion, if there is one, or on equal
/// intervals.
pub(crate) fn interior(
    problem: &Problem,
    rows: &TaskRows,
    options: &SolverOptions,
    number: usize,
    saved: Option<&Trajectory>,
) -> Interior<Dynamics> {
    let first = First::new(problem, rows, options, number, saved);
    let nodes = own_nodes(problem, options, &first).unwrap_or_else(|| even_nodes(problem, options));
    interior_on(problem, rows, options, &first, &nodes)
}

/// The same from this guess, with nodes at what the problem names and where the guess crosses something
/// narrow, unless it is on the mesh of a saved motion.
pub(crate) fn interior_of(
    problem: &Problem,
    rows: &TaskRows,
    options: &SolverOptions,
    first: &First<'_>,
) -> Interior<Dynamics> {
    if let Some(nodes) = own_nodes(problem, options, first) {
        return interior_on(problem, rows, options, first, &nodes);
    }
    let mut interior = interior_on(problem, rows, options, first, &even_nodes(problem, options));
    seed(options, &mut interior);
    interior
}

/// Adds nodes to a guess: at what its problem names, and where it crosses something narrow.
pub(super) fn seed<D>(options: &SolverOptions, interior: &mut Interior<D>) {
    let nodes = interior.seeded(most_knots(options, interior.spline.mesh.shape));
    if nodes.len() > interior.spline.mesh.nodes.len() {
        interior.spline = interior.spline.on_nodes(nodes);
    }
}

/// Most knots of references that are nodes.
pub(super) fn most_knots(options: &SolverOptions, shape: Shape) -> usize {
    options.max_nodes / shape.stride() / constants::KNOTS_OF_NODES
}

/// The nodes of the saved motion of a guess, if it can begin there.
fn own_nodes(problem: &Problem, options: &SolverOptions, first: &First<'_>) -> Option<Vec<f64>> {
    let (shape, phases) = (Shape::of(problem), problem.phases());
    // With continuous accelerations a fine mesh does not converge from multipliers that are not known.
    let fits = |nodes: &Vec<f64>| {
        !shape.is_smooth()
            && nodes[nodes.len() - 1] == phases as f64
            && shape.points_of(nodes.len() - 1) <= options.max_nodes
    };
    first.saved.and_then(Trajectory::mesh_nodes).filter(fits)
}

/// Equal intervals in each phase.
fn even_nodes(problem: &Problem, options: &SolverOptions) -> Vec<f64> {
    let (stride, phases) = (Shape::of(problem).stride(), problem.phases());
    let least = if phases > 1 { constants::INTERVALS_OF_PHASE } else { 1 };
    Mesh::even(phases, ((options.nodes - 1) / stride / phases).max(least))
}

/// The same on these nodes.
pub(crate) fn interior_on(
    problem: &Problem,
    rows: &TaskRows,
    options: &SolverOptions,
    first: &First<'_>,
    nodes: &[f64],
) -> Interior<Dynamics> {
    // A free time begins no shorter than its limits allow.
    let least = match problem.time {
        FinalTime::Free { guess } if first.saved.is_none() => {
            Some(problem.shortest_time()).filter(|least| guess < *least)
        }
        _ => None,
    };
    let spline = first.spline(nodes.to_vec(), least);
    let dynamics = AnyPoints::of_phases(problem, options);
    let powers = Powers::new(problem);
    let tasks = Tasks::new(rows, problem.coordinates(), powers.rows()).with_gait(problem.loops.as_deref());
    let model = Model { dynamics, tasks, powers };
    let (running, ends) = (Running::new(problem, rows), Ends::new(problem));
    let mut interior = Interior::new(spline, sides(problem), model, running, ends);
    (interior.crossed, interior.knots) = Narrow::of(problem).without_knots();
    // Torques without the forces of constraints, which a guess does not have, say nothing about times.
    let can_choose = matches!(problem.time, FinalTime::Free { .. })
        && problem.vias.iter().all(|via| via.time.is_none())
        && problem.loops.is_none();
    if first.saved.is_none() && can_choose {
        interior.choose_time(|time| first.spline(nodes.to_vec(), Some(time)));
    }
    interior
}

/// All limits of the joints of a problem.
fn sides(problem: &Problem) -> Vec<Side> {
    let limits = problem.joint_limits();
    let of = |limited: Limited, range: fn(&JointLimits) -> [f64; 2]| {
        let each = limits.iter().enumerate();
        each.flat_map(move |(i, limits)| {
            let [lower, upper] = range(limits);
            Side::pair(limited, i, lower, upper)
        })
    };
    let torques = limits.iter().map(|limits| limits.torque[1] - limits.torque[0]);
    let largest = torques.filter(|range| range.is_finite()).fold(0.0, f64::max);
    // What the other motors give; without limits of them, 1 N m.
    let unit = if largest > 0.0 { largest } else { 1.0 };
    let has_motor = |limits: &JointLimits| limits.torque[0] < limits.torque[1];
    let torque = of(Limited::Torque, |limits| limits.torque).filter(|side| has_motor(&limits[side.joint]));
    let without = (0..limits.len()).filter(|&j| !has_motor(&limits[j])).map(|j| Side::no_torque(j, unit));
    // Forces and impulses of a foot are between the edges of the friction cone.
    let walking = problem.loops.iter().filter_map(|loops| Some((loops, loops.walk.as_ref()?)));
    // In space they are rows.
    let walking = walking.filter(|(_, walk)| !walk.gait.is_in_space());
    let edges = walking.flat_map(|(loops, walk)| {
        let first = loops.robot.dof();
        // Those of soles are measured in what carries the weight.
        let sole = walk.gait.sole.is_some();
        let range = move |lift: &f64| if sole && *lift > 1.0 { *lift } else { 1.0 };
        let has_impulses = !walk.has_double_support();
        walk.lift.iter().enumerate().map(move |(k, lift)| (first + k, range(lift), has_impulses))
    });
    let cone = edges.flat_map(|(i, range, has_impulses)| {
        let positive = move |limited, range| {
            Side::pair(limited, i, 0.0, f64::INFINITY).map(move |side| Side { range, ..side })
        };
        let impulses = has_impulses.then(|| positive(Limited::Rate, 1.0));
        impulses.into_iter().flatten().chain(positive(Limited::Acceleration, range))
    });
    of(Limited::Position, |limits| limits.q)
        .chain(of(Limited::Rate, |limits| [-limits.v, limits.v]))
        .chain(of(Limited::Acceleration, |limits| [-limits.a, limits.a]))
        .chain(of(Limited::Jerk, |limits| [-limits.jerk, limits.jerk]))
        .chain(of(Limited::TorqueRate, |limits| [-limits.torque_rate, limits.torque_rate]))
        .chain(torque)
        .chain(without)
        .chain(cone)
        .collect()
}
