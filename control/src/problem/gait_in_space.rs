//! What gaits of robots in space have beside those in the plane.

use super::error::ProblemError;
use super::gait::Gait;
use super::gait_error::GaitError;
use super::key::Key;
use super::loop_rows::{Foot, LoopRow};

impl Gait {
    /// Whether it is one of a robot in space.
    pub(crate) fn is_in_space(&self) -> bool {
        !self.flipped.is_empty()
    }

    /// Whether the widths of a gait in space make sense, and one in the plane has none.
    ///
    /// # Errors
    /// [`ProblemError::Gait`] with the key and the value.
    pub(super) fn check_widths(&self) -> Result<(), ProblemError> {
        let out = |key: Key, value: f64, remedy| Err(GaitError::OutOfRange { value, remedy }.at(key));
        let (space, has_sole) = (self.is_in_space(), self.sole.is_some());
        if space && !(self.width >= 0.0 && self.width.is_finite()) {
            return out(Key::GAIT_WIDTH, self.width, "must be neither negative nor infinite (m)");
        }
        if space && has_sole {
            return match self.sole_width > 0.0 && self.sole_width.is_finite() {
                true => Ok(()),
                false => {
                    let remedy = "soles in space need their width (m), which must be positive and finite";
                    out(Key::GAIT_SOLE_WIDTH, self.sole_width, remedy)
                }
            };
        }
        let width = (Key::GAIT_WIDTH, if space { 0.0 } else { self.width });
        let of_no_use = [width, (Key::GAIT_SOLE_WIDTH, self.sole_width)];
        match of_no_use.into_iter().find(|(_, value)| *value != 0.0) {
            Some((key, value)) if space => out(key, value, "must not be given without gait.sole"),
            Some((key, value)) => Err(GaitError::WidthInPlane { value }.at(key)),
            None => Ok(()),
        }
    }

    /// Accelerations of the multipliers of feet in space that bear so much each (N), soles in their middle or
    /// on their edge.
    pub(super) fn lift_in_space(&self, weight: f64, feet: &[Foot], rows: &[LoopRow]) -> Vec<f64> {
        let pressed = self.sole.map_or(0.0, |[heel, toe]| -0.5 * (heel + toe) * weight);
        let wrench = [0.0, 0.0, weight, 0.0, pressed, 0.0];
        let loads = |foot: &Foot| match self.is_on_edge(foot.contact) {
            true => self.load_of_edge(weight).to_vec(),
            false => wrench[..foot.rows.len()].to_vec(),
        };
        feet.iter().flat_map(loads).zip(rows).map(|(load, row)| load / row.mass).collect()
    }
}
