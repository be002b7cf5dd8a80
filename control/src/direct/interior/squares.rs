//! Steps without second derivatives of torques and rows.
//!
//! Where the Hessian is not positive definite, what is left of it without these derivatives is the squares of
//! torques and of limits (Gauss and Newton's method for the effort). Steps with it go farther than those of a
//! damped Hessian.

use crate::constants::direct as constants;

/// When such steps are made, and how they are damped.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Squares {
    /// How many more may be made.
    pub left: usize,
    pub damping: f64,
}

impl Squares {
    /// Whether one more may be made.
    pub fn begin(&mut self) -> bool {
        let any = self.left > 0;
        self.left = self.left.saturating_sub(1);
        any
    }

    /// The damping of the next one, from the part that was taken of the longest possible step.
    pub fn adapt(&mut self, damping: f64, taken: f64) {
        self.damping = if taken < constants::POOR {
            (constants::DAMPING_UP * damping).max(constants::LEAST_OF_SQUARES)
        } else if taken > constants::GOOD && damping > constants::NONE_OF_SQUARES {
            constants::DOWN_OF_SQUARES * damping
        } else if taken > constants::GOOD {
            0.0
        } else {
            damping
        };
    }
}
