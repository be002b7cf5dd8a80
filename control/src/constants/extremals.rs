//! Extremals: one boundary-value problem, the search for its solution, and branches of solutions.

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
    /// An arc at an end that is shorter than this part of the time is none.
    pub const SHORTEST: f64 = 1e-9;
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
