//! Limits that are exceeded between points by little.

use super::between::BETWEEN;
use super::interior::Interior;
use super::points::PointDynamics;
use super::refine::Resolution;
use crate::constants::direct as constants;

impl Resolution {
    /// Moves limits inside by what they are exceeded between points, in the intervals where that is too much.
    /// Whether this may be enough: equations and bodies that pass through each other need narrower intervals.
    pub fn move_limits_inside<D: PointDynamics>(&self, interior: &mut Interior<D>) -> bool {
        let count = interior.barrier.sides().len();
        let mut most = vec![0.0_f64; self.violations.len()];
        for (k, most) in most.iter_mut().enumerate() {
            for i in 0..count {
                let side = interior.barrier.sides()[i];
                if side.limited.jumps(interior.spline.mesh.shape) || side.is_equation {
                    continue;
                }
                let places =
                    self.distance[count * BETWEEN.len() * k..].chunks_exact(count).take(BETWEEN.len());
                let over = places.map(|distances| side.violation(distances[i])).fold(0.0, f64::max);
                *most = most.max(over);
                if over > constants::MOVED_FROM * constants::VIOLATION_BETWEEN {
                    interior.barrier.move_inside(k, i, constants::MOVED * over * side.range);
                }
            }
        }
        let enough = |(all, moved): (&f64, &f64)| *all <= moved.max(constants::VIOLATION_BETWEEN);
        self.violations.iter().zip(&most).all(enough)
    }
}
