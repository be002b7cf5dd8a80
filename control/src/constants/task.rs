//! Functions of tools and clearances ([`crate::task`]).

/// Least square of the sine between an axis and the direction that it shall have, beyond a right angle:
/// at opposite the rotation between the two is not unique, and its derivatives are infinite.
pub const OPPOSITE: f64 = 1e-24;

/// Least square of the horizontal part of an axis that has a yaw: the derivatives of that of a vertical one
/// are infinite.
pub const VERTICAL: f64 = 1e-24;
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

/// A rate at a position limit counts where it would cross this part of the range within the time of the
/// motion; the same for accelerations at limits of rates. Less is rounding of what was computed.
pub const AWAY: f64 = 1e-6;
/// Knots of a reference are at least so far apart, in parts of the largest time, and of a second: closer ones
/// differ by the rounding of their times.
pub const CLOSEST_KNOTS: f64 = 1e-9;

/// The search for positions of given poses ([`crate::task::reach`]).
pub mod reach {
    /// A pose is reached to this (m, rad).
    pub const REACHED: f64 = 1e-9;
    /// Positions that the search begins at.
    pub const STARTS: usize = 60;
    /// A position is far from another one if a joint turns by more than this between them (rad)..
    pub const FAR: f64 = 2.0;
    /// .. and then so many others are looked for, one of which may be nearer.
    pub const OTHERS: usize = 12;
    /// Most steps of a descent to another position.
    pub const BRANCH_STEPS: usize = 20;
    /// Positions differ if they do by more than this in a joint (rad).
    pub const APART: f64 = 0.5;
    /// Those that differ by less in all joints are the same (rad, m).
    pub const SAME_POSITION: f64 = 1e-2;
    /// Most positions that are kept: an arm with six joints reaches a pose in 16 ways at most (E. Primrose,
    /// On the input-output equation of the general 7R-mechanism, Mechanism and Machine Theory 21, 1986).
    pub const MOST_BRANCHES: usize = 16;
    /// Descents to positions that are ranked, ten for each of them. One that a share of 1/16 of all descents
    /// leads to is missed with the probability `(15/16)^160 = 3e-5`.
    pub const DESCENTS: usize = 10 * MOST_BRANCHES;
    /// Every other descent begins within this distance of the place before (rad, m), or nearer.
    pub const NEARBY: f64 = 3.0;
    /// Positions count as so much later (s) where what is kept along the motion is exceeded by its range; or
    /// as so many times the cost of the first guess dearer where limits are, beyond what cubics may exceed.
    pub const OUTSIDE: f64 = 100.0;
    /// Positions differ if they do by this where places leave joints free (rad), as nearer ones slide to each
    /// other.
    pub const APART_ALONG: f64 = 1.0;
    /// Steps along what places leave free to a cheaper position (rad, m), the longer ones first. ..
    pub const SLIDES: [f64; 2] = [0.5, 0.2];
    /// .. So many positions are tried at most.
    pub const MOST_SLIDES: usize = 30;
    /// Most steps from each of them.
    pub const STEPS: usize = 60;
    /// First damping, in squares of m or rad per rad.
    pub const DAMPING: f64 = 1e-3;
    /// With more damping than this there is no progress.
    pub const MOST_DAMPING: f64 = 1e6;
    /// Derivatives that are not larger are rounding.
    pub const STILL: f64 = 1e-13;
}
