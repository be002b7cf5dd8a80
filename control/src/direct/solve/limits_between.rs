//! What a refinement does about limits that an accurate motion exceeds between its points.

use super::refinement::{Judged, Refinement};
use crate::constants::direct as constants;
use crate::direct::refine::move_inside::Inside;
use crate::result::stage_times::Stage;
use costate::EvalError;

impl Refinement<'_, '_> {
    /// Limits coefficients of what an accurate motion exceeds beside a jump, if it does.
    pub(super) fn limits_coefficients(&mut self, judged: &Judged) -> bool {
        let limits = judged.is_solved
            && judged.accurate
            && self.mended.wants_hulls(&judged.beyond)
            && self.resolution.take_hulls(self.interior, false);
        if limits {
            self.keeps();
            self.goes_on_inside();
        }
        limits
    }

    /// Which limits move inside.
    pub(super) fn moves(&mut self, judged: &Judged) -> Option<Inside> {
        // Where accelerations are continuous only limits of jerks and of rates of torques move.
        let smooth = self.interior.spline.mesh.shape.is_smooth();
        let can_move = !smooth || judged.beyond.violation <= constants::VIOLATION_BETWEEN;
        let moves = judged.is_solved && can_move;
        moves.then(|| self.mended.moves_limits(&judged.beyond, self.options.tolerance)).flatten()
    }

    /// Takes an accurate motion to a finer mesh for what it exceeds between its points, if that may help.
    pub(super) fn moves_to_finer(&mut self, judged: &Judged) -> Result<bool, EvalError> {
        if !(judged.is_solved && judged.accurate && self.mesh + 1 < constants::MESHES) {
            return Ok(false);
        }
        let Self { interior, resolution, mended, options, .. } = self;
        let most = (options.max_nodes - 1) / interior.spline.mesh.shape.stride() + 1;
        let of = (&mut **resolution, &interior.spline);
        let Some(nodes) = mended.finer(&judged.beyond, of, judged.allowed, most) else { return Ok(false) };
        interior.move_to(nodes)?;
        interior.clock.lap(Stage::Meshes);
        self.begins_near();
        self.precision = self.least;
        self.mesh += 1;
        Ok(true)
    }

    /// Keeps the accurate motion in case that what is done about its limits leads to none.
    pub(super) fn keeps(&mut self) {
        self.mended.keep(&self.interior.spline);
        self.mended.begin_mesh();
    }

    /// Goes on after limits were moved inside.
    pub(super) fn goes_on_inside(&mut self) {
        self.precision = self.least;
        self.interior.begin_inside();
    }
}
