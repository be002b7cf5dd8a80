//! The most accurate motion that a refinement has solved: what it ends with where later meshes fail.

use crate::direct::interior::snapshot::Snapshot;

/// A motion that is solved on its mesh and keeps its limits at the points there.
pub(super) struct LastSolved {
    pub snapshot: Snapshot,
    /// Estimated error of the cost, relative to it.
    pub error: f64,
    /// Whether limits are kept between the points too.
    pub keeps_limits: bool,
    /// Whether it was as accurate as it was asked for, so that nothing but its verification failed.
    pub accurate: bool,
}

impl LastSolved {
    /// The larger one is the better one: whether it keeps its limits between the points, then its accuracy.
    pub fn rank(&self) -> (bool, f64) {
        (self.keeps_limits, -self.error)
    }
}
