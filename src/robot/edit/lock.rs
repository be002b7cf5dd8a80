//! Joints that no longer move.

use crate::robot::constraint::{Constraint, ConstraintKind};
use crate::robot::error::RobotError;
use crate::robot::frame::Frame;
use crate::robot::free_entries::of_position;
use crate::robot::free_parts::free_joints;
use crate::robot::joint::{Joint, Mimic};
use crate::robot::link::Placement;
use crate::robot::model::Robot;
use crate::robot::warning::Warning;
use crate::robot::wrench::AppliedWrench;

/// Where the frame of an old joint is: in the frame of a joint that stays (its new index), or in the world.
#[derive(Clone, Copy)]
struct Seat {
    carrier: Option<usize>,
    placement: Placement,
}

impl Robot {
    /// The robot that remains when joints are held at positions (rad, m), with all that mimics them.
    ///
    /// The links beyond a locked joint become part of the link before it, or of the world; springs, friction
    /// and armature of locked joints are omitted, and the order of the others remains. All frames stay, those
    /// of locked joints too, after those of the others. V may differ by a constant.
    ///
    /// ```
    /// use costate::robot::Robot;
    ///
    /// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
    /// let arm = Robot::from_file("robots/ur5.urdf")?;
    /// let wristless = arm.lock(&[("wrist_1_joint", 0.5), ("wrist_2_joint", 0.0), ("wrist_3_joint", 0.0)])?;
    /// assert_eq!((arm.dof(), wristless.dof()), (6, 3));
    /// let error = arm.lock(&[("wrist_4_joint", 0.0)]).unwrap_err().to_string();
    /// assert!(error.contains("'wrist_1_joint'"), "names that resemble it: {error}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// A position outside the limits of its joint is a warning.
    ///
    /// # Errors
    /// [`RobotError::UnknownJoint`]; [`RobotError::DependentJoint`] for a joint that mimics another one;
    /// [`RobotError::BadValue`] for a position that is not finite or given twice; [`RobotError::AllLocked`]
    /// if nothing can move any more.
    pub fn lock(&self, joints: &[(&str, f64)]) -> Result<Self, RobotError> {
        let mut held: Vec<Option<f64>> = vec![None; self.joints.len()];
        let mut warnings = Vec::new();
        for &(name, value) in joints {
            let index = self.independent_index(name)?;
            let what = "the locked position";
            let bad = |rule| Err(RobotError::BadValue { joint: name.to_owned(), what, value, rule });
            if !value.is_finite() {
                return bad("it must be finite");
            }
            if held[index].replace(value).is_some() {
                return bad("it is locked twice: give it one position");
            }
            let limits = self.joints[index].limits;
            if !(limits.lower..=limits.upper).contains(&value) {
                let limits = [limits.lower, limits.upper];
                warnings.push(Warning::LockedOutside { joint: name.to_owned(), value, limits });
            }
        }
        for i in 0..self.joints.len() {
            if let Some(Mimic { joint, ratio, offset }) = self.joints[i].mimic {
                held[i] = held[joint].map(|value| ratio.mul_add(value, offset));
            }
        }
        Ok(self.holding(&held)?.checked(self, warnings))
    }

    /// The robot of these independent joints, and of those that mimic them; all others are held at the
    /// positions q (rad, m; [`nq`](Self::nq)). Floating and spherical joints must be among those that remain;
    /// their entries of q do not count.
    ///
    /// # Errors
    /// [`RobotError::WrongPositions`] unless q has nq entries, [`RobotError::RepeatedJoint`], and those of
    /// [`lock`](Self::lock), [`RobotError::FreeJoint`] for a floating or spherical joint that is not named
    /// among them.
    pub fn reduced_to(&self, joints: &[&str], q: &[f64]) -> Result<Self, RobotError> {
        if q.len() != self.nq() {
            return Err(RobotError::WrongPositions { expected: self.nq(), found: q.len() });
        }
        let mut stays = vec![false; self.joints.len()];
        for name in joints {
            let is_whole = self.free.iter().any(|free| free.name == *name);
            let index = if is_whole { self.joint_index(name)? } else { self.independent_index(name)? };
            if std::mem::replace(&mut stays[index], true) {
                return Err(RobotError::RepeatedJoint { joint: (*name).to_owned() });
            }
        }
        for free in &self.free {
            if !stays[self.joint_index(&free.name)?] {
                let (joint, kind) = (free.name.clone(), free.kind.name());
                let what = "be held: name it among the joints that remain";
                return Err(RobotError::FreeJoint { joint, kind, what });
            }
        }
        let mut others: Vec<(&str, f64)> = Vec::new();
        for (entry, &position) in q.iter().enumerate() {
            if let Err(coordinate) = of_position(&self.free, entry) {
                let joint = self.independent[coordinate];
                others.extend((!stays[joint]).then(|| (self.joints[joint].name.as_str(), position)));
            }
        }
        self.lock(&others)
    }

