//! The forces of the constraints of a robot along a motion.

use crate::result::trajectory::Trajectory;
use costate::EvalError;
use costate::constraints::Constraints;
use costate::robot::{ConstraintFrame, ConstraintKind, Robot};
use serde::{Deserialize, Serialize};

/// What holds one constraint along a motion, and how well the motion keeps it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ConstraintForces {
    /// Name of the constraint.
    pub name: String,
    /// The frame that is held: forces act on its link, at its origin. Empty for a coupling.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub frame: String,
    /// The frame that holds it, in whose axes forces and moments are. Empty for a coupling.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub to: String,
    /// Largest `|g(q(t)) - g(q(0))|` of its rows at the nodes (m, rad), in the phases in which it holds: what
    /// the motion drifts from the constraint.
    pub drift: f64,
    /// Its rows that depend on others at the start, from 0 in the order of `multipliers`: they are left out,
    /// and their multipliers are zero.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub redundant: Vec<usize>,
    /// The rows of lambda at each node of the trajectory: forces (N) of rows in m, moments (N m) of rows in
    /// rad. Rows that depend on those before them have none.
    pub multipliers: Vec<Vec<f64>>,
    /// Force on the link of `frame`, at the origin of the constraint in it, in axes of `to` (N), at each
    /// node; empty for a coupling.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub force: Vec<[f64; 3]>,
    /// Moment on it (N m), the same.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moment: Vec<[f64; 3]>,
}

impl ConstraintForces {
    /// Those of all constraints of a robot, from lambda of all rows at the nodes of a motion; `holds` says
    /// which of them hold in a phase, from 0, and `counts` which rows of all do not depend on others.
    /// `moment` gives the moment of a constraint at a node where lambda does not tell it.
    ///
    /// # Errors
    /// A position that cannot be evaluated.
    pub(crate) fn along(
        robot: &Robot,
        motion: &Trajectory,
        lambda: &[Vec<f64>],
        holds: impl Fn(usize, usize) -> bool,
        counts: impl Fn(usize) -> bool,
        moment: impl Fn(usize, usize) -> Option<[f64; 3]>,
    ) -> Result<Vec<Self>, EvalError> {
        let mut rows = Constraints::<f64>::new(robot);
        let name = |at: &ConstraintFrame| robot.frames()[at.frame].name.clone();
        let constraints = robot.constraints();
        let mut all: Vec<Self> = Vec::with_capacity(constraints.len());
        let mut before = 0;
        for constraint in constraints {
            let rows = constraint.kind.rows();
            let redundant = (0..rows).filter(|row| !counts(before + row)).collect();
            before += rows;
            let [frame, to] = match &constraint.kind {
                ConstraintKind::Frames { frame, to, .. } | ConstraintKind::Distance { frame, to, .. } => {
                    [name(frame), name(to)]
                }
                _ => Default::default(),
            };
            all.push(Self { name: constraint.name.clone(), frame, to, redundant, ..Self::default() });
        }
        let mut start = Vec::new();
        let phases = motion.phases().enumerate().flat_map(|(phase, nodes)| nodes.map(move |_| phase));
        for (node, ((q, lambda), phase)) in motion.q.iter().zip(lambda).zip(phases).enumerate() {
            rows.set_position(q)?;
            if start.is_empty() {
                start = rows.values().to_vec();
            }
            let mut first = 0;
            for (number, (forces, constraint)) in all.iter_mut().zip(constraints).enumerate() {
                let own = first..first + constraint.kind.rows();
                first = own.end;
                let pairs =
                    holds(number, phase).then(|| rows.values()[own.clone()].iter().zip(&start[own.clone()]));
                forces.drift = pairs
                    .into_iter()
                    .flatten()
                    .fold(forces.drift, |most, (g, start)| most.max((g - start).abs()));
                forces.multipliers.push(lambda[own].to_vec());
                if let Some((force, told)) = rows.wrench(number, lambda) {
                    forces.force.push(force);
                    forces.moment.push(moment(number, node).unwrap_or(told));
                }
            }
        }
        Ok(all)
    }
}
