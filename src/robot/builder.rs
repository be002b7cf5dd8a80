//! From descriptions of joints to a checked [`Robot`].

use super::armature::Armature;
use super::checks;
use super::error::RobotError;
use super::frame::{Frame, FrameKind, FrameSpec};
use super::frame_list::FrameList;
use super::free_parts;
use super::joint::{Joint, JointSpec};
use super::link::Placement;
use super::mimic;
use super::model::Robot;
use super::options::LoadOptions;
use super::warning::Warning;
use nalgebra::{DMatrix, Vector3};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, HashSet};

/// Collects joints and builds a [`Robot`], see [`Robot::builder`].
#[derive(Clone, Debug)]
#[must_use = "a builder does nothing until `build` is called"]
pub struct RobotBuilder {
    name: String,
    gravity: Vector3<f64>,
    joints: Vec<JointSpec>,
    armature: Option<DMatrix<f64>>,
    frames: Vec<FrameSpec>,
    options: LoadOptions,
    warnings: Vec<Warning>,
}

impl Robot {
    /// Starts a robot of that name, without joints and with gravity (0, 0, -9.81) m/s^2.
    pub fn builder(name: impl Into<String>) -> RobotBuilder {
        RobotBuilder::new(name)
    }
}

impl RobotBuilder {
    pub(super) fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            gravity: Vector3::new(0.0, 0.0, -9.81),
            joints: Vec::new(),
            armature: None,
            frames: Vec::new(),
            options: LoadOptions::default(),
            warnings: Vec::new(),
        }
    }

    /// Gravity acceleration in the world frame (m/s^2); (0, 0, -9.81) unless set.
    pub fn gravity(mut self, gravity: [f64; 3]) -> Self {
        self.gravity = Vector3::from(gravity);
        self
    }

    /// Adds a joint. Children may come before their parents; `build` moves the parents first and keeps the
    /// order otherwise.
    pub fn joint(mut self, joint: JointSpec) -> Self {
        self.joints.extend(joint.parts());
        self
    }

    /// A full armature matrix (constant, symmetric, positive semidefinite), rows in the order in which the
    /// joints were added; added to the joints' own armature.
    pub fn armature_matrix(mut self, armature: DMatrix<f64>) -> Self {
        self.armature = Some(armature);
        self
    }

    /// Adds a frame on a link, a joint, or a frame added before.
    pub fn frame(mut self, frame: FrameSpec) -> Self {
        self.frames.push(frame);
        self
    }

    /// Whether warnings are errors: [`LoadOptions::strict`].
    pub fn options(mut self, options: LoadOptions) -> Self {
        self.options = options;
        self
    }

    #[cfg(feature = "urdf")]
    pub(super) fn warn(&mut self, warning: Warning) {
        self.warnings.push(warning);
    }

    /// Orders the joints, checks them, and builds the robot.
    ///
    /// # Errors
    /// Every [`RobotError`] except those about files: [`RobotError::NoJoints`],
    /// [`RobotError::DuplicateName`], [`RobotError::BadName`], [`RobotError::UnknownParent`] and
    /// [`RobotError::Cycle`] where the joints form no tree, [`RobotError::UnknownMimic`] and
    /// [`RobotError::MimicCycle`] where mimicry leads to no independent joint, [`RobotError::BadAxis`],
    /// [`RobotError::BadPlacement`], [`RobotError::BadValue`], [`RobotError::BadGravity`],
    /// [`RobotError::BadArmature`], [`RobotError::NonFiniteInertia`], [`RobotError::NegativeMass`] and
    /// [`RobotError::IndefiniteInertia`] for numbers, [`RobotError::FreeJoint`] for what a floating or
    /// spherical joint cannot have, [`RobotError::Strict`] where the options refuse warnings.
    pub fn build(mut self) -> Result<Robot, RobotError> {
        let order = self.parents_first()?;
        let n = self.joints.len();
        let given = self.armature.take().map(|matrix| reordered(&matrix, &order)).transpose()?;
        let mut index_of: HashMap<&str, usize> = HashMap::with_capacity(n);
        let mut joints: Vec<Joint> = Vec::with_capacity(n);
        let mimics = mimic::resolved(&self.joints, &order)?;
        for (index, spec) in order.iter().map(|&source| &self.joints[source]).enumerate() {
            checks::joint(spec)?;
            free_parts::check_part(spec)?;
            joints.push(Joint {
                name: spec.name.clone(),
                kind: spec.kind,
                parent: spec.parent.as_deref().and_then(|parent| index_of.get(parent).copied()),
                placement: spec.placement.orthonormalised(),
                axis: spec.axis / spec.axis.norm(),
                link: spec.link_name().into(),
                inertia: spec.inertia,
                spring: spec.spring,
                friction: spec.friction,
                limits: spec.limits,
                mimic: mimics[index],
                free: spec.free.clone(),
            });
            index_of.insert(&spec.name, index);
        }
        checks::gravity(&self.gravity.into())?;
        let of_joints = order.iter().map(|&source| self.joints[source].armature);
        let armature = match given {
            Some(matrix) => Armature::from_matrix(
                &(matrix + DMatrix::from_diagonal(&of_joints.collect::<Vec<_>>().into())),
            )?,
            None => Armature::diagonal(of_joints),
        };
        free_parts::check_robot(&joints, &armature)?;
        let mut warnings = self.warnings;
        for spec in order.iter().map(|&source| &self.joints[source]) {
            if spec.inertia.is_massless() && !spec.virtual_link {
                warnings.push(Warning::MasslessLink { link: spec.link_name().into() });
            }
        }
        checks::pass_links_between(&joints, &armature, &mut warnings);
        mimic::narrow_limits(&mut joints, &mut warnings);
        checks::robot(&joints, &armature, &mut warnings);
        checks::try_mass_matrix(&joints, &armature, &mut warnings);
        self.options.refuse(&warnings)?;
        let frames = frames(&joints, self.frames)?;
        let independent = (0..joints.len()).filter(|&i| joints[i].mimic.is_none()).collect();
        Ok(Robot {
            name: self.name,
            gravity: self.gravity,
            independent,
            armature,
            free: free_parts::free_joints(&joints),
            joints,
            frames,
            wrenches: Vec::new(),
            constraints: Vec::new(),
            warnings,
        })
    }

    /// Indices of the joints in the order given, except that parents come before their children.
    fn parents_first(&self) -> Result<Vec<usize>, RobotError> {
        let n = self.joints.len();
        if n == 0 {
            return Err(RobotError::NoJoints { robot: self.name.clone() });
        }
        let mut index_of: HashMap<&str, usize> = HashMap::with_capacity(n);
        for (index, spec) in self.joints.iter().enumerate() {
            checks::name("joint", &spec.name)?;
            if index_of.insert(&spec.name, index).is_some() {
                return Err(RobotError::DuplicateName { kind: "joint", name: spec.name.clone() });
            }
        }
        let mut parents = Vec::with_capacity(n);
        let mut children = vec![Vec::new(); n];
        for (index, spec) in self.joints.iter().enumerate() {
            let Some(name) = &spec.parent else {
                parents.push(None);
                continue;
            };
            let Some(&parent) = index_of.get(name.as_str()) else {
                let (joint, parent) = (spec.name.clone(), name.clone());
                return Err(RobotError::UnknownParent { joint, parent, kind: "joint" });
            };
            parents.push(Some(parent));
            children[parent].push(index);
        }
        // The joints whose parents have been placed; the first of them in the order given is next.
        let mut ready: BinaryHeap<Reverse<usize>> =
            (0..n).filter(|&joint| parents[joint].is_none()).map(Reverse).collect();
        let mut order = Vec::with_capacity(n);
        while let Some(Reverse(next)) = ready.pop() {
            order.push(next);
            ready.extend(children[next].iter().copied().map(Reverse));
        }
        if order.len() < n { Err(self.cycle(&parents, &order)) } else { Ok(order) }
    }

    /// Names the loop that contains, or leads to, the first joint that could not be placed.
    fn cycle(&self, parents: &[Option<usize>], placed: &[usize]) -> RobotError {
        let mut is_placed = vec![false; parents.len()];
        placed.iter().for_each(|&joint| is_placed[joint] = true);
        let mut step = vec![None; parents.len()];
        let mut walk: Vec<usize> = Vec::new();
        let mut at = is_placed.iter().position(|done| !done);
        while let Some(joint) = at {
            if let Some(start) = step[joint] {
                walk.drain(..start);
                break;
            }
            step[joint] = Some(walk.len());
            walk.push(joint);
            at = parents[joint];
        }
        RobotError::Cycle { joints: walk.iter().map(|&i| self.joints[i].name.clone()).collect() }
    }
}

/// The frames of the world, of joints, of links that the description names, and the given ones.
fn frames(joints: &[Joint], given: Vec<FrameSpec>) -> Result<Vec<Frame>, RobotError> {
    let mut frames = FrameList::of_joints(joints);
    let is_link = |frame: &&FrameSpec| frame.kind == FrameKind::Link;
    let given_links: HashSet<&str> = given.iter().filter(is_link).map(|frame| frame.name.as_str()).collect();
    for joint in joints.iter().filter(|joint| joint.link != joint.name) {
        if !given_links.contains(joint.link.as_str()) {
            let place = Placement::identity();
            frames.add(FrameSpec::described(&joint.link, FrameKind::Link, Some(&joint.name), place))?;
        }
    }
    drop(given_links);
    given.into_iter().try_for_each(|frame| frames.add(frame))?;
    Ok(frames.into_frames())
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
