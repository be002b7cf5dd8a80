//! Sets of parameters of a robot.

use super::error::ParameterError;
use super::parameter::{Axis, Displacement, Inertial, Parameter};
use super::value::value_of;
use crate::robot::parameters::{Group, groups};
use crate::robot::{Robot, RobotError};
use nalgebra::Vector3;

/// Parameters of a robot, in the order of the columns of all derivatives by them.
///
/// ```
/// use costate::parameters::ParameterSet;
/// use costate::robot::{FrameSpec, Placement, Robot};
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let identified = ParameterSet::new(&robot).links().friction().armature();
/// assert_eq!(identified.names()[..2], ["shoulder.mass", "shoulder.h_x"]);
/// let tip = Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.0; 3]);
/// let robot = robot.with_frame(FrameSpec::new("tip").on("elbow").placed(tip))?;
/// let design = ParameterSet::new(&robot).named("elbow.x")?.payload("tool", "tip")?;
/// assert_eq!((design.len(), design.values()[0]), (11, 1.0));
/// let error = ParameterSet::new(&robot).named("elbow.mas").unwrap_err();
/// assert!(error.to_string().contains("did you mean 'elbow.mass'?"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Names are those of [`parameter_names`](crate::codegen::parameter_names) where it has them. A parameter
/// that a method would add for a second time is left out.
#[derive(Clone, Debug, PartialEq)]
#[must_use = "a set does nothing until it is given to a workspace"]
pub struct ParameterSet {
    robot: Robot,
    parameters: Vec<Parameter>,
    names: Vec<String>,
    values: Vec<f64>,
}

