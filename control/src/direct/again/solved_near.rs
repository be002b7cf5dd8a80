//! A solution as it is solved again.

use super::resolve::Resolve;
use super::resolved::ResolveStatus;
use crate::constants::checks::solved_near::INTERVALS;
use crate::problem::Problem;
use crate::problem::error::ProblemError;
use crate::result::solution::Solution;
use costate::EvalError;

impl Resolve {
    /// The motion of a solution, solved once more on its mesh; where that has no end on equal intervals.
    /// `None` where that has none either.
    pub(crate) fn solved_near<E>(problem: &Problem, solution: &Solution) -> Result<Option<Self>, E>
    where
        E: From<ProblemError> + From<EvalError>,
    {
        let options = solution.options.clone();
        let mut near = Self::near(problem, options.clone(), &solution.trajectory)?;
        if near.solve()?.status == ResolveStatus::Solved {
            return Ok(Some(near));
        }
        let limits = problem.limits.clone().with_from_robot(problem.keeps_robot_limits());
        let points = if problem.first_of_rates().is_some() { 4 } else { 3 };
        let nodes = options.nodes.max(points * INTERVALS + 1);
        let mut even = Self::new(&problem.clone().with_limits(limits), options.with_nodes(nodes))?;
        let is_solved = even.solve()?.status == ResolveStatus::Solved;
        Ok(is_solved.then_some(even))
    }
}