    /// Without the joints that are held at a position.
    fn holding(&self, held: &[Option<f64>]) -> Result<Self, RobotError> {
        let mut seats: Vec<Seat> = Vec::with_capacity(held.len());
        let (mut joints, mut kept): (Vec<Joint>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut new_index = vec![None; held.len()];
        for (i, joint) in self.joints.iter().enumerate() {
            let base =
                joint.parent.map_or(Seat { carrier: None, placement: Placement::identity() }, |p| seats[p]);
            // What stands on a joint that stays is not rounded.
            let moved = base.placement != Placement::identity();
            let standing =
                if moved { base.placement.then(&joint.placement).orthonormalised() } else { joint.placement };
            match held[i] {
                None => {
                    new_index[i] = Some(joints.len());
                    seats.push(Seat { carrier: Some(joints.len()), placement: Placement::identity() });
                    kept.push(i);
                    joints.push(Joint { parent: base.carrier, placement: standing, ..joint.clone() });
                }
                Some(value) => {
                    let placement = standing.then(&joint.kind.motion(&joint.axis, value));
                    seats.push(Seat { carrier: base.carrier, placement });
                    if let Some(carrier) = base.carrier.map(|carrier| &mut joints[carrier]) {
                        let body = joint.inertia.placed(&placement);
                        carrier.inertia =
                            if carrier.inertia.is_massless() { body } else { carrier.inertia.merged(&body) };
                    }
                }
            }
        }
        if joints.is_empty() {
            let joints = self.independent_joints().map(|joint| joint.name.clone()).collect();
            return Err(RobotError::AllLocked { joints });
        }
        for joint in &mut joints {
            // What a joint mimics stays if the joint does.
            joint.mimic =
                joint.mimic.and_then(|mimic| Some(Mimic { joint: new_index[mimic.joint]?, ..mimic }));
        }
        let mut frames = self.frames.clone();
        for frame in &mut frames {
            if let Some(seat) = frame.joint.map(|joint| seats[joint]) {
                frame.joint = seat.carrier;
                frame.placement = seat.placement.then(&frame.placement);
            }
        }
        let (frames, wrenches, mut constraints) = self.rearranged(frames, held);
        constraints.iter_mut().for_each(|one| one.kind.hold(held, &new_index));
        let independent = (0..joints.len()).filter(|&i| joints[i].mimic.is_none()).collect();
        let armature = self.armature.restricted_to(&kept);
        let free = free_joints(&joints);
        Ok(Self { joints, independent, free, armature, frames, wrenches, constraints, ..self.clone() })
    }

    /// Frames in the order of a robot: those of locked joints are no longer among those of the joints.
    /// Wrenches and constraints stay at their frames.
    fn rearranged(
        &self,
        frames: Vec<Frame>,
        held: &[Option<f64>],
    ) -> (Vec<Frame>, Vec<AppliedWrench>, Vec<Constraint>) {
        // After the frame of the world comes that of each joint, but for parts inside of a free one.
        let joints = self.joints.iter().zip(held).filter(|(joint, _)| !joint.is_inner());
        let held: Vec<bool> = joints.map(|(_, position)| position.is_some()).collect();
        let is_locked = |frame: &usize| held.get(frame.wrapping_sub(1)).is_some_and(|&locked| locked);
        let (locked, stays): (Vec<usize>, Vec<usize>) = (0..frames.len()).partition(is_locked);
        let joints_end = 1 + held.len() - locked.len();
        let order = [&stays[..joints_end], &locked, &stays[joints_end..]].concat();
        let mut places = vec![0; frames.len()];
        order.iter().enumerate().for_each(|(place, &frame)| places[frame] = place);
        let mut wrenches = self.wrenches.clone();
        wrenches.iter_mut().for_each(|applied| applied.frame = places[applied.frame]);
        let mut constraints = self.constraints.clone();
        let seats = constraints.iter_mut().flat_map(|constraint| constraint.kind.frames_mut());
        seats.for_each(|seat| seat.frame = places[seat.frame]);
        (order.iter().map(|&frame| frames[frame].clone()).collect(), wrenches, constraints)
    }
}

impl ConstraintKind {
    /// The terms of joints that are held become part of the constant; the others get their new index.
    fn hold(&mut self, held: &[Option<f64>], new_index: &[Option<usize>]) {
        if let Self::Coupling { terms, constant } = self {
            for &(joint, factor) in terms.iter() {
                *constant -= held[joint].map_or(0.0, |position| factor * position);
            }
            *terms = terms.iter().filter_map(|&(joint, factor)| Some((new_index[joint]?, factor))).collect();
        }
    }
}
