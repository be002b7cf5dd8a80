//! The constants that steer the search, all in one place.
//!
//! Numbers that decide *whether and how* something is tried stand here, grouped by the part that uses
//! them. Lengths of Newton corrections and errors are relative: component `i` in units of the largest
//! value that it takes along the motion. Times are in s where nothing else is said. Most of them change
//! how soon, and from which of several local minima, a solution is found. What a converged solution is
//! depends on `NEGLIGIBLE_CHANGE` and `SMOOTHED_TOLERANCE`, which define `ConvergedSmoothed`; in the
//! direct method on `VERIFIED` and the names that begin with `VIOLATION`; and which of two motions is
//! shown on the slack of the polish.

/// Damped Newton steps ([`crate::bvp::newton`]).
pub(crate) mod newton {
    /// Smallest damping tried where an attempt does not ask for a larger one.
    pub const LEAST_DAMPING: f64 = 1e-6;
    /// Smallest damping that is predicted from the last step: smaller ones must be found by halving.
    pub const LEAST_PREDICTION: f64 = 1e-3;
    /// A step with damping `d` must shorten the simplified correction by the factor `1 - DECREASE d`.
    pub const DECREASE: f64 = 0.25;
    /// A damping is raised once if the predicted one is this many times as large.
    pub const RAISE: f64 = 4.0;
    /// Newton's method solves the discrete equations to this part of the tolerance of the motion.
    pub const PART_OF_TOLERANCE: f64 = 0.1;
    /// No component is scaled by less than this part of the largest in its group.
    pub const LEAST_SCALE: f64 = 0.01;
    /// Components below this part of the size at which they would move others are rounding errors around
    /// zero.
    pub const NEGLIGIBLE: f64 = 1e-10;
    /// That size is computed only for components below this value, in their own units: it takes one more
    /// evaluation.
    pub const SMALL: f64 = 1e-6;
}

/// Mesh refinement ([`crate::bvp::collocation::error`]).
pub(crate) mod refinement {
    /// The next mesh aims at this part of the tolerance.
    pub const SAFETY: f64 = 0.3;
    /// Most intervals of the next mesh, as a multiple of those of the last one.
    pub const MOST_GROWTH: f64 = 4.0;
    /// Least growth where the error fell as the order of the method predicts.
    pub const LEAST_GROWTH: f64 = 1.1;
    /// Least growth where it did not.
    pub const SLOW_GROWTH: f64 = 1.5;
    /// The error of one mesh must be less than this part of that of the mesh before, else convergence is
    /// slow.
    pub const EXPECTED_GAIN: f64 = 0.1;
    /// Least density of intervals, as a part of the mean density.
    pub const LEAST_DENSITY: f64 = 0.2;
    /// Fewest intervals of an arc.
    pub const LEAST_INTERVALS: usize = 3;
    /// A mesh counts as full when it is within one part in this many of the largest number of intervals.
    pub const FULL: usize = 20;
}

/// Multiple shooting ([`crate::solve::multiple_shooting`]).
pub(crate) mod shooting {
    /// Tolerance of an integration step, as a part of the tolerance of the motion; the factor from one round
    /// to the next as well.
    pub const SHARPER: f64 = 0.01;
    /// Smallest tolerance of an integration step.
    pub const SHARPEST: f64 = 1e-14;
    /// Most rounds with sharper and sharper integration.
    pub const ROUNDS: usize = 3;
    /// Most pieces into which an interval is cut at once when the motion is represented by polynomials.
    pub const MOST_PIECES: usize = 4;
}

/// Arcs with known active bounds and unknown switching times ([`crate::solve::arcs`]).
pub(crate) mod arcs {
    /// How many times the arcs are read again from a solution that contradicts them.
    pub const ROUNDS: usize = 5;
    /// Smallest damping: where the arcs are right, the first steps are nearly full ones.
    pub const LEAST_DAMPING: f64 = 0.01;
    /// A solution on arcs whose cost differs by more than this part from that of the rough one is another
    /// motion.
    pub const FAR: f64 = 0.05;
    /// A switching function below this part of its size does not decide between two bounds.
    pub const UNDECIDED: f64 = 1e-6;
    /// How far a control may be on the wrong side of a bound, in half distances between its bounds.
    pub const SLACK: f64 = 2e-7;
    /// A control this far beyond a bound, in half distances between its bounds, violates it.
    pub const BEYOND: f64 = 1e-6;
    /// This many arcs or more are not tried.
    pub const MOST_ARCS: usize = 60;
    /// Fewest intervals on an arc.
    pub const LEAST_INTERVALS: usize = 4;
    /// Points in each interval at which a control is compared with its bounds.
    pub const SAMPLES: usize = 8;
}