impl ParameterSet {
    /// An empty set.
    pub fn new(robot: &Robot) -> Self {
        Self { robot: robot.clone(), parameters: Vec::new(), names: Vec::new(), values: Vec::new() }
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The same parameters of another robot with these joints, such as one that carries something else; their
    /// values are those in it. `None` where joints differ in number, name, kind or parent.
    pub fn of_robot(&self, robot: &Robot) -> Option<Self> {
        let joints = || self.robot.joints().iter().zip(robot.joints());
        let same = self.robot.joints().len() == robot.joints().len()
            && joints().all(|(a, b)| (&a.name, a.kind, a.parent) == (&b.name, b.kind, b.parent));
        same.then(|| Self {
            robot: robot.clone(),
            values: self.parameters.iter().map(|parameter| value_of(robot, parameter)).collect(),
            ..self.clone()
        })
    }

    /// Number of parameters.
    pub fn len(&self) -> usize {
        self.parameters.len()
    }

    /// Whether it has no parameter.
    pub fn is_empty(&self) -> bool {
        self.parameters.is_empty()
    }

    /// The parameters.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Their names, such as `elbow.mass`.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Their values in the model; 0 for displacements, rotations and payloads, which add to the model.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Adds mass, first moment and inertia of every link: ten parameters for each joint.
    pub fn links(self) -> Self {
        let all = |joint| Inertial::ALL.map(|entry| Parameter::Link { joint, entry });
        self.of_joints(all)
    }

    /// Adds mass, first moment and inertia of the link of a joint.
    ///
    /// # Errors
    /// [`RobotError::UnknownJoint`] as [`ParameterError::Robot`].
    pub fn link(self, joint: &str) -> Result<Self, ParameterError> {
        let joint = self.robot.joint_index(joint)?;
        let entries = Inertial::ALL.map(|entry| Parameter::Link { joint, entry });
        Ok(entries.into_iter().fold(self, Self::with))
    }

    /// Adds the translations of the placements of all joints: three parameters for each.
    pub fn translations(self) -> Self {
        self.of_joints(|joint| Axis::ALL.map(|axis| Parameter::Translation { joint, axis }))
    }

    /// Adds the rotations of the placements of all joints: three parameters for each.
    pub fn rotations(self) -> Self {
        self.of_joints(|joint| Axis::ALL.map(|axis| Parameter::Rotation { joint, axis }))
    }

    /// Adds viscous friction and Coulomb limit of all joints, also of those without friction.
    pub fn friction(self) -> Self {
        self.of_joints(|joint| [Parameter::Viscous { joint }, Parameter::Coulomb { joint }])
    }

    /// Adds the stiffness of the springs of all joints, also of those without spring.
    pub fn stiffness(self) -> Self {
        self.of_joints(|joint| [Parameter::Stiffness { joint }])
    }

    /// Adds the armature of all joints, also of those without.
    pub fn armature(self) -> Self {
        self.of_joints(|joint| [Parameter::Armature { joints: [joint; 2] }])
    }

    /// Adds the three components of gravity.
    pub fn gravity(self) -> Self {
        Axis::ALL.into_iter().fold(self, |set, axis| set.with(Parameter::Gravity { axis }))
    }

    /// Adds all parameters of [`parameter_names`](crate::codegen::parameter_names), in its order.
    pub fn model(mut self) -> Self {
        for Group { joints, entries, .. } in groups(&self.robot) {
            for (name, _) in entries {
                let found = match joints {
                    None => Parameter::gravity_named(name),
                    Some([i, j]) if i != j => Some(Parameter::Armature { joints: [i, j] }),
                    Some([joint, _]) => Parameter::of_joint(joint).find(|p| p.entry_name() == name),
                };
                self = found.into_iter().fold(self, Self::with);
            }
        }
        self
    }

    /// Adds the parameter of that name: a joint, a dot and `mass`, `h_x` to `h_z`, `J_xx` to `J_yz`, `x`,
    /// `y`, `z`, `rotation_x` to `rotation_z`, `stiffness`, `rest`, `viscous`, `coulomb`, `coulomb_velocity`
    /// or `armature`; two joints as in `a, b.armature`; or `gravity_x` to `gravity_z`.
    ///
    /// # Errors
    /// [`ParameterError::UnknownParameter`], with the names that resemble it.
    pub fn named(self, name: &str) -> Result<Self, ParameterError> {
        match self.find(name) {
            Some(parameter) => Ok(self.with(parameter)),
            None => Err(self.unknown(name)),
        }
    }

    /// Adds mass, first moment and inertia of a body that is fixed to a frame of the robot (of a link or
    /// joint, or an added one), about the origin of the frame and in its axes. Their names start with `name`;
    /// their values are 0, what the body adds to the model.
    ///
    /// # Errors
    /// [`RobotError::UnknownFrame`] and [`RobotError::FixedFrame`] as [`ParameterError::Robot`];
    /// [`ParameterError::Duplicate`].
    pub fn payload(mut self, name: &str, frame: &str) -> Result<Self, ParameterError> {
        let found = self.robot.frame(frame)?;
        let Some(joint) = found.joint else {
            return Err(RobotError::FixedFrame { frame: frame.into() }.into());
        };
        let placement = found.placement;
        for entry in Inertial::ALL {
            let name = format!("{name}.{}", entry.name());
            self.push(Parameter::Payload { joint, placement, entry }, name)?;
        }
        Ok(self)
    }

    /// Adds a displacement of the frame of a joint, under a name of its own; its value is 0.
    ///
    /// # Errors
    /// [`RobotError::UnknownJoint`] as [`ParameterError::Robot`], [`ParameterError::BadAxis`],
    /// [`ParameterError::Duplicate`].
    pub fn displacement(
        mut self,
        name: &str,
        joint: &str,
        displacement: Displacement,
    ) -> Result<Self, ParameterError> {
        let joint = self.robot.joint_index(joint)?;
        let axis = Vector3::from(displacement.axis);
        if !axis.norm().is_finite() || axis.norm() == 0.0 {
            let axis = format!("{:?}", displacement.axis);
            return Err(ParameterError::BadAxis { name: name.into(), axis });
        }
        self.push(Parameter::Displacement { joint, displacement }, name.into())?;
        Ok(self)
    }

    /// The entries of each joint, joint by joint.
    fn of_joints<const K: usize>(self, entries: impl Fn(usize) -> [Parameter; K]) -> Self {
        (0..self.robot.joints().len()).flat_map(entries).fold(self, Self::with)
    }

    /// With a parameter of the model, unless the set has it.
    fn with(mut self, parameter: Parameter) -> Self {
        if !self.parameters.contains(&parameter) {
            self.names.push(self.name_of(&parameter));
            self.values.push(value_of(&self.robot, &parameter));
            self.parameters.push(parameter);
        }
        self
    }

    /// Adds what is not in the model, under a name that no parameter of the model or of the set has.
    fn push(&mut self, parameter: Parameter, name: String) -> Result<(), ParameterError> {
        if self.names.contains(&name) || self.find(&name).is_some() {
            return Err(ParameterError::Duplicate { name });
        }
        self.parameters.push(parameter);
        self.names.push(name);
        self.values.push(0.0);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codegen::{parameter_names, parameter_values};
    use crate::parameters::DisplacedIn;
    use crate::robot::{Friction, JointSpec, LinkInertia, Placement, Spring};
    use nalgebra::DMatrix;

    fn robot() -> Robot {
        let place = |x: f64| Placement::from_xyz_rpy([x, 0.2, -0.1], [0.3, x, 0.0]);
        let link = LinkInertia::point(2.0, [0.1, 0.2, 0.3]);
        Robot::builder("pair")
            .joint(JointSpec::revolute("a").placed(place(0.4)).carrying(link))
            .joint(
                JointSpec::prismatic("b.c")
                    .on("a")
                    .placed(place(-0.7))
                    .carrying(link)
                    .spring(Spring { stiffness: 3.0, rest: 0.5 })
                    .friction(Friction { viscous: 0.2, coulomb: 1.0, coulomb_velocity: 0.3 }),
            )
            .armature_matrix(DMatrix::from_row_slice(2, 2, &[1.0, 0.5, 0.5, 2.0]))
            .build()
            .unwrap()
    }

    #[test]
    fn names_and_values_are_those_of_programs() {
        let robot = robot();
        let set = ParameterSet::new(&robot).model();
        assert_eq!(
            (set.names(), set.values()),
            (&parameter_names(&robot)[..], &parameter_values(&robot)[..])
        );
        let named = set.names().iter().try_fold(ParameterSet::new(&robot), |set, name| set.named(name));
        assert_eq!(named.unwrap(), set);
        assert_eq!(set.clone().links().armature().gravity().translations(), set, "each once");
        let with_rotations = set.clone().rotations();
        assert_eq!(with_rotations.names()[set.len() + 1], "a.rotation_y");
        let linear = with_rotations.parameters().iter().filter(|parameter| parameter.is_linear()).count();
        assert_eq!(linear, 20 + 1 + 2 + 3);
    }

    #[test]
    fn another_robot_has_the_same_parameters() {
        let (one, body) = (robot(), LinkInertia::point(0.5, [0.0, 0.1, 0.0]));
        let set = ParameterSet::new(&one).links().payload("load", "b.c").unwrap();
        let heavier = one.with_payload("b.c", &body).unwrap();
        let other = set.of_robot(&heavier).unwrap();
        assert_eq!((other.names(), other.parameters()), (set.names(), set.parameters()));
        assert_eq!((set.values()[10], other.values()[10], other.values()[0]), (2.0, 2.5, 2.0));
        assert_eq!((other.values().last(), other.robot()), (Some(&0.0), &heavier));
        let alone = Robot::builder("one").joint(JointSpec::revolute("a").carrying(body)).build().unwrap();
        assert!(set.of_robot(&alone).is_none());
    }

    #[test]
    fn what_is_wrong_is_named() {
        let set = || ParameterSet::new(&robot());
        let says = |error: Result<ParameterSet, ParameterError>, words: &str| {
            let message = error.unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        };
        says(set().named("a.weight"), "'a.weight'; names are a joint, a dot and one of mass, h_x");
        says(set().named("b.c.masss"), "'b.c.masss'; did you mean 'b.c.mass'?");
        says(set().named("c.c.masss"), "'c.c.masss'; did you mean 'b.c.mass'?");
        says(set().named("gravity_w"), "'gravity_w'; did you mean 'gravity_x' or");
        says(set().link("b,c"), "no joint 'b,c'; did you mean 'b.c'?");
        let still = Displacement::along(DisplacedIn::Parent, [0.0; 3]);
        says(set().displacement("gap", "a", still), "'gap' has the axis [0.0, 0.0, 0.0]");
        says(set().payload("tool", "b.d"), "no frame 'b.d'; did you mean 'b.c'?");
        says(set().payload("tool", "world"), "no joint moves frame 'world'");
        says(set().payload("a", "b.c"), "'a.mass' is in the set");
        says(set().payload("tool", "a").unwrap().payload("tool", "b.c"), "'tool.mass' is in the set");
    }
}
