//! Guesses of joints with friction: they move within a part of the time, and rest before or after.
//!
//! Dry friction costs an effort as long as a joint moves, and nothing while it rests. So a joint with more
//! time than its way needs rests, moves and rests again. On the cubic over the whole time friction is all but
//! constant, and Newton's method sees nothing of that.
//!
//! From rest to rest over the way d within t, a joint with the inertia M, the dry friction c and the viscous
//! one b costs, along a cubic,
//!
//! $$ r \left( \tfrac12 c^2 t + c b |d| + \tfrac35 \frac{b^2 d^2}{t} + 6 \frac{M^2 d^2}{t^3} \right), $$
//!
//! and t is where that is least. The guesses move all joints as early, as late, or as much in the middle of a
//! phase as they can. Each is evaluated on a mesh with nodes at its transitions, and replaces the cubic if it
//! costs less.

use super::prepare::seed;
use crate::constants::dry_friction as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::PointDynamics;
use crate::options::SolverOptions;
use crate::problem::Problem;
use costate::EvalError;
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;

/// The way of a joint in a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way {
    from: f64,
    to: f64,
    /// The time that it takes (s), and that of the phase.
    takes: f64,
    of: f64,
}

/// Replaces a guess by one of joints that rest for a part of the time, where that costs less.
///
/// # Errors
/// Positions at which the dynamics cannot be evaluated.
pub(super) fn move_within<D: PointDynamics>(
    problem: &Problem,
    options: &SolverOptions,
    interior: &mut Interior<D>,
) -> Result<(), EvalError> {
    let rubs = problem.robot.joints().iter().any(|joint| joint.friction.coulomb > 0.0);
    let costs = interior.running.costs_torques();
    if !rubs || !costs || problem.loops.is_some() || problem.periodic.is_some() {
        return Ok(());
    }
    let ways = ways(problem, interior)?;
    let waits = |way: &Way| way.from != way.to && way.takes < constants::SHORTER * way.of;
    if !ways.iter().flatten().any(waits) {
        return Ok(());
    }
    let own = interior.spline.clone();
    let Some(figures) = interior.figures_of(&own) else { return Ok(()) };
    let (mut best, [exceeded, mut least]) = (own.clone(), figures);
    for share in constants::SHARES {
        interior.spline = moved(&own, &ways, share);
        seed(options, interior);
        let fits = own.mesh.shape.points_of(interior.spline.mesh.intervals()) <= options.max_nodes;
        let spline = interior.spline.clone();
        let Some([most, cost]) = interior.figures_of(&spline).filter(|_| fits) else { continue };
        if most <= exceeded.max(constants::ROOM) && cost < constants::CHEAPER * least {
            (best, least) = (spline, cost);
        }
    }
    interior.spline = best;
    Ok(())
}

/// The ways of all joints in all phases; those that do not rest at both ends, or whose effort costs nothing,
/// take all of the time.
fn ways<D: PointDynamics>(problem: &Problem, interior: &Interior<D>) -> Result<Vec<Vec<Way>>, EvalError> {
    let (spline, n) = (&interior.spline, interior.spline.dof);
    let (limits, robots) = (problem.joint_limits(), problem.robots());
    let mut all = Vec::new();
    for (phase, &of) in spline.times.iter().enumerate() {
        let ends = [phase, phase + 1].map(|end| &spline.unknowns[spline.end_unknowns(end)]);
        let middle: Vec<f64> = (0..n).map(|i| 0.5 * (ends[0][i] + ends[1][i])).collect();
        let robot = robots.get(phase).unwrap_or(&problem.robot);
        let zeros = vec![0.0; n];
        let mut model = Lagrangian::<f64>::new(robot);
        let torque = model.linearise_inverse_dynamics(&middle, &zeros, &zeros)?;
        let friction = friction(robot, n);
        let way = |i: usize| {
            let (from, to) = (ends[0][i], ends[1][i]);
            let rests = ends.iter().all(|state| state[n + i] == 0.0);
            let whole = Way { from, to, takes: of, of };
            if !rests || interior.running.effort[i] == 0.0 || friction[i][0] == 0.0 {
                return whole;
            }
            // The peak of the rate of a cubic is 3/2 of its mean.
            let shortest = 1.5 * (to - from).abs() / (constants::OF_RATES * limits[i].v);
            let takes = best_time([torque.tau_a[(i, i)], to - from], friction[i], [shortest, of]);
            Way { takes, ..whole }
        };
        all.push((0..n).map(way).collect());
    }
    Ok(all)
}

/// Dry and viscous friction of each of n independent joints, with those of the joints that mimic it.
fn friction(robot: &Robot, n: usize) -> Vec<[f64; 2]> {
    let mut all = vec![[0.0; 2]; n];
    for (index, joint) in robot.joints().iter().enumerate() {
        let (leader, ratio) = joint.mimic.map_or((index, 1.0), |mimic| (mimic.joint, mimic.ratio));
        let row = robot.independent_indices().iter().position(|&own| own == leader);
        if let Some([dry, viscous]) = row.and_then(|row| all.get_mut(row)) {
            *dry += ratio.abs() * joint.friction.coulomb;
            *viscous += ratio * ratio * joint.friction.viscous;
        }
    }
    all
}