/// Free final time ([`crate::solve::free_time`]).
pub(crate) mod free_time {
    /// Most fixed times that are solved before the time becomes an unknown.
    pub const ROUNDS: usize = 12;
    /// Smallest factor from one fixed time to the next.
    pub const LEAST_FACTOR: f64 = 0.4;
    /// Largest factor from one fixed time to the next.
    pub const LARGEST_FACTOR: f64 = 2.5;
    /// The time is near enough to become an unknown when the next factor differs from 1 by less than this.
    pub const NEAR: f64 = 0.1;
    /// Where all of the cost but `c_t T` falls like `T^-3`, `H* + c_t` falls like `T^-4`: its inverse.
    pub const POWER: f64 = 0.25;
}

/// Natural continuation from a relaxed problem to the problem itself ([`crate::solve::homotopy`]).
pub(crate) mod homotopy {
    /// First step, of a total length of 1.
    pub const FIRST_STEP: f64 = 0.125;
    /// Smallest step.
    pub const LEAST_STEP: f64 = 1.0 / 1024.0;
    /// After this many points a failure is final.
    pub const MOST_POINTS: usize = 60;
    /// Most nodes of an intermediate point.
    pub const MOST_NODES: usize = 1001;
    /// Most Newton steps on a mesh of an intermediate point.
    pub const MOST_STEPS: usize = 20;
    /// Smallest damping: smaller ones may lead to another solution.
    pub const LEAST_DAMPING: f64 = 0.02;
}

/// The attempts of a search and when they are accepted ([`crate::search::attempts`]).
pub(crate) mod attempts {
    /// Tolerance of solutions that only lead to the next one.
    pub const LOOSE: f64 = 1e-4;
    /// Most Newton steps on one mesh where another attempt is left.
    pub const FEW_STEPS: usize = 25;
    /// Factor of the penalties where they are relaxed.
    pub const WEAK_PENALTY: f64 = 1e-6;
    /// Relative smoothing of controls without effort at which the arcs are tried, in this order; 1 is a
    /// smoothing that matters as much as time does.
    pub const SMOOTHINGS: [f64; 13] =
        [0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7];
    /// A smoothed problem replaces the problem itself when the last change of the smoothing changed the
    /// cost by less than this part.
    pub const NEGLIGIBLE_CHANGE: f64 = 2e-5;
    /// Tolerance of a smoothed problem that replaces the problem itself.
    pub const SMOOTHED_TOLERANCE: f64 = 1e-8;
    /// A smoothed problem with more nodes than this is not made sharper without need: on singular arcs meshes
    /// would grow without end.
    pub const SMOOTHED_NODES: usize = 500;
}

/// Extremals from motions of the direct method ([`crate::polish`]).
pub(crate) mod polish {
    use std::time::Duration;

    /// A polish may take this many times the time of the direct method.
    pub const SHARE: u32 = 10;
    /// A polish may take this long in any case.
    pub const LEAST_TIME: Duration = Duration::from_millis(250);
    /// Tolerance of the direct method before a polish ..
    pub const ROUGH: f64 = 1e-4;
    /// .. and where torques are limited: when they reach their limits must be seen.
    pub const ROUGH_BOUNDED: f64 = 1e-6;
    /// A polish has a tolerance that is this part of the one that is asked for ..
    pub const SHARPER: f64 = 0.01;
    /// .. if it is no smaller than this, or asked for.
    pub const SHARP_ENOUGH: f64 = 1e-8;
    /// Points of the direct method in an interval of its mesh: that mesh is the first one of the polish.
    pub const STRIDE: usize = 4;
    /// How much more than the motion of the direct method an extremal may cost, in parts of the tolerance:
    /// the error of that cost is of this size.
    pub const SLACK: f64 = 10.0;
    /// The same in parts of the cost, where the direct method did not converge.
    pub const SLACK_UNSOLVED: f64 = 0.01;
    /// Relative smoothing from which controls without effort are sharpened if the arcs of the motion are not
    /// those of an extremal.
    pub const SMOOTHING: f64 = 0.01;
    /// Places in an interval at which limits are checked.
    pub const PLACES: [f64; 3] = [0.25, 0.5, 0.75];
}

