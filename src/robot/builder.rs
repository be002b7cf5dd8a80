//! From descriptions of joints to a checked [`Robot`].

use super::checks;
use super::error::RobotError;
use super::joint::{Joint, JointSpec};
use super::warning::Warning;
use super::{LoadOptions, Robot};
use nalgebra::{DMatrix, Vector3};

/// Collects joints and builds a [`Robot`], see [`Robot::builder`].
#[derive(Clone, Debug)]
pub struct RobotBuilder {
    name: String,
    gravity: Vector3<f64>,
    joints: Vec<JointSpec>,
    armature: Option<DMatrix<f64>>,
    options: LoadOptions,
    warnings: Vec<Warning>,
}

impl RobotBuilder {
    pub(super) fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            gravity: Vector3::new(0.0, 0.0, -9.81),
            joints: Vec::new(),
            armature: None,
            options: LoadOptions::default(),
            warnings: Vec::new(),
        }
    }

    /// Gravity acceleration in the world frame (m/s^2); (0, 0, -9.81) unless set.
    pub fn gravity(mut self, gravity: [f64; 3]) -> Self {
        self.gravity = Vector3::from(gravity);
        self
    }

    /// Adds a joint. Parents may come after their children; the order is else kept.
    pub fn joint(mut self, joint: JointSpec) -> Self {
        self.joints.push(joint);
        self
    }

    /// A full armature matrix (constant, symmetric, positive semidefinite), rows in the order in which the joints
    /// were added; added to the joints' own armature.
    pub fn armature_matrix(mut self, armature: DMatrix<f64>) -> Self {
        self.armature = Some(armature);
        self
    }

    /// How strictly to check.
    pub fn options(mut self, options: LoadOptions) -> Self {
        self.options = options;
        self
    }

    pub(super) fn warn(&mut self, warning: Warning) {
        self.warnings.push(warning);
    }

    /// Orders the joints, checks them, and builds the robot.
    ///
    /// # Errors
    /// Every [`RobotError`] except those about files.
    pub fn build(mut self) -> Result<Robot, RobotError> {
        let order = self.parents_first()?;
        let n = self.joints.len();
        let mut armature = match self.armature.take() {
            Some(matrix) => reordered(&matrix, &order)?,
            None => DMatrix::zeros(n, n),
        };
        let mut joints: Vec<Joint> = Vec::with_capacity(n);
        let mut virtual_links = Vec::with_capacity(n);
        for (index, &source) in order.iter().enumerate() {
            let spec = &self.joints[source];
            let parent = match &spec.parent {
                Some(name) => joints.iter().position(|j| &j.name == name),
                None => None,
            };
            checks::joint(spec)?;
            armature[(index, index)] += spec.armature;
            virtual_links.push(spec.virtual_link);
            joints.push(Joint {
                name: spec.name.clone(),
                kind: spec.kind,
                parent,
                placement: spec.placement.orthonormalised(),
                axis: spec.axis / spec.axis.norm(),
                link: spec.link_name().into(),
                inertia: spec.inertia,
                spring: spec.spring,
                friction: spec.friction,
                limits: spec.limits,
            });
        }
        if self.gravity.iter().any(|g| !g.is_finite()) {
            return Err(RobotError::BadGravity);
        }
        let mut warnings = self.warnings;
        checks::armature(&armature)?;
        checks::robot(&joints, &armature, &virtual_links, &mut warnings)?;
        let refused: Vec<String> =
            warnings.iter().filter(|w| w.is_physical()).map(Warning::to_string).collect();
        if self.options.strict && !refused.is_empty() {
            return Err(RobotError::Strict { warnings: refused });
        }
        Ok(Robot { name: self.name, gravity: self.gravity, joints, armature, warnings })
    }

    /// Indices of the joints, parents before children, else in the order given.
    fn parents_first(&self) -> Result<Vec<usize>, RobotError> {
        let n = self.joints.len();
        if n == 0 {
            return Err(RobotError::NoJoints { robot: self.name.clone() });
        }
        let mut parents = Vec::with_capacity(n);
        for (index, spec) in self.joints.iter().enumerate() {
            if self.joints[..index].iter().any(|other| other.name == spec.name) {
                return Err(RobotError::DuplicateName { kind: "joint", name: spec.name.clone() });
            }
            parents.push(match &spec.parent {
                None => None,
                Some(name) => {
                    Some(self.joints.iter().position(|other| &other.name == name).ok_or_else(|| {
                        RobotError::UnknownParent {
                            joint: spec.name.clone(),
                            parent: name.clone(),
                            kind: "joint",
                        }
                    })?)
                }
            });
        }
        let mut order = Vec::with_capacity(n);
        let mut placed = vec![false; n];
        while order.len() < n {
            let ready = (0..n).find(|&i| !placed[i] && parents[i].is_none_or(|p| placed[p]));
            let Some(next) = ready else { return Err(self.cycle(&parents, &placed)) };
            placed[next] = true;
            order.push(next);
        }
        Ok(order)
    }

    /// Names the circle that the joints not yet placed run into.
    fn cycle(&self, parents: &[Option<usize>], placed: &[bool]) -> RobotError {
        let mut walk: Vec<usize> = Vec::new();
        let mut at = placed.iter().position(|done| !done);
        while let Some(joint) = at {
            if let Some(start) = walk.iter().position(|&seen| seen == joint) {
                walk.drain(..start);
                break;
            }
            walk.push(joint);
            at = parents[joint];
        }
        RobotError::Cycle { joints: walk.iter().map(|&i| self.joints[i].name.clone()).collect() }
    }
}

/// The armature matrix with rows and columns in the final order of the joints.
fn reordered(matrix: &DMatrix<f64>, order: &[usize]) -> Result<DMatrix<f64>, RobotError> {
    let n = order.len();
    if matrix.shape() != (n, n) {
        let problem = format!("is {} x {}", matrix.nrows(), matrix.ncols());
        return Err(RobotError::BadArmature { problem, n });
    }
    Ok(DMatrix::from_fn(n, n, |i, j| matrix[(order[i], order[j])]))
}
