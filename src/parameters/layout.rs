//! Where the derivatives by each parameter come from.

use super::friction::{ByParameter, FrictionEntry, friction_by};
use super::parameter::{Axis, DisplacedIn, Inertial, Parameter};
use super::set::ParameterSet;
use crate::error::EvalError;
use crate::hamiltonian::check;
use crate::robot::{JointKind, Placement, Row, Site, StillJoint, Tree, WithStillJoints, scaled};
use crate::scalar::Scalar;
use nalgebra::Vector3;

/// A unit body for each of its ten inertial parameters, fixed to the link of a joint.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub joint: usize,
    /// Its frame in that of the joint in the [`Tree`].
    pub frame: Placement,
    /// The column of each of the ten parameters that is in the set.
    pub columns: [Option<usize>; 10],
}

/// The source of a column of L_z,theta that is not of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    /// A displacement: this still joint of the extended tree.
    Still(usize),
    /// A component of gravity: the still joint between world and base in its direction, of which the weight
    /// of everything is the power.
    Gravity(usize),
    Stiffness(usize),
    Rest(usize),
    Armature(usize, usize),
}

/// The constants of a set of parameters.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub tree: Tree,
    /// The same tree with a still joint for each geometric parameter and component of gravity.
    pub extended: Tree,
    /// The number of each coordinate in the extended tree.
    pub kept: Vec<usize>,
    /// The coordinates of the joints.
    pub rows: Vec<Row>,
    /// The frame of each joint in the tree.
    joint_frames: Vec<Option<usize>>,
    /// Number of parameters.
    pub len: usize,
    pub bodies: Vec<Body>,
    /// Column and source.
    pub sources: Vec<(usize, Source)>,
    /// Column, joint and entry.
    friction: Vec<(usize, usize, FrictionEntry)>,
    /// Column of each component of gravity in the set, and the extended tree without springs in a unit field
    /// of gravity in its direction.
    pub fields: Vec<(usize, Tree)>,
}

impl Layout {
    pub fn new(set: &ParameterSet) -> Self {
        let robot = set.robot();
        let (columns, added): (Vec<usize>, Vec<StillJoint>) =
            set.parameters().iter().enumerate().filter_map(|(k, one)| Some((k, still_joint(one)?))).unzip();
        let WithStillJoints { robot: extended, kept, still } = robot.with_still_joints(&added);
        let tree = Tree::from(robot);
        let mut layout = Self {
            rows: tree.rows(),
            joint_frames: (0..robot.joints().len()).map(|i| robot.frame_of_joint(i)).collect(),
            tree,
            extended: Tree::from(&extended),
            kept,
            len: set.len(),
            bodies: Vec::new(),
            sources: Vec::new(),
            friction: Vec::new(),
            fields: Vec::new(),
        };
        for (column, (&at, one)) in columns.into_iter().zip(still.iter().zip(&added)) {
            let is_gravity = one.site == Site::World;
            if is_gravity {
                layout.fields.push((column, Tree::from(&extended.in_field(one.axis))));
            }
            let source = if is_gravity { Source::Gravity(at) } else { Source::Still(at) };
            layout.sources.push((column, source));
        }
        for (column, parameter) in set.parameters().iter().enumerate() {
            layout.add(column, parameter);
        }
        layout
    }

    /// Number of degrees of freedom, n.
    pub fn dof(&self) -> usize {
        self.tree.dof()
    }