/// The time between these at which the way costs least.
fn best_time([mass, way]: [f64; 2], [dry, viscous]: [f64; 2], [shortest, longest]: [f64; 2]) -> f64 {
    let cost = |t: f64| {
        let (drag, inertia) = (viscous * way, mass * way);
        0.5 * dry * dry * t + 0.6 * drag * drag / t + 6.0 * inertia * inertia / (t * t * t)
    };
    let times = (0..constants::TIMES).map(|k| longest * 2.0_f64.powf(-constants::OCTAVES * f64::from(k)));
    let times = times.filter(|&t| t >= shortest);
    times.min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(longest)
}

impl Way {
    /// When it begins, this share of the time that is left having passed (s).
    fn begins(&self, share: f64) -> f64 {
        share * (self.of - self.takes)
    }

    /// q and its derivatives in the part x of the phase: a cubic from rest to rest, with continuous
    /// accelerations a quintic.
    fn at(&self, share: f64, part: f64, is_smooth: bool) -> [f64; 3] {
        let scale = self.of / self.takes;
        let x = ((part * self.of - self.begins(share)) / self.takes).clamp(0.0, 1.0);
        let shape = match (x > 0.0 && x < 1.0, is_smooth) {
            (false, _) => [x, 0.0, 0.0],
            (true, false) => [x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x), 6.0 - 12.0 * x],
            (true, true) => [
                x * x * x * (10.0 - x * (15.0 - 6.0 * x)),
                30.0 * x * x * (1.0 - x) * (1.0 - x),
                60.0 * x * (1.0 - x * (3.0 - 2.0 * x)),
            ],
        };
        let way = self.to - self.from;
        [self.from + way * shape[0], way * shape[1] * scale, way * shape[2] * scale * scale]
    }
}

/// The guess whose joints begin to move after this share of the time that they have left, with nodes where
/// they begin and end.
fn moved(own: &Spline, ways: &[Vec<Way>], share: f64) -> Spline {
    let (n, mesh) = (own.dof, &own.mesh);
    let mut nodes = mesh.nodes.clone();
    for (phase, way) in
        ways.iter().enumerate().flat_map(|(phase, ways)| ways.iter().map(move |way| (phase, way)))
    {
        let from = way.begins(share);
        for part in [from / way.of, (from + way.takes) / way.of] {
            let place = phase as f64 + part.clamp(0.0, 1.0);
            let right = nodes.partition_point(|&node| node < place - constants::SAME);
            if nodes.get(right).is_none_or(|node| *node > place + constants::SAME) {
                nodes.insert(right, place);
            }
        }
    }
    let is_smooth = mesh.shape.is_smooth();
    let at = |phase: usize, s: f64, z: &mut [f64]| {
        for (i, way) in ways[phase].iter().enumerate() {
            let found = way.at(share, s - phase as f64, is_smooth);
            (0..3).for_each(|order| z[n * order + i] = found[order]);
        }
    };
    let mut spline = Spline::through(n, Mesh::new(nodes, mesh.shape), own.times.clone(), at);
    for end in 0..=mesh.phases() {
        let (place, from) = (spline.end_unknowns(end), own.end_unknowns(end));
        spline.unknowns[place].copy_from_slice(&own.unknowns[from]);
    }
    spline
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without viscous friction `t^4 = 36 (M d / c)^2`; the grid of times is a factor `2^(1/8)`, 9 %, wide.
    #[test]
    fn the_time_is_where_friction_and_inertia_cost_least() {
        let (mass, way, dry) = (0.05_f64, 62.83_f64, 1.0_f64);
        let exact = (36.0 * (mass * way / dry) * (mass * way / dry)).powf(0.25);
        let found = best_time([mass, way], [dry, 0.0], [0.0, 8.0]);
        assert!((found / exact - 1.0).abs() < 0.05, "{found} {exact}");
        assert!(best_time([mass, way], [dry, 0.0], [6.0, 8.0]) >= 6.0);
        assert_eq!(best_time([mass, way], [dry, 0.0], [9.0, 8.0]), 8.0, "no time is long enough");
    }

    #[test]
    fn a_way_begins_and_ends_at_rest_in_its_share_of_the_time() {
        let way = Way { from: 1.0, to: 3.0, takes: 0.5, of: 2.0 };
        for is_smooth in [false, true] {
            for (share, begins) in [(0.0, 0.0), (0.5, 0.375), (1.0, 0.75)] {
                assert_eq!(way.at(share, begins, is_smooth)[..2], [1.0, 0.0]);
                let middle = way.at(share, begins + 0.125, is_smooth);
                assert!((middle[0] - 2.0).abs() < 1e-12, "{middle:?}");
                let step = 1e-6;
                let [before, after] = [-step, step].map(|dx| way.at(share, begins + 0.1 + dx, is_smooth));
                let at = way.at(share, begins + 0.1, is_smooth);
                assert!(((after[0] - before[0]) / (2.0 * step) - at[1]).abs() < 1e-6, "{at:?}");
                assert!(((after[1] - before[1]) / (2.0 * step) - at[2]).abs() < 1e-4, "{at:?}");
                assert_eq!(way.at(share, begins + 0.25, is_smooth)[..2], [3.0, 0.0]);
            }
        }
    }
}
