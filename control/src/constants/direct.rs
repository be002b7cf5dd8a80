//! The direct method ([`crate::direct`]).

/// Weight of a node among the limits, as a part of the intervals beside it. At a node only positions and
/// rates are limited; without it rates could swing between the points.
pub const NODE_WEIGHT: f64 = 0.1;
/// A gradient of which less than this part is no combination of others counts as one.
pub const IMPLIED: f64 = 1e-4;
/// Least number of intervals with which a phase of several begins.
pub const INTERVALS_OF_PHASE: usize = 4;
/// Slacks and multipliers keep at least this part of themselves in a step.
pub const BOUNDARY: f64 = 0.005;
/// Steps are cut short that are shorter than this..
pub const SHORT: f64 = 0.05;
/// .. and after so many of them slacks and multipliers move away from the limits..
pub const SHORT_STEPS: usize = 2;
/// .. to this many times the gap.
pub const AWAY: f64 = 10.0;
/// Most steps on a mesh without second derivatives of torques.
pub const SQUARES: usize = 40;
/// If less than this part of such a step was taken, the next one is damped, ..
pub const POOR: f64 = 0.3;
/// .. at first with this, ..
pub const LEAST_OF_SQUARES: f64 = 1e-2;
/// .. if more than this part was taken, ..
pub const GOOD: f64 = 0.6;
/// .. by this factor less, ..
pub const DOWN_OF_SQUARES: f64 = 0.2;
/// .. and below this not at all.
pub const NONE_OF_SQUARES: f64 = 1e-3;
/// Most corrections of a step..
pub const CORRECTIONS: usize = 2;
/// .. which aims at one that is longer by this, ..
pub const LONGER: f64 = 0.3;
/// .. if it is shorter than this, ..
pub const LONG_ENOUGH: f64 = 0.95;
/// .. at products of slacks and multipliers of at least this part of that on the central path ..
pub const LEAST_PRODUCT: f64 = 0.1;
/// .. and at most this many times as large. ..
pub const MOST_PRODUCT: f64 = 10.0;
/// .. Both steps together become longer by at least this.
pub const LEAST_GAIN: f64 = 0.03;
/// First damping where the matrix is not positive definite or no step is accepted.
pub const DAMPING: f64 = 1e-6;
/// With this damping, that of the effort itself, a step still tells whether there is anything to gain.
pub const SOLVED_DAMPING: f64 = 1.0;
/// How stiff squares of equations are made, in parts of what they are, to tell a saddle from a minimum. In
/// the matrix of the last one a direction of negative curvature is looked for: softer ones leave the
/// equations along it, stiffer ones are rounded by more.
pub const STIFFNESSES: [f64; 5] = [1.0, 1e-2, 1e-4, 1e4, 1e2];
/// With this damping, in parts of the effort, the matrix of a saddle is still not positive definite.
pub const ROUNDED_INERTIA: f64 = 1e-6;
/// Factor from one damping to the next larger one.
pub const DAMPING_UP: f64 = 10.0;
/// Factor from the damping of one step to the first one of the next.
pub const DAMPING_DOWN: f64 = 0.1;
/// With more damping than this there is no progress.
pub const MOST_DAMPING: f64 = 1e10;
/// Part of changes of rates, over T, and of positions, over T squared, beside those of accelerations in
/// what is damped.
pub const REST_OF_METRIC: f64 = 1e-2;
/// Shortest part of a step that is tried before the damping rises.
pub const SHORTEST: f64 = 0.05;
/// Slacks start at this part of the range of their limit, if the motion is not farther inside.
pub const FIRST_SLACK: f64 = 0.05;
/// The same on a finer mesh.
pub const LEAST_SLACK: f64 = 1e-5;
/// Curvature in T that is less than this part of its terms is rounding.
pub const LEAST_CURVATURE: f64 = 1e-14;
/// Costs are not resolved below that of a motion by so much (rad, m).
pub const SMALL_MOTION: f64 = 1e-3;
/// What an equation of weight one that is off by its range costs in Newton's matrix, in parts of the cost
/// of the guess. With more of it multipliers settle in fewer steps, and rounding of what it does not
/// touch grows.
pub const STIFFNESS: f64 = 1e8;
/// The same of an active limit where the motion is differentiated, at most: derivatives are off by about
/// the reciprocal of it, and rounding of it, which grows with the fourth power of the number of intervals,
/// must not hide the curvature of the cost.
pub const STIFFEST_LIMIT: f64 = 1e5;
/// It rises by this factor..
pub const STIFFER: f64 = 10.0;
/// .. to at most this..
pub const MOST_STIFFNESS: f64 = 1e13;
/// .. when a whole step leaves more than this part of the equations..
pub const LEFT_OF_EQUATIONS: f64 = 0.1;
/// .. that were violated by less than this before.
pub const CLOSE_TO_EQUATIONS: f64 = 1e-5;
/// Equations become softer by this factor where rounding of their squares seems to be the reason for a
/// damping ..
pub const SOFTER: f64 = 1e-2;
/// .. of this or more, ..
pub const SOFTENS_FROM: f64 = 1e-3;
/// .. if no more than this part of it is needed then. ..
pub const LESS_DAMPING: f64 = 1e-2;
/// .. They stay at least so stiff. ..
pub const LEAST_STIFFNESS: f64 = 1e4;
/// .. That is not tried in the first damped steps on a mesh, ..
pub const FIRST_WAIT: usize = 4;
/// .. and after trials that did not help again after at most so many powers of two of damped steps.
pub const MOST_WAITS: u32 = 6;
/// Cost of torques that have none, for the first motion: at their limits it is this part of the cost of
/// time.
pub const SMOOTHING: f64 = 1.0;
/// Least time itself is given up where meshes have more nodes than this: torques that do not matter jump on
/// each of them. More are tried where a cost of torques does not help either.
pub const NODES_OF_LEAST_TIME: usize = 2001;
/// Where least time itself is not solved, this cost becomes smaller by this factor, ..
pub const LESS_EFFORT: f64 = 0.1;
/// .. until what it can cost in time is below the tolerance, at the latest at this part of that. ..
pub const LEAST_EFFORT: f64 = 1e-2;
/// .. Motions with it are solved to this tolerance at best: what they cost is not known better. ..
pub const EFFORT_TOLERANCE: f64 = 1e-4;
/// .. If it is below this, relative to the cost, the motion counts as a smoothed solution.
pub const SMOOTHED_ENOUGH: f64 = 1e-2;
/// How many final times are tried for a guess to each side of its own ..
pub const TIMES: i32 = 8;
/// .. so many powers of two apart.
pub const OCTAVES: f64 = 0.5;
/// A joint with a shorter way than this has none (rad, m).
pub const NEGLIGIBLE_WAY: f64 = 1e-12;
/// Second derivatives of a guess are differences of its first ones at places that are this part of an
/// interval away.
pub const NEIGHBOUR: f64 = 0.25;
/// Gap at the start, as a part of the cost of the guess.
pub const FIRST_GAP: f64 = 1.0;
/// Gap at the start on a finer mesh, as a part of the cost; small ones leave the iterate at a wrong
/// corner.
pub const WARM: f64 = 1e-2;
/// Multipliers on a finer mesh are within this factor of the central path.
pub const OFF_CENTRE: f64 = 10.0;
/// A warm start keeps at least this part of each multiplier..
pub const KEPT: f64 = 0.1;
/// .. and of the final time.
pub const SHORTEST_TIME: f64 = 0.5;
/// What the longest Newton step took counts this part less after each later one.
pub const FADES: f64 = 0.9;
/// After a solve that was not finished, an iterate that costs so many times what the last solved motion cost
/// is compared with that one..
pub const FAR_FROM_SOLVED: f64 = 1.5;
/// .. where a violation of all of a range costs so many times as much.
pub const PRICE_OF_VIOLATION: f64 = 1e2;
/// A motion with a free time begins later by at most this part of it.
pub const LATEST: f64 = 0.5;
/// Multipliers are always within this factor of it.
pub const FAR: f64 = 1e10;
/// Cost and barrier must decrease by a part of what a step promises where this power of the promise of
/// the whole step, in parts of the cost, times the part that is taken..
pub const OF_DESCENT: f64 = 2.3;
/// .. is more than this power of the infeasibility.
pub const OF_INFEASIBILITY: f64 = 1.1;
/// Part of the predicted decrease of cost and barrier that a step must reach.
pub const ARMIJO: f64 = 1e-4;
/// Iterates that a trial is compared with.
pub const FILTER: usize = 40;
/// Times that they are forgotten because no step is better than all of them.
pub const RESETS: usize = 5;
/// Part of the infeasibility by which a step must reduce it, or cost and barrier.
pub const DECREASE: f64 = 1e-5;
/// Factor by which infeasibility may grow in a step.
pub const MOST_INFEASIBLE: f64 = 10.0;
/// Rounding of cost and barrier.
pub const ROUNDING: f64 = 1e-12;
/// Gap that is aimed at, as a part of the tolerance.
pub const LEAST_GAP: f64 = 0.1;
/// The gap is not made smaller than this part of the Newton decrement.
pub const CENTRING: f64 = 0.01;
/// After a damped step the gap falls where the Newton decrement is less than this part of it, ..
pub const CENTRED: f64 = 1e-3;
/// .. to the cube of this.
pub const CENTRED_PART: f64 = 0.5;
/// Smallest factor from one barrier to the next.
pub const MOST_DECREASE: f64 = 1e-3;
/// Largest factor from one barrier to the next.
pub const MOST_INCREASE: f64 = 10.0;
/// Largest violation of a limit at a point, in parts of its range.
pub const VIOLATION_AT_POINTS: f64 = 1e-9;
/// Largest violation of a position or rate between points, in parts of its range.
pub const VIOLATION_BETWEEN: f64 = 1e-4;
/// Where nothing but limits between points is missing, limits move inside; positions, rates and distances
/// only by less than this part of their ranges, ..
pub const MOST_MOVED: f64 = 3e-3;
/// .. this many times as far as they are exceeded, ..
pub const MOVED: f64 = 1.5;
/// .. those of what may jump by at most this part of their range, ..
pub const MOST_OF_JUMPS: f64 = 2.0 / 7.0;
/// .. where that is more than this part of what is allowed, ..
pub const MOVED_FROM: f64 = 0.5;
/// .. so many times on one mesh, ..
pub const MOVES: usize = 3;
/// .. as long as less than this part of what was exceeded before is left.
pub const LESS_EXCEEDED: f64 = 0.5;
/// Where that costs more than the tolerance, at most so many meshes are finer around jumps for nothing else.
pub const MESHES_BETWEEN: usize = 6;
/// Intervals in which a jerk or the rate of a torque exceeds its limit by more than this part of its
/// range are divided with those that have large errors.
pub const VIOLATION_OF_RATES: f64 = 0.01;
/// A motion that exceeds a limit by more than this part of its range does not keep it.
pub const VIOLATION_ACCEPTED: f64 = 1e-7;
/// Solving again on a mesh that stays, a clearance may be exceeded between points by this part of the radii
/// and the margin.
pub const CLEARANCE_ACCEPTED: f64 = 1e-2;
/// A limit is active where the distance to it is within this part of its range.
pub const ACTIVE: f64 = 1e-4;
/// Tolerances up to this are tight ones, ..
pub const TIGHT: f64 = 1e-6;
/// .. and from this on loose ones. Pairs of constants are those of a tight and of a loose tolerance.
pub const LOOSE: f64 = 1e-4;
/// The problem on a mesh is solved to this part of the tolerance: this is the largest gap, ..
pub const PART_OF_TOLERANCE: [f64; 2] = [0.1, 0.3];
/// .. and this part of it the largest Newton decrement, which bounds nothing where limits bend.
pub const OF_DECREMENT: [f64; 2] = [1.0, 1.0 / 3.0];
/// A motion is verified if it ends within this factor of the root of the tolerance when its torques,
/// cut to their limits, are integrated; relative to the largest values along it. The cost of an
/// optimal motion is stationary, so its error is about the square of that of the states.
pub const VERIFIED: f64 = 0.3;
/// Largest gap of the maximum principle along an optimal motion, relative to the tolerance: the cost may be
/// above that of the optimal motion by that much, to second order. The estimate of the error of the cost,
/// which is at most the tolerance, was too small by up to four times where torques jump ([`SAFETY`]); twice
/// that, since costates are known between points only as well as multipliers are.
pub const GAP: f64 = 8.0;
/// The same of motions whose jerks are limited, and no less than [`LEAST_JERK_GAP`]. The bound is loose
/// there: a junction that a mesh does not resolve counts with the third power of its width, and costs as
/// much as with the fifth. It was 4 to 50 times the true error on nine motions of two joints. What halving
/// the mesh changes is their error.
pub const JERK_GAP: f64 = 100.0;
/// .. a hundredth of the cost.
pub const LEAST_JERK_GAP: f64 = 0.01;
/// Largest excess of a limit on what may jump at nodes, between points and relative to its range: next to a
/// jump polynomials overshoot on any mesh.
pub const OVERSHOOT: f64 = 0.1;
/// Where it does not, so many parts of it must end so near together, each integrated from its own start.
/// Errors of an unstable motion grow by e in its time constant: by exp(3), 20 times, over one of 20 parts
/// of a motion that takes 60 of these, which `exp(60)` leaves nothing of when it is integrated at once.
pub const PARTS: f64 = 20.0;
/// .. where values of a joint are at least this part of those of all joints..
pub const LEAST_SCALE: f64 = 0.01;
/// .. and this (rad, rad/s, m, m/s): what the integration resolves.
pub const REST: f64 = 1e-6;
/// Relative tolerance of a step of this integration.
pub const INTEGRATION: f64 = 1e-10;
/// Factor of the estimated error of the cost. Of 80 motions of the classes of `benches/ocp` at a tolerance
/// of 1e-4 none was off by more than 1.5 times the estimate without it; least time, whose torques jump, was
/// by up to four times.
pub const SAFETY: f64 = 1.5;
/// The problem on the first mesh is solved to this part of the cost.
pub const FIRST_PRECISION: f64 = 1e-3;
/// Which of two guesses is better is told where their costs differ by more than this many times what is still
/// to be gained, ..
pub const DECIDED: f64 = 2.0;
/// .. and limits are exceeded by less than this part of their ranges.
pub const DECIDED_VIOLATION: f64 = 1e-3;
/// The motion without obstacles, from which a way around them is looked for, is solved to this part: on its
/// first mesh, unless that is far off.
pub const FREE_TOLERANCE: f64 = 1.0;
/// Those on later meshes to this part of the estimated error before.
pub const PRECISION: f64 = 1e-2;
/// Intervals are divided until those that are not have this part of the estimated error..
pub const LEFT: f64 = 0.002;
/// .. or this part of the tolerance.
pub const ENOUGH: [f64; 2] = [0.1, 0.5];
/// Where the peak beyond a limit that is touched makes this part of the error of an interval, the interval is
/// divided there, ..
pub const OF_PEAK: f64 = 0.5;
/// .. unless the peak is as close to a node as this part of it: where limits are kept at nodes, and where
/// they are kept at points alone.
pub const BESIDE_NODE: [f64; 2] = [0.02, 0.1];
/// Parts of it that are larger than this are halved then.
pub const NEARLY_WHOLE: f64 = 0.7;
/// Most parts into which an interval is divided at once.
pub const MOST_PARTS: f64 = 4.0;
/// Intervals below this part of the whole are not divided: rounding of positions would be large in their
/// accelerations..
pub const NARROWEST: f64 = 1e-5;
/// .. nor where jerks and rates of torques would be rounded by this part of the range of their limits.
pub const ROUNDING_OF_RATES: f64 = 3e-8;
/// The same of accelerations and torques.
pub const ROUNDING_OF_TORQUES: f64 = 1e-8;
/// Where an interval crosses something narrow, the least width is this part of that.
pub const NARROWER: f64 = 0.1;
/// Beside what is narrow, a gap between nodes is at most this many times as wide as the one before it, ..
pub const GRADED: f64 = 4.0;
/// .. with at most so many nodes in an interval of the mesh before.
pub const MOST_GRADED: usize = 64;
/// References are nodes at their knots if those take no more than this part of the nodes that are allowed.
pub const KNOTS_OF_NODES: usize = 10;
/// New nodes are farther from others than this part of the narrowest width: close pairs enclose a jump
/// whose place is known roughly..
pub const CLOSEST: f64 = 0.1;
/// .. but farther than this where accelerations are continuous, whose jerks rounding would spoil.
pub const CLOSEST_SMOOTH: f64 = 0.7;
/// Torques and accelerations that change by less than this part of their range over an interval do
/// not jump in it.
pub const LEAST_JUMP: f64 = 0.01;
/// Polynomials that miss the value of the next interval by more than this part of a change contain a
/// jump.
pub const MISS: f64 = 0.01;
/// Where coefficients are limited a jump misses no value of the next interval: there the slopes beside an
/// interval with a jump explain all but this part of the change at most.
pub const STEEP: f64 = 0.5;
/// A jump at a node is one of the exact motion if it is larger than this part of the range of the
/// torque, and that at the other end of an interval smaller than this part of it.
pub const EXACT_JUMP: f64 = 0.05;
/// Steps of the fixed point of the place of a jump: its error falls with the width in each.
pub const STEPS_OF_JUMP: usize = 6;
/// A jump that is closer to a node than this part of the interval is one at the node.
pub const NEAREST_JUMP: f64 = 0.01;
/// Jumps at places of an interval that differ by less than this part of it are one.
pub const SAME_JUMP: f64 = 0.1;
/// A node at which a torque jumps by more than this part of its range stays.
pub const NEEDED: f64 = 0.2;
/// A node moves to a jump that is within this part of the interval beside it.
pub const NEAR_NODE: f64 = 0.3;
/// A node moves again if the way is shorter than this part of the last one.
pub const APPROACH: f64 = 0.5;
/// Iterations after which it is seen whether a mesh resolves a motion whose torques cost something, ..
pub const LOOK: usize = 8;
/// .. and what the points miss of the cost, in parts of it, with which the mesh is given up: what is gained
/// on it is lost between its points.
pub const UNRESOLVED: f64 = 1.0;
/// .. After so many of these meshes, one after the other, the motion that the last one began with is given.
pub const UNRESOLVED_MESHES: usize = 6;
/// .. and another search begins at it, so often.
pub const SEARCHES_FROM_UNRESOLVED: usize = 2;
/// Steps in which an iterate may miss its equations by more than it should, but by no more than is accepted,
/// with gap and decrement as small as they should be: what is left is rounding.
pub const STEPS_AT_ROUNDING: usize = 6;
/// Most meshes.
pub const MESHES: usize = 16;
/// Meshes after which a motion that exceeds limits is given up.
pub const MESHES_WITHOUT_MOTION: usize = 2;
