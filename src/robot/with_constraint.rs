//! Robots whose loops are closed by constraints.

use super::checks;
use super::constraint::{
    Constraint, ConstraintFrame, ConstraintKind, ConstraintRow, ConstraintSpec, Described, Held,
};
use super::error::RobotError;
use super::frame_list::FrameList;
use super::model::Robot;
use super::range::is_moderate;
use std::collections::{HashMap, HashSet};

impl Robot {
    /// The constraints, in the order in which they were added.
    pub fn constraints(&self) -> &[Constraint] {
        &self.constraints
    }

    /// The open tree: the same robot without constraints.
    pub fn without_constraints(&self) -> Self {
        Self { constraints: Vec::new(), ..self.clone() }
    }

    /// The same robot with one more constraint.
    ///
    /// [`ConstrainedHamiltonian`](crate::constraints::ConstrainedHamiltonian) computes its dynamics.
    /// Computations that would ignore a constraint refuse such a robot
    /// ([`EvalError::Constrained`](crate::EvalError::Constrained)); kinematics, whose results do not depend
    /// on constraints, take it.
    ///
    /// ```
    /// use costate::robot::{ConstraintRow, ConstraintSpec, Placement, Robot};
    ///
    /// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
    /// let arm = Robot::from_file("robots/two_link.toml")?;
    /// // The tip slides on a wall at x = 1.2 m.
    /// let tip = Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.0; 3]);
    /// let wall = Placement::from_xyz_rpy([1.2, 0.0, 0.0], [0.0; 3]);
    /// let on_wall = ConstraintSpec::rows("wall", "elbow", "world", &[ConstraintRow::X]);
    /// let sliding = arm.with_constraint(on_wall.placed(tip).to_placed(wall))?;
    /// assert_eq!(sliding.constraints()[0].name, "wall");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`RobotError::BadName`] or [`RobotError::DuplicateName`]; [`RobotError::UnknownFrame`];
    /// [`RobotError::UnknownJoint`] and [`RobotError::StillJoint`] for the joints of a coupling;
    /// [`RobotError::BadConstraint`] for what cannot be held; [`RobotError::FreeJoint`] for a coupling of a
    /// floating or spherical joint.
    pub fn with_constraint(&self, spec: ConstraintSpec) -> Result<Self, RobotError> {
        self.clone().with_constraints(std::iter::once(spec)).map_err(|(_, error)| error)
    }

    /// The same robot with these constraints, too.
    ///
    /// # Errors
    /// As [`with_constraint`](Self::with_constraint), with the position of the constraint.
    pub(super) fn with_constraints(
        mut self,
        specs: impl Iterator<Item = ConstraintSpec>,
    ) -> Result<Self, (usize, RobotError)> {
        let frames = FrameList::from(self.frames.clone());
        let mut taken: HashSet<String> = self.constraints.iter().map(|one| one.name.clone()).collect();
        let joints = self.joints.iter().enumerate().map(|(i, joint)| (joint.name.clone(), i));
        let joints: HashMap<String, usize> = joints.collect();
        for (k, spec) in specs.enumerate() {
            let constraint = self.constraint(spec, &frames, &joints).map_err(|error| (k, error))?;
            if !taken.insert(constraint.name.clone()) {
                return Err((k, RobotError::DuplicateName { kind: "constraint", name: constraint.name }));
            }
            self.constraints.push(constraint);
        }
        Ok(self)
    }

    fn constraint(
        &self,
        spec: ConstraintSpec,
        frames: &FrameList,
        joints: &HashMap<String, usize>,
    ) -> Result<Constraint, RobotError> {
        let ConstraintSpec { name, held, frame, to } = spec;
        checks::name("constraint", &name)?;
        let bad = |problem| RobotError::BadConstraint { constraint: name.clone(), problem };
        let kind = match held {
            Held::Rows(rows) => {
                let both = [seat(frames, &frame)?, seat(frames, &to)?];
                let [frame, to] = self.two_links(both).map_err(bad)?;
                ConstraintKind::Frames { frame, to, rows: in_order(rows).map_err(bad)? }
            }
            Held::Distance(length) => {
                let both = [seat(frames, &frame)?, seat(frames, &to)?];
                let [frame, to] = self.two_links(both).map_err(bad)?;
                if !(is_moderate(length) && length > 0.0) {
                    return Err(bad(
                        "its length must be positive and finite; pin the points to each other for 0",
                    ));
                }
                ConstraintKind::Distance { frame, to, length }
            }
            Held::Coupling(terms, constant) => {
                let finite = terms.iter().all(|&(_, factor)| is_moderate(factor) && factor != 0.0);
                if !(finite && is_moderate(constant)) {
                    return Err(bad("factors and constant must be finite, and no factor zero"));
                }
                let index = |joint: &String| match joints.get(joint) {
                    Some(&index) => Ok(index),
                    None => self.joint_index(joint),
                };
                let found = terms.iter().map(|(joint, factor)| Ok((index(joint)?, *factor)));
                let terms = found.collect::<Result<Vec<_>, RobotError>>()?;
                self.plain_joints(&terms)?;
                if terms.is_empty() {
                    return Err(bad("it couples no joint; name at least one, with a factor"));
                }
                ConstraintKind::Coupling { terms, constant }
            }
        };
        Ok(Constraint { name, kind })
    }

