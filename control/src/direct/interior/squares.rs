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

/// Steps that promise too little to go on, while the squares promise more.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stall {
    /// The step at which they were looked at last, and the cost then.
    last: Option<(usize, f64)>,
}

impl Stall {
    /// Whether as many steps as are made between two [looks](constants::LOOK) gain no more than `least`.
    pub fn is_over(&mut self, iterations: usize, cost: f64, least: f64) -> bool {
        let (before, at_most) = *self.last.get_or_insert((iterations, cost));
        if iterations < before + constants::LOOK {
            return false;
        }
        self.last = Some((iterations, cost));
        at_most - cost <= least
    }
}

#[cfg(test)]
mod tests {
    use super::{Stall, constants};

    #[test]
    fn steps_go_on_while_several_of_them_gain_enough() {
        let (mut stall, least) = (Stall::default(), 1e-5);
        let mut steps = |from: usize, gain: f64| {
            let mut steps = from..from + 5 * constants::LOOK;
            steps.find(|&step| stall.is_over(step, 1.0 - gain * (step - from) as f64, least))
        };
        assert_eq!(steps(0, 2.0 * least), None);
        let from = 5 * constants::LOOK;
        assert!(steps(from, 1e-3 * least).is_some_and(|step| step <= from + 2 * constants::LOOK));
    }
}