/// Disturbances of first guesses ([`crate::cubics`]).
pub(crate) mod cubics {
    /// Amplitude of the disturbances of further starts, besides the distance from start to end (rad, m).
    pub const AMPLITUDE: f64 = 1.5;
    /// Share of the disturbances with one wave; the others have two.
    pub const ONE_WAVE: f64 = 0.7;
}

/// Pseudo-arclength continuation ([`crate::continuation`]); lengths are along the branch, whose parameter
/// goes from 0 to 1.
pub(crate) mod branch {
    /// First step.
    pub const FIRST_STEP: f64 = 0.05;
    /// Largest step.
    pub const LARGEST_STEP: f64 = 0.4;
    /// Smallest step.
    pub const LEAST_STEP: f64 = 1e-6;
    /// Most points.
    pub const MOST_POINTS: usize = 500;
    /// A point farther from its prediction than this part of the step may be on another branch.
    pub const MOST_BEND: f64 = 0.15;
    /// The step is doubled where the bend is less than this part of `MOST_BEND`.
    pub const STRAIGHT: f64 = 0.25;
    /// Most Newton steps on a mesh.
    pub const MOST_STEPS: usize = 10;
    /// Smallest damping: smaller ones may lead to another branch.
    pub const LEAST_DAMPING: f64 = 0.1;
    /// Most meshes for a point.
    pub const MOST_MESHES: usize = 8;
    /// Half the distance of the central difference in the parameter.
    pub const DIFFERENCE: f64 = 1e-5;
    /// Most points that are computed to locate a turning point.
    pub const TURNING_ROUNDS: usize = 12;
    /// |d parameter / d length| at what counts as a turning point; the parameter differs by its square.
    pub const FLAT: f64 = 1e-5;
    /// Bounds this many times as far apart are hardly active.
    pub const WIDE: f64 = 1000.0;
}

/// Times that joints need at least ([`crate::problem::least_time`]).
pub(crate) mod least_time {
    /// A joint has too little time if it needs more by this part of it: less may be rounding.
    pub const ROUNDING_OF_TIMES: f64 = 1e-9;
    /// A way that differs from that of a single acceleration by less than this part of both, and of what
    /// stopping from the rates takes, is one.
    pub const ROUNDING_OF_WAYS: f64 = 1e-12;
}

/// The direct method ([`crate::direct`]).
pub(crate) mod direct {

