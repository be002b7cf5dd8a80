//! From one mesh to the next.

use super::prepare::most_knots;
use super::refinement::{Judged, Next, Refinement, Solved};
use crate::constants::direct as constants;
use crate::direct::interior::iterate::End;
use crate::direct::motion::spline::Spline;
use crate::result::stage_times::Stage;
use costate::EvalError;

impl Refinement<'_, '_> {
    /// Divides intervals, and takes the motion to the next mesh; or ends the loop where there is none.
    pub(super) fn divide(&mut self, solved: Solved, judged: &Judged) -> Result<Next, EvalError> {
        self.mended.begin_mesh();
        self.precision = (constants::PRECISION * judged.error)
            .clamp(self.least, constants::FIRST_PRECISION.max(self.least));
        let nodes = self.next_nodes(&solved, judged);
        self.left = if solved.unresolved { self.left + 1 } else { 0 };
        let is_last = self.mesh + 1 == constants::MESHES || self.left == constants::UNRESOLVED_MESHES;
        let count = self.interior.spline.mesh.shape.points_of(nodes.len() - 1);
        if count > self.options.max_nodes || is_last {
            if self.comes_back()? {
                return Ok(Next::Iterate);
            }
            if solved.unresolved {
                self.takes_resolved(&solved.resolved)?;
                self.refined.gave_up = is_last;
            }
            return Ok(Next::Done);
        }
        if solved.unresolved {
            self.interior.spline = solved.resolved;
        }
        self.interior.move_to(nodes)?;
        self.interior.clock.lap(Stage::Meshes);
        // What solves a mesh is near a solution on the next one.
        if solved.end == End::Solved {
            self.begins_near();
        }
        self.mesh += 1;
        Ok(Next::Iterate)
    }

    fn next_nodes(&mut self, solved: &Solved, judged: &Judged) -> Vec<f64> {
        let Self { interior, resolution, options, .. } = self;
        let narrowest = resolution.narrowest;
        let nodes = match (judged.violated, judged.accurate) {
            (true, _) if !solved.unresolved => interior.spline.mesh.halved(narrowest),
            // What the estimate does not see, the integration may.
            (false, true) => resolution.nodes_for_torques(&interior.spline, judged.allowed),
            _ => {
                let enough = interior.looseness.between(constants::ENOUGH) * judged.allowed;
                resolution.nodes(&interior.spline, judged.allowed, enough)
            }
        };
        let same = nodes == interior.spline.mesh.nodes;
        let nodes = if same { interior.spline.mesh.halved(narrowest) } else { nodes };
        interior.with_knots(nodes, most_knots(options, interior.spline.mesh.shape), resolution.closest)
    }

    /// Takes an accurate motion again, if there is one.
    pub(super) fn comes_back(&mut self) -> Result<bool, EvalError> {
        let comes_back = self.mended.comes_back(self.interior)?;
        if comes_back {
            self.precision = self.least;
        }
        Ok(comes_back)
    }

    /// Comes back to a motion that its mesh resolved.
    pub(super) fn takes_resolved(&mut self, resolved: &Spline) -> Result<(), EvalError> {
        let Self { interior, resolution, .. } = self;
        interior.spline.clone_from(resolved);
        interior.start(Some(interior.mu))?;
        resolution.measure(interior)?;
        self.refined.error = resolution.error() / interior.figures.size;
        Ok(())
    }

    /// The next iteration begins near a solution.
    pub(super) fn begins_near(&mut self) {
        (self.guess, self.gap) = (self.interior.spline.clone(), constants::WARM);
    }
}