    /// None of these joints is part of a floating or spherical one, whose orientation is no sum of angles.
    fn plain_joints(&self, terms: &[(usize, f64)]) -> Result<(), RobotError> {
        match terms.iter().find_map(|&(joint, _)| self.joints[joint].free.as_ref()) {
            None => Ok(()),
            Some(part) => {
                let (joint, kind) = (part.joint.clone(), part.kind.name());
                Err(RobotError::FreeJoint { joint, kind, what: "be coupled to other joints" })
            }
        }
    }

    /// Frames of two different links, or of a link and the world.
    fn two_links(&self, both: [ConstraintFrame; 2]) -> Result<[ConstraintFrame; 2], &'static str> {
        match both.map(|seat| self.frames[seat.frame].joint) {
            [first, second] if first == second => {
                Err("both of its frames are fixed to one link, or to the world; choose frames of two links")
            }
            _ => Ok(both),
        }
    }
}

fn seat(frames: &FrameList, described: &Described) -> Result<ConstraintFrame, RobotError> {
    let Described { name, placement } = described;
    let frame = frames.position(name)?;
    if !placement.is_rigid() {
        return Err(RobotError::BadFramePlacement { frame: name.clone() });
    }
    Ok(ConstraintFrame { frame, placement: placement.orthonormalised() })
}

/// Rows in the order of [`ConstraintRow::ALL`], each once.
fn in_order(mut rows: Vec<ConstraintRow>) -> Result<Vec<ConstraintRow>, &'static str> {
    let given = rows.len();
    rows.sort_unstable();
    rows.dedup();
    match rows.len() {
        0 => Err("it has no rows; name at least one of x, y, z, turn_x, turn_y, turn_z"),
        kept if kept < given => Err("a row is named twice; name each once"),
        _ => Ok(rows),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{JointSpec, LinkInertia, Placement};

    fn arm() -> Robot {
        let body = LinkInertia::point(1.0, [0.1, 0.0, 0.0]);
        Robot::builder("arm")
            .joint(JointSpec::revolute("a").carrying(body))
            .joint(JointSpec::revolute("b").on("a").carrying(body))
            .joint(JointSpec::prismatic("c").on("b").carrying(body))
            .build()
            .unwrap()
    }

    #[test]
    fn what_cannot_be_held_is_named() {
        let says = |spec: ConstraintSpec, words: &str| {
            let error = arm().with_constraint(spec).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        };
        says(ConstraintSpec::pinned("loop", "d", "world"), "'d'");
        says(ConstraintSpec::pinned("", "a", "world"), "constraint");
        says(ConstraintSpec::pinned("loop", "a", "a"), "'loop'");
        says(ConstraintSpec::rows("loop", "a", "world", &[]), "no rows");
        says(ConstraintSpec::rows("loop", "a", "world", &[ConstraintRow::X; 2]), "twice");
        says(ConstraintSpec::distance("rod", "a", "world", -1.0), "positive");
        says(ConstraintSpec::coupling("gear", &[("a", 0.0)], 0.0), "zero");
        says(ConstraintSpec::coupling("gear", &[], 0.0), "no joint");
        says(ConstraintSpec::coupling("gear", &[("z", 1.0)], 0.0), "'z'");
        let bad =
            Placement { translation: nalgebra::Vector3::new(f64::NAN, 0.0, 0.0), ..Placement::identity() };
        says(ConstraintSpec::pinned("loop", "a", "world").placed(bad), "placement");
        let closed = arm().with_constraint(ConstraintSpec::pinned("loop", "c", "world")).unwrap();
        let error = closed.with_constraint(ConstraintSpec::pinned("loop", "b", "world")).unwrap_err();
        assert!(error.to_string().contains("two constraints are called 'loop'"), "{error}");
    }

    #[test]
    fn constraints_stay_at_their_frames_when_joints_are_locked() {
        let gear = ConstraintSpec::coupling("gear", &[("a", 1.0), ("b", 2.0), ("c", -1.0)], 0.5);
        let closed = arm().with_constraint(ConstraintSpec::pinned("loop", "c", "world")).unwrap();
        let locked = closed.with_constraint(gear).unwrap().lock(&[("b", 0.3)]).unwrap();
        let [first, second] = locked.constraints() else { panic!("two constraints") };
        let ConstraintKind::Frames { frame, to, rows } = &first.kind else { panic!("{first:?}") };
        let names = [frame, to].map(|seat| locked.frames()[seat.frame].name.as_str());
        assert_eq!((names, rows.len()), (["c", "world"], 3));
        let ConstraintKind::Coupling { terms, constant } = &second.kind else { panic!("{second:?}") };
        assert_eq!(terms, &[(0, 1.0), (1, -1.0)]);
        assert!((constant - (0.5 - 2.0 * 0.3)).abs() < 1e-15);
        assert!(locked.without_constraints().constraints().is_empty());
    }
}