    /// Weight of a node among the limits, as a part of the intervals beside it. At a node only positions and
    /// rates are limited; without it rates could swing between the points.
    pub const NODE_WEIGHT: f64 = 0.1;
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
    /// It rises by this factor..
    pub const STIFFER: f64 = 10.0;
    /// .. to at most this..
    pub const MOST_STIFFNESS: f64 = 1e13;
    /// .. when a whole step leaves more than this part of the equations..
    pub const LEFT_OF_EQUATIONS: f64 = 0.1;
    /// .. that were violated by less than this before.
    pub const CLOSE_TO_EQUATIONS: f64 = 1e-5;
    /// Cost of torques that have none, for the first motion: at their limits it is this part of the cost of
    /// time.
    pub const SMOOTHING: f64 = 1.0;
    /// How many final times are tried for a guess to each side of its own ..
    pub const TIMES: i32 = 8;
    /// .. so many powers of two apart.
    pub const OCTAVES: f64 = 0.5;
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
    /// Smallest factor from one barrier to the next.
    pub const MOST_DECREASE: f64 = 1e-3;
    /// Largest factor from one barrier to the next.
    pub const MOST_INCREASE: f64 = 10.0;
    /// Largest violation of a limit at a point, in parts of its range.
    pub const VIOLATION_AT_POINTS: f64 = 1e-9;
    /// Largest violation of a position or rate between points, in parts of its range.
    pub const VIOLATION_BETWEEN: f64 = 1e-4;
    /// Where nothing but limits between points is missing, and by less than this part of their ranges, limits
    /// move inside, ..
    pub const MOST_MOVED: f64 = 3e-3;
    /// .. this many times as far as they are exceeded, ..
    pub const MOVED: f64 = 1.5;
    /// .. where that is more than this part of what is allowed, ..
    pub const MOVED_FROM: f64 = 0.5;
    /// .. so many times on one mesh.
    pub const MOVES: usize = 3;
    /// Intervals in which a jerk or the rate of a torque exceeds its limit by more than this part of its
    /// range are divided with those that have large errors.
    pub const VIOLATION_OF_RATES: f64 = 0.01;
    /// A motion that exceeds a limit by more than this part of its range does not keep it.
    pub const VIOLATION_ACCEPTED: f64 = 1e-7;
    /// A limit is active where the distance to it is within this part of its range.
    pub const ACTIVE: f64 = 1e-4;
    /// The problem on a mesh is solved to this part of the tolerance.
    pub const PART_OF_TOLERANCE: f64 = 0.1;
    /// A motion is verified if it ends within this factor of the root of the tolerance when its torques,
    /// cut to their limits, are integrated; relative to the largest values along it. The cost of an
    /// optimal motion is stationary, so its error is about the square of that of the states.
    pub const VERIFIED: f64 = 0.3;
    /// .. where values of a joint are at least this part of those of all joints..
    pub const LEAST_SCALE: f64 = 0.01;
    /// .. and this (rad, rad/s, m, m/s): what the integration resolves.
    pub const REST: f64 = 1e-6;
    /// Relative tolerance of a step of this integration.
    pub const INTEGRATION: f64 = 1e-10;
    /// The problem on the first mesh is solved to this part of the cost.
    pub const FIRST_PRECISION: f64 = 1e-3;
    /// Those on later meshes to this part of the estimated error before.
    pub const PRECISION: f64 = 1e-2;
    /// Intervals are divided until those that are not have this part of the estimated error..
    pub const LEFT: f64 = 0.002;
    /// .. or this part of the tolerance.
    pub const ENOUGH: f64 = 0.1;
    /// Most parts into which an interval is divided at once.
    pub const MOST_PARTS: f64 = 4.0;
    /// Intervals below this part of the whole are not divided: rounding of positions would be large in their
    /// accelerations..
    pub const NARROWEST: f64 = 1e-5;
    /// .. nor where jerks and rates of torques would be rounded by this part of the range of their limits.
    pub const ROUNDING_OF_RATES: f64 = 3e-8;
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
    /// Steps in which the largest violation of a limit does not fall..
    pub const PATIENCE: usize = 40;
    /// .. below this part of what it was, before the elastic phase is entered.
    pub const PROGRESS: f64 = 0.9;
    /// Most elastic phases.
    pub const RESTORATIONS: usize = 3;
    /// It begins at the first guess if that violates limits less, and the iterate by more than this part of a
    /// range.
    pub const WILD: f64 = 0.5;
    /// Room of limits at the start of the elastic phase, in parts of ranges and of what they must give, and
    /// the gap there in parts of cost and price..
    pub const ELASTIC_COLD: (f64, f64) = (0.3, 0.1);
    /// .. and near a minimum of a coarser mesh.
    pub const ELASTIC_WARM: (f64, f64) = (0.02, 1e-3);
    /// Price of what limits give, of all of a range, in parts of the cost..
    pub const PRICE: f64 = 100.0;
    /// .. and the factor by which it rises..
    pub const DEARER: f64 = 100.0;
    /// .. so that at most so many prices are tried, ..
    pub const PRICES: usize = 3;
    /// .. until what limits give is more than this part of what it was.
    pub const SAME_PRICE: f64 = 0.95;
    /// Around zero the price is rounded by this, in parts of ranges.
    pub const ROUNDED_PRICE: f64 = 1e-3;
    /// Slacks after the elastic phase and in it are at least this part of a range.
    pub const LEAST_ROOM: f64 = 1e-3;
    /// The elastic problem is solved to this part of its cost..
    pub const ELASTIC_PRECISION: f64 = 1e-3;
    /// .. in at most so many steps.
    pub const ELASTIC_STEPS: usize = 200;
    /// Equations may be left off by this part of their range: Newton's method mends that.
    pub const OFF_EQUATIONS: f64 = 1e-3;
    /// Meshes of the elastic phase, ..
    pub const ELASTIC_MESHES: usize = 4;
    /// .. each with intervals of half the width, until what limits give is more than this part of what it
    /// was.
    pub const SAME_RELIEF: f64 = 0.8;
    /// Finer meshes than this are not divided in the elastic phase.
    pub const ELASTIC_INTERVALS: usize = 100;
    /// Limits that give are told if that is more than this part of what another one gives.
    pub const NOTICED_RELIEF: f64 = 1e-2;
    /// A motion that cannot keep its limits is tried in these multiples of its time..
    pub const SLOWER: [f64; 8] = [1.2, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0];
    /// .. before its time is minimised with this cost of it, in parts of the cost.
    pub const HURRY: f64 = 100.0;
    /// Most meshes.
    pub const MESHES: usize = 16;
    /// Meshes after which a motion that exceeds limits is given up.
    pub const MESHES_WITHOUT_MOTION: usize = 2;
}

