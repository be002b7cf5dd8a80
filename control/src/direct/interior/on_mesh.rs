//! The program of a motion on its mesh with its solver, and its multipliers beside those of the barrier.

use crate::constants::direct as constants;
use crate::direct::limits::barrier::Barrier;
use crate::direct::program::staged::Work;
use crate::direct::program::structure::{Row, Structure};
use costate_nlp::Solver;

/// Slacks are at least this part of the range.
const LEAST_ROOM: f64 = 1e-12;

/// The program of a motion on its mesh, with its solver.
pub(in crate::direct) struct OnMesh {
    pub structure: Structure,
    pub work: Work,
    pub solver: Solver,
    /// Where the solution begins, and its multipliers of the equations and of the ranges.
    pub start: Vec<f64>,
    pub multipliers: [Vec<f64>; 2],
    /// Number of bounds, at least 1.
    pub bounds: f64,
}

impl OnMesh {
    /// Sets the multipliers of the rows to those of the entries of the barrier.
    pub fn take_multipliers(&mut self, barrier: &Barrier) {
        let Self { structure, multipliers, .. } = self;
        for (to, rows) in multipliers.iter_mut().zip([structure.equalities(), structure.ranges()]) {
            to.clear();
            to.extend(rows.iter().map(|row| row.multiplier(barrier)));
        }
    }

    /// Gives the entries of the barrier the multipliers of the last iterate, whose barrier has this mu, and
    /// the slacks that go with them.
    pub fn set_multipliers(&mut self, barrier: &mut Barrier, mu: f64) {
        let (solution, structure) = (self.solver.solution(), &self.structure);
        for (row, y) in structure.equalities().iter().zip(solution.equalities) {
            barrier.multiplier[row.entry] = -row.sign * y;
        }
        for (row, v) in structure.ranges().iter().zip(solution.ranges) {
            set_sides(barrier, row, *v, mu);
        }
    }
}

/// Gives both sides of a limit the slacks that their distances leave, at least where the multiplier v of
/// their row is on the central path, and multipliers with this difference; those of the central path where v
/// is zero, or that of a side that does not exist.
fn set_sides(barrier: &mut Barrier, row: &Row, v: f64, mu: f64) {
    let sides = [(Some(row.entry), -row.sign * v), (row.other, row.sign * v)];
    let mut central = [0.0; 2];
    for ((at, own), central) in sides.into_iter().zip(&mut central) {
        let Some(at) = at else { continue };
        let range = 1.0 / barrier.unit[at];
        let least = (mu / own.max(f64::MIN_POSITIVE)).min(constants::FIRST_SLACK * range);
        barrier.slack[at] = barrier.distance[at].max(least).max(LEAST_ROOM * range);
        *central = mu / barrier.slack[at];
    }
    for (side, (at, own)) in sides.into_iter().enumerate() {
        let Some(at) = at else { continue };
        let is_alone = sides[1 - side].0.is_none();
        barrier.multiplier[at] = match own > 0.0 {
            true if is_alone => own,
            true => own + central[1 - side],
            false => central[side],
        };
    }
}

#[cfg(test)]
mod tests {
    use super::set_sides;
    use crate::direct::interior::iterate::tests::started;
    use crate::direct::motion::shape::Shape;
    use crate::direct::program::structure::Structure;

    #[test]
    fn multipliers_of_rows_are_those_of_their_sides() {
        let mut interior = started(Shape::Quintic);
        let structure = Structure::new(&interior.spline, &interior.barrier, &interior.ends, (0, 1.0));
        let barrier = &mut interior.barrier;
        for (i, row) in structure.ranges().iter().enumerate() {
            // Of a lone side the one that it can have.
            let v = [0.7, 1e-9, -0.3][i % 3];
            let v = if row.other.is_some() { v } else { -row.sign * f64::abs(v) };
            set_sides(barrier, row, v, 1e-6);
            assert!(
                (row.multiplier(barrier) / v - 1.0).abs() < 1e-6,
                "{row:?} {v} {}",
                row.multiplier(barrier)
            );
            for at in [Some(row.entry), row.other].into_iter().flatten() {
                let is_inside = barrier.slack[at] > 0.0 && barrier.slack[at] >= barrier.distance[at];
                assert!(is_inside && barrier.multiplier[at] > 0.0, "{row:?}");
            }
        }
        assert!(structure.ranges().iter().any(|row| row.other.is_some()));
        assert!(structure.ranges().iter().any(|row| row.other.is_none()));
    }
}
