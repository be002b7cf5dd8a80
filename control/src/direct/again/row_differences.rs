//! Differences of the rows of a motion by a number: they are built anew for problems with other values of it.

use crate::constants::differences as constants;
use crate::problem::Problem;
use crate::task::build::TaskRows;
use costate::EvalError;

/// At which values of a number rows are built, and what each counts in the derivative.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowDifference {
    step: f64,
    /// How many steps away, and the factor over the step.
    terms: &'static [[f64; 2]],
}

impl RowDifference {
    /// By what displaces links (m, rad).
    pub fn by_displacement() -> Self {
        Self { step: constants::DISPLACEMENT, terms: &constants::FOURTH_ORDER }
    }

    /// By a number with this value that is never negative.
    pub fn above(value: f64) -> Self {
        let step = constants::PART_OF_NUMBER * value.max(constants::SMALLEST_NUMBER);
        Self { step, terms: &constants::SECOND_ORDER_ABOVE }
    }

    /// Hands over the rows of the problem with other values of the number, each with its factor in the
    /// derivative. `change` makes the number larger by so much than it is in the problem that is given;
    /// `take` says whether the rows are as many as those of the problem.
    ///
    /// # Errors
    /// Those of `change` and `take`; what `refused` makes of a change, and why, where there are no rows or
    /// others.
    pub fn take_rows<E: From<EvalError>>(
        self,
        mut problem: Problem,
        mut change: impl FnMut(&mut Problem, f64) -> Result<(), E>,
        refused: impl Fn(f64, String) -> E,
        mut take: impl FnMut(&Problem, TaskRows, f64) -> Result<bool, EvalError>,
    ) -> Result<(), E> {
        for &[steps, factor] in self.terms {
            let by = steps * self.step;
            change(&mut problem, by)?;
            let rows = TaskRows::new(&problem).map_err(|error| refused(by, error.to_string()))?;
            if !take(&problem, rows, factor / self.step)? {
                return Err(refused(by, "other bodies are near each other".into()));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::RowDifference;
    use crate::problem::{Collision, Obstacle, Problem, Shape, Task};
    use costate::EvalError;
    use costate_test_support::robots::file;
    use std::cell::Cell;

    fn problem() -> Problem {
        let disc = Obstacle::new("disc", Shape::Sphere { centre: [0.0, 3.0, 0.0], radius: 0.5 });
        let task = Task::default().with_obstacle(disc).with_collision(Collision::along_links(0.1));
        Problem::rest_to_rest(file("two_link.toml"), &[0.0, 0.0], &[1.0, 0.5], 1.0).with_task(task)
    }

    /// The derivative of a polynomial of the displacement, to the order of the difference.
    #[test]
    fn differences_are_exact_for_polynomials_of_their_order() {
        for (difference, order) in [(RowDifference::by_displacement(), 4), (RowDifference::above(2.0), 2)] {
            for power in 0..=order {
                let mut slope = 0.0;
                let displaced = Cell::new(0.0);
                let change = |_: &mut Problem, by: f64| {
                    displaced.set(by);
                    Ok::<_, EvalError>(())
                };
                let refused = |_: f64, cause: String| panic!("{cause}");
                let take = |_: &Problem, _, factor: f64| {
                    slope += factor * (2.0_f64 + displaced.get()).powi(power);
                    Ok(true)
                };
                difference.take_rows(problem(), change, refused, take).unwrap();
                let expected = f64::from(power) * 2.0_f64.powi(power - 1);
                assert!((slope - expected).abs() < 1e-9, "order {power}: {slope}, not {expected}");
            }
        }
    }

    #[test]
    fn rows_that_are_others_are_refused_with_the_change() {
        #[derive(Debug)]
        struct Refused(f64, String);
        impl From<EvalError> for Refused {
            fn from(error: EvalError) -> Self {
                Self(f64::NAN, error.to_string())
            }
        }
        let found = RowDifference::by_displacement().take_rows(
            problem(),
            |_, _| Ok(()),
            Refused,
            |_, _, _| Ok(false),
        );
        let Refused(by, cause) = found.unwrap_err();
        assert_eq!((by, cause.as_str()), (-2e-3, "other bodies are near each other"));
    }
}
