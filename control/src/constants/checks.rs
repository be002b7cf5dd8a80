//! How motions are checked and read off: verification, conjugate times, derivatives.

/// Conjugate times.
pub(crate) mod conjugate {
    /// Fewest parts of the motion over which conjugate times are counted; the count must be the same over
    /// half as many.
    pub const PIECES: usize = 32;
    /// Relative tolerance of one integration step.
    pub const TOLERANCE: f64 = 1e-11;
    /// Least relative error that is assumed of collocated transitions in a first look, which is enough where
    /// there are clearly no conjugate times.
    pub const LOOSE: f64 = 1e-8;
    /// The conjugate time is located to this fraction of a mesh interval.
    pub const LOCATED: f64 = 1e-10;
    /// Smallest part of a mesh interval that is examined by itself.
    pub const LEAST_PART: f64 = 1e-3;
}

/// Defects of arcs, integrated again.
pub(crate) mod defect {
    /// Most segments of an arc.
    pub const SEGMENTS: usize = 20;
}

/// Pieces without a conjugate time, by the integral of a rate.
pub(crate) mod disconjugate {
    /// Largest integral that is accepted: what is left covers the error of the quadrature.
    pub const MOST: f64 = 0.75;
    /// A rate whose integral over a whole piece is below this needs no eigenvalues: its Frobenius norm will
    /// do.
    pub const NEGLIGIBLE: f64 = 0.1;
}

/// The motion on a finer mesh, beside a solved one.
pub(crate) mod finer_mesh {
    /// Most Newton steps that it may take from the solved one.
    pub const STEPS: usize = 60;
    /// How often the search goes on from it where the cost changes by more than the tolerance.
    pub const MESHES: usize = 3;
}

/// A motion that is solved once more without its multipliers.
pub(crate) mod once_more {
    /// Parts of an interval on the mesh for that: that of the judge of random motions, whose cheaper
    /// motions it finds; halves led no lower in one of two.
    pub const PARTS: usize = 3;
    /// It is taken if it costs less by this many tolerances at least.
    pub const CHEAPER: f64 = 1.0;
    /// How often.
    pub const TIMES: usize = 3;
}

/// Joints that a mesh does not follow.
pub(crate) mod fast_joint {
    /// `rho h` above which a mesh does not follow.
    pub const RESOLVED: f64 = 4.0;
    /// Squarings of the matrix: the norm of `A^k` to the power `1/k`, with k = 2^8, is its largest eigenvalue
    /// to a few per cent.
    pub const SQUARINGS: u32 = 8;
    /// Most places of a motion that are looked at.
    pub const PLACES: usize = 400;
    /// A joint is held by an inertia of so many times the largest one of the robot.
    pub const HELD: f64 = 1e6;
    /// Bisections, on a logarithmic scale, of the inertia that helps.
    pub const BISECTIONS: usize = 40;
}

/// Eigenvalues of Jacobi fields.
pub(crate) mod jacobi_fields {
    /// No conjugate time is certain if every eigenvalue exceeds this multiple of the error: the tolerance, or
    /// more where the asymmetry shows more.
    pub const CLEAR: f64 = 100.0;
    /// Relative asymmetry of `B^-1 A` above which rounding decides: nothing is claimed then.
    pub const MOST_ASYMMETRY: f64 = 1e-4;
    /// While a conjugate time is located, eigenvalues up to this fraction of the largest one are not
    /// positive.
    pub const ZERO: f64 = 1e-12;
}

/// The mesh of a saved motion, from its nodes.
pub(crate) mod mesh_nodes {
    /// Times that differ by less than this part of their phase are one.
    pub const SAME: f64 = 1e-9;
    /// The middle of an interval is where it should be up to this part of the interval.
    pub const MIDDLE: f64 = 1e-3;
}