    /// Every argument has n finite entries.
    pub fn check<S: Scalar>(&self, arguments: &[(&'static str, &[S])]) -> Result<(), EvalError> {
        let n = self.dof();
        arguments.iter().try_for_each(|&(what, values)| check(&self.tree, what, values, n))
    }

    /// The columns of friction with their coordinates, `D_theta` and `D_v,theta`: of a joint with v_j = g v,
    /// g and g^2 times those of its law.
    pub fn friction_columns<S: Scalar>(
        &self,
        v: &[S],
    ) -> impl Iterator<Item = (usize, usize, ByParameter<S>)> {
        self.friction.iter().map(|&(column, joint, entry)| {
            let Row { coordinate, ratio, .. } = self.rows[joint];
            let law = &self.tree.joints()[joint].friction;
            let ByParameter { value, slope } = friction_by(entry, law, self.rows[joint].rate(v));
            let by = ByParameter { value: scaled(ratio, value), slope: scaled(ratio * ratio, slope) };
            (column, coordinate, by)
        })
    }

    /// Whether a parameter needs the extended tree.
    pub fn is_extended(&self) -> bool {
        self.extended.dof() > self.tree.dof()
    }

    /// Adds a parameter that needs no still joint.
    fn add(&mut self, column: usize, parameter: &Parameter) {
        match *parameter {
            Parameter::Link { joint, entry } => {
                let frame = self.joint_frame(joint);
                self.add_inertial(column, joint, frame, entry);
            }
            Parameter::Payload { joint, placement, entry } => {
                let frame = self.joint_frame(joint).then(&placement);
                self.add_inertial(column, joint, frame, entry);
            }
            Parameter::Stiffness { joint } => self.sources.push((column, Source::Stiffness(joint))),
            Parameter::Rest { joint } => self.sources.push((column, Source::Rest(joint))),
            Parameter::Armature { joints: [i, j] } => self.sources.push((column, Source::Armature(i, j))),
            Parameter::Viscous { joint } => self.friction.push((column, joint, FrictionEntry::Viscous)),
            Parameter::Coulomb { joint } => self.friction.push((column, joint, FrictionEntry::Coulomb)),
            Parameter::CoulombVelocity { joint } => {
                self.friction.push((column, joint, FrictionEntry::CoulombVelocity));
            }
            Parameter::Translation { .. }
            | Parameter::Rotation { .. }
            | Parameter::Displacement { .. }
            | Parameter::Gravity { .. } => {}
        }
    }

    /// The frame of joint `i` of the robot in that of the tree.
    fn joint_frame(&self, i: usize) -> Placement {
        // Parts inside of a floating or spherical joint have none, and no evaluation takes such joints.
        self.joint_frames[i].map_or(Placement::identity(), |frame| self.tree.frames()[frame].placement)
    }

    /// Adds an entry of a body; consecutive entries of one frame are one body.
    fn add_inertial(&mut self, column: usize, joint: usize, frame: Placement, entry: Inertial) {
        let goes_on = self.bodies.last().is_some_and(|body| {
            body.joint == joint && body.frame == frame && body.columns[entry as usize].is_none()
        });
        if !goes_on {
            self.bodies.push(Body { joint, frame, columns: [None; 10] });
        }
        if let Some(body) = self.bodies.last_mut() {
            body.columns[entry as usize] = Some(column);
        }
    }
}

/// The still joint of a geometric parameter or of a component of gravity.
fn still_joint(parameter: &Parameter) -> Option<StillJoint> {
    let unit = |axis: Axis| Vector3::from(axis.unit());
    Some(match *parameter {
        Parameter::Translation { joint, axis } => {
            StillJoint { site: Site::Parent(joint), kind: JointKind::Prismatic, axis: unit(axis) }
        }
        Parameter::Rotation { joint, axis } => {
            StillJoint { site: Site::Joint(joint), kind: JointKind::Revolute, axis: unit(axis) }
        }
        Parameter::Displacement { joint, displacement } => {
            let site = match displacement.frame {
                DisplacedIn::Parent => Site::Parent(joint),
                DisplacedIn::Joint => Site::Joint(joint),
            };
            StillJoint { site, kind: displacement.kind, axis: Vector3::from(displacement.axis).normalize() }
        }
        Parameter::Gravity { axis } => {
            StillJoint { site: Site::World, kind: JointKind::Prismatic, axis: unit(axis) }
        }
        _ => return None,
    })
}