/// Machine code for the points of the direct method (`direct::points::programs`).
#[cfg(feature = "jit")]
pub(crate) mod programs {
    /// Robots whose programs are kept for later problems.
    pub const ROBOTS: usize = 4;
    /// Points for each joint whose second derivatives the generic code computes before their program is
    /// compiled, unless [`MachineCode`](crate::MachineCode) says otherwise: they take about half of the time
    /// of compiling. A solve from a good guess needs no more.
    pub const HESSIANS: usize = 120;
    /// The same for points whose torques alone are computed.
    pub const TORQUES: usize = 300;
    /// Longest programs, in steps; longer ones take longer to compile than they save in one solve.
    pub const STEPS: usize = 16_000;
    /// Most joints, so that no robot is recorded for long in vain.
    pub const JOINTS: usize = 14;
}

/// Functions of tools and clearances ([`crate::task`]).
pub(crate) mod task {
    /// Least square of the sine between an axis and the direction that it shall have, beyond a right angle:
    /// at opposite the rotation between the two is not unique, and its derivatives are infinite.
    pub const OPPOSITE: f64 = 1e-24;
    /// What makes the closest places of parallel segments unique, in squares of the sum of radii: the
    /// clearance is lowered by at most a quarter of this, in radii. With less its second derivatives at
    /// parallel segments become large.
    pub const PARALLEL: f64 = 4e-3;
    /// Points of a segment whose depths inside of a box count, its ends among them.
    pub const DEPTHS: usize = 5;
    /// A search for bodies that meet ends where a clearance is violated by this part of its range: cores have
    /// met at 0.59.
    pub const MEETING: f64 = 0.5;
    /// Least part of a piece of a motion that the search goes on.
    pub const SHORTEST_STEP: f64 = 1e-4;
    /// Segments that are not longer than this are points (m).
    pub const SHORTEST_LINK: f64 = 1e-6;
    /// Most entries of each list of a task.
    pub const MOST_ENTRIES: usize = 1000;
    /// Most pairs of bodies and obstacles.
    pub const MOST_PAIRS: usize = 10_000;
    /// An end that is given may be off an equation that holds along the motion by so much (m, rad).
    pub const OFF: f64 = 1e-6;
    /// The same for an inequality, in parts of its range.
    pub const CLOSE: f64 = 1e-9;

    /// The search for positions of given poses ([`crate::task::reach`]).
    pub mod reach {
        /// A pose is reached to this (m, rad).
        pub const REACHED: f64 = 1e-9;
        /// Positions that the search begins at.
        pub const STARTS: usize = 60;
        /// Most steps from each of them.
        pub const STEPS: usize = 60;
        /// First damping, in squares of m or rad per rad.
        pub const DAMPING: f64 = 1e-3;
        /// With more damping than this there is no progress.
        pub const MOST_DAMPING: f64 = 1e6;
        /// Derivatives that are not larger are rounding.
        pub const STILL: f64 = 1e-13;
    }
}