/// Motions that are integrated again.
pub(crate) mod verify {
    /// Tolerance of one integration step, in parts of the tolerance of the motion: the motion is judged, not
    /// the integrator.
    pub const SHARPER: f64 = 1e-4;
    /// Smallest tolerance of an integration step.
    pub const SHARPEST: f64 = 1e-12;
    /// Draws of errors for the conditioning.
    pub const DRAWS: usize = 4;
    /// Tolerance of a motion that is solved again because its integration missed the end.
    pub const SHARP: f64 = 1e-9;
    /// Error of the quadrature of the cost, relative to the difference of costs that is allowed.
    pub const OF_COST: f64 = 1e-2;
}

/// What of a solution is read off.
pub(crate) mod found {
    /// M is nearly singular where a pivot of its factorisation is not more than this part of its diagonal
    /// entry.
    pub const LEAST_PIVOT: f64 = 1e-3;
}

/// Gains along a motion.
pub(crate) mod feedback {
    /// Gains grow without bound towards what is given; they are held from this part of the time of a phase
    /// on.
    pub const HELD: f64 = 0.98;
}

/// Solving again near a motion.
pub(crate) mod solved_near {
    /// Equal intervals, where the mesh of the motion does not do.
    pub const INTERVALS: usize = 60;
}

/// Derivatives of the cost by parameters.
pub(crate) mod cost_by_robot {
    /// Slopes of equations that are larger are not rounding.
    pub const STILL: f64 = 1e-9;
}

/// First guesses of the times of phases.
pub(crate) mod phase_times {
    /// The part of all phases that counts for a phase without a way.
    pub const LEAST_SHARE: f64 = 0.05;
}

/// References over time.
pub(crate) mod references {
    /// Two rotations that are this close to half a turn apart have no way between them that would be meant.
    pub const NEAR_HALF_TURN: f64 = 1e-6;
}

/// Rows of what is given at an end.
pub(crate) mod given_rows {
    /// A row is one of those before it where no more than this part of it is left.
    pub const INDEPENDENT: f64 = 1e-8;
}

/// Rows of constraints at an end.
pub(crate) mod loops {
    /// A direction is none of those before it where no more than this part of it is left.
    pub const INDEPENDENT: f64 = 1e-6;
}

/// Gaits.
pub(crate) mod gait {
    /// What no joint moves by more, at unit rate, is fixed (m); gravity is along -z up to this part of it.
    pub const PLANAR: f64 = 1e-9;
    /// The largest coefficient of friction: edges of wider cones are nearly one line, and equations along
    /// them are not solved. A search for RABBIT's step succeeds at 100, with the cost of 0.6, and fails at
    /// 300.
    pub const MOST_FRICTION: f64 = 100.0;
    /// Torques of mirrored motions are the same up to this part of the largest; places of feet likewise, in
    /// parts of a step or of 1 m if that is more, and limits and weights of both legs in parts of themselves.
    pub const SYMMETRIC: f64 = 1e-8;
    /// How much the torques of mirrored motions of a robot may differ at rates and accelerations of one unit,
    /// relative to its weight times the length of a leg: what one fiftieth of its mass makes that is a leg
    /// away from its mirror image. Published robots differ by 1e-5 (Solo12) to 0.013 (A1).
    pub const UNEVEN: f64 = 0.02;
    /// By how much axes may differ from their mirror images where only masses are said to differ: rad, and
    /// relative to a leg.
    pub const UNEVEN_AXES: f64 = 0.02;
    /// The impulse of a landing in a guess, in parts of that of the weight during the step.
    pub const GUESSED_IMPULSE: f64 = 0.2;
    /// How high the foot that swings is halfway in a guess, in parts of its clearance and of the step.
    pub const GUESSED_HEIGHT: [f64; 2] = [1.5, 0.05];
    /// Positions of a guess that are not found before no more are looked for.
    pub const MOST_NOT_FOUND: usize = 5;
    /// Step in s of rates of guesses.
    pub const NEAR: f64 = 1e-4;
}

/// Limits of what is given at an end.
pub(crate) mod joint_limits {
    /// A state may be beyond a limit by this part of it, or of 1 of its unit if that is more.
    pub const ROUNDING_OF_ENDS: f64 = 1e-9;
}
