//! The mean of a robot with its mirror image.
//!
//! With the reflection R = diag(1, -1, 1) at the plane y = 0 of the world, the joint i in the place of the
//! joint j, the sign s of its coordinate, and both robots at q = 0,
//!
//! ```text
//! m_i = (m_i + m_j) / 2,   m_i c_i = (m_i c_i + m_j R c_j) / 2,   I_i = (I_i + R I_j R) / 2
//! d_i ~ d_i + s t R d_j    t = 1 for prismatic joints, -1 for revolute ones
//! ```
//!
//! where c is the centre of mass and I the inertia about the origin of the world, in its axes, and d the
//! axis. The axis of a revolute joint goes through the mean of the origins of both joint frames. Frames turn
//! with their axes. Armature, springs and friction are means too; limits stay.

use crate::robot::armature::Armature;
use crate::robot::error::RobotError;
use crate::robot::joint::{Joint, JointKind};
use crate::robot::link::{LinkInertia, Placement};
use crate::robot::model::Robot;
use nalgebra::{DMatrix, Matrix3, Rotation3, Vector3};

/// The cosine of the largest angle between an axis and the mirror image of its counterpart, 30 degrees:
/// beyond it the joints are no pair, or the sign is wrong.
const SAME_AXIS: f64 = 0.866;

/// A change of one kind, where it is largest.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LargestChange {
    /// Its size.
    pub amount: f64,
    /// The link, joint or frame.
    pub name: String,
}

impl LargestChange {
    fn meet(&mut self, amount: f64, name: &str) {
        if amount > self.amount {
            (self.amount, self.name) = (amount, name.to_owned());
        }
    }
}

/// What [`Robot::symmetrised`] changed.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SymmetryChange {
    /// Of masses of links (kg).
    pub mass: LargestChange,
    /// Of centres of mass, at q = 0 in the world (m).
    pub com: LargestChange,
    /// Of entries of inertias about centres of mass (kg m^2).
    pub inertia: LargestChange,
    /// Of the places of axes and of the frames that were named (m).
    pub place: LargestChange,
    /// Of directions of axes and of the frames that were named (rad).
    pub direction: LargestChange,
}

impl Robot {
    /// The mean of this robot with its mirror image at the plane y = 0 of the world, and the largest changes.
    ///
    /// `exchange` has for each entry of q the one in whose place it comes, and the sign of its coordinate
    /// there; pairs of `frames` are mirror images of each other then too. What is a mirror image of itself
    /// stays, up to rounding.
    ///
    /// # Errors
    /// [`RobotError::NotMirrored`] for joints that are no pair: of different kinds, on links that are no
    /// pair, or with axes that differ by more than 30 degrees in the mirror; [`RobotError::UnknownFrame`];
    /// those of a new robot.
    ///
    /// ```
    /// use costate::robot::{JointSpec, LinkInertia, Placement, Robot};
    ///
    /// let leg = |name: &str, y: f64, mass: f64| {
    ///     let placed = Placement::from_xyz_rpy([0.0, y, 0.0], [0.0; 3]);
    ///     JointSpec::revolute(name).axis([0.0, 1.0, 0.0]).placed(placed)
    ///         .carrying(LinkInertia::point(mass, [0.0, 0.0, -0.3]))
    /// };
    /// let robot = Robot::builder("legs").joint(leg("left", 0.1, 1.0)).joint(leg("right", -0.1,
    /// 1.2)).build()?; let (even, change) = robot.symmetrised(&[(1, 1.0), (0, 1.0)], &[])?;
    /// assert!((even.joints()[0].inertia.mass - 1.1).abs() < 1e-15 && (change.mass.amount - 0.1).abs() <
    /// 1e-15);
    /// # Ok::<(), costate::robot::RobotError>(())
    /// ```
    pub fn symmetrised(
        &self,
        exchange: &[(usize, f64)],
        frames: &[[String; 2]],
    ) -> Result<(Self, SymmetryChange), RobotError> {
        let pairs = self.pairs_of_joints(exchange)?;
        let world = placed_at_zero(&self.joints);
        let (mut robot, mut change) = (self.clone(), SymmetryChange::default());
        let mut new: Vec<Placement> = Vec::with_capacity(world.len());
        for (i, &(j, sign)) in pairs.iter().enumerate() {
            let joint = &self.joints[i];
            let axis = |k: usize| world[k].rotation * self.joints[k].axis;
            let turn = if joint.kind == JointKind::Revolute { -1.0 } else { 1.0 };
            let (own, other) = (axis(i), mirrored(&axis(j)) * (sign * turn));
            if own.dot(&other) < SAME_AXIS {
                return Err(self.not_mirrored(i, j, "their axes differ in the mirror"));
            }
            let mean = (own + other).normalize();
            change.direction.meet(own.cross(&mean).norm(), &joint.name);
            let origin = world[i].translation;
            let origin = if joint.kind == JointKind::Revolute {
                let middle = 0.5 * (origin + mirrored(&world[j].translation));
                middle + mean * (origin - middle).dot(&mean)
            } else {
                origin
            };
            change.place.meet((origin - world[i].translation).norm(), &joint.name);
            let rotation = turned(&own, &mean) * world[i].rotation;
            new.push(Placement { rotation, translation: origin }.orthonormalised());
        }
        for (i, &(j, sign)) in pairs.iter().enumerate() {
            let (own, other) = (&self.joints[i], &self.joints[j]);
            let joint = &mut robot.joints[i];
            let base = own.parent.map_or_else(Placement::identity, |parent| new[parent]);
            // The joint frame at q = 0 has moved by the offset of a mimic.
            let unmoved = new[i].then(&inverse(&moved(own)));
            joint.placement = inverse(&base).then(&unmoved).orthonormalised();
            let before = own.inertia.placed(&world[i]);
            let image = reflected(&other.inertia.placed(&world[j]));
            let mean = half(&before).merged(&half(&image));
            change.mass.meet((mean.mass - before.mass).abs(), &own.link);
            change.com.meet((mean.com - before.com).norm(), &own.link);
            change.inertia.meet((mean.inertia - before.inertia).amax(), &own.link);
            joint.inertia = mean.placed(&inverse(&new[i]));
            let both = |a: f64, b: f64| 0.5 * (a + b);
            joint.spring.stiffness = both(own.spring.stiffness, other.spring.stiffness);
            joint.spring.rest = both(own.spring.rest, sign * other.spring.rest);
            joint.friction.viscous = both(own.friction.viscous, other.friction.viscous);
            joint.friction.coulomb = both(own.friction.coulomb, other.friction.coulomb);
            joint.friction.coulomb_velocity =
                both(own.friction.coulomb_velocity, other.friction.coulomb_velocity);
        }
        let armature = self.armature.matrix();
        let image = |i: usize, j: usize| pairs[i].1 * pairs[j].1 * armature[(pairs[i].0, pairs[j].0)];
        let mean = DMatrix::from_fn(pairs.len(), pairs.len(), |i, j| 0.5 * (armature[(i, j)] + image(i, j)));
        robot.armature = Armature::from_matrix(&mean)?;
        for [a, b] in frames {
            self.symmetrise_frames(
                [self.frame_index(a)?, self.frame_index(b)?],
                &world,
                &new,
                &mut robot,
                &mut change,
            );
        }
        Ok((robot.checked(self, Vec::new()), change))
    }

    /// For each joint, those that mimic others too, its counterpart and the sign of its coordinate.
    fn pairs_of_joints(&self, exchange: &[(usize, f64)]) -> Result<Vec<(usize, f64)>, RobotError> {
        let mut pairs: Vec<(usize, f64)> = (0..self.joints.len()).map(|i| (i, 1.0)).collect();
        for (&i, &(other, sign)) in self.independent.iter().zip(exchange) {
            pairs[i] = (self.independent.get(other).copied().unwrap_or(i), sign);
        }
        let followers = |of: usize| {
            let all = self.joints.iter().enumerate();
            all.filter(move |(_, joint)| joint.mimic.is_some_and(|mimic| mimic.joint == of)).map(|(k, _)| k)
        };
        for &i in &self.independent {
            let (j, sign) = pairs[i];
            for (place, k) in followers(i).enumerate() {
                let Some(l) = followers(j).nth(place) else {
                    return Err(self.not_mirrored(i, j, "other joints mimic one of them"));
                };
                let ratio = |k: usize| self.joints[k].mimic.map_or(1.0, |mimic| mimic.ratio);
                pairs[k] = (l, sign * (ratio(k) * ratio(l)).signum());
            }
        }
        for (i, &(j, _)) in pairs.iter().enumerate() {
            let (own, other) = (&self.joints[i], &self.joints[j]);
            if own.kind != other.kind {
                return Err(self.not_mirrored(i, j, "one turns and one slides"));
            }
            if own.parent.map(|parent| pairs[parent].0) != other.parent {
                return Err(self.not_mirrored(i, j, "the links that carry them are no pair"));
            }
        }
        Ok(pairs)
    }

    fn not_mirrored(&self, i: usize, j: usize, why: &'static str) -> RobotError {
        let name = |k: usize| self.joints[k].name.clone();
        RobotError::NotMirrored { joint: name(i), other: name(j), why }
    }

    /// Both frames of a pair, each in the mean of its place and of the mirror image of the other one; so are
    /// their axes if these are closer than 30 degrees.
    fn symmetrise_frames(
        &self,
        pair: [usize; 2],
        world: &[Placement],
        new: &[Placement],
        robot: &mut Self,
        change: &mut SymmetryChange,
    ) {
        let base = |placements: &[Placement], joint: Option<usize>| {
            joint.map_or_else(Placement::identity, |joint| placements[joint])
        };
        let before = pair.map(|k| base(world, self.frames[k].joint).then(&self.frames[k].placement));
        for (side, k) in pair.into_iter().enumerate() {
            let (own, other) = (before[side], before[1 - side]);
            let own_axes = Rotation3::from_matrix_unchecked(own.rotation);
            let image = Rotation3::from_matrix_unchecked(reflection() * other.rotation * reflection());
            let between = (own_axes.inverse() * image).scaled_axis();
            let close = between.norm() < SAME_AXIS.acos();
            let half = if close { between * 0.5 } else { Vector3::zeros() };
            let axes = own_axes * Rotation3::from_scaled_axis(half);
            let place = 0.5 * (own.translation + mirrored(&other.translation));
            change.place.meet((place - own.translation).norm(), &self.frames[k].name);
            change.direction.meet(half.norm(), &self.frames[k].name);
            let placed = Placement { rotation: axes.into_inner(), translation: place };
            let frame = &mut robot.frames[k];
            frame.placement = inverse(&base(new, frame.joint)).then(&placed).orthonormalised();
        }
    }
}

/// diag(1, -1, 1).
fn reflection() -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0))
}

fn mirrored(x: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(x.x, -x.y, x.z)
}

/// A body in the mirror.
fn reflected(body: &LinkInertia) -> LinkInertia {
    let inertia = reflection() * body.inertia * reflection();
    LinkInertia { mass: body.mass, com: mirrored(&body.com), inertia }
}

/// With half of the mass and of the inertia.
fn half(body: &LinkInertia) -> LinkInertia {
    LinkInertia { mass: 0.5 * body.mass, com: body.com, inertia: body.inertia * 0.5 }
}

/// The rotation that turns a direction into another one, which is not opposite: `1 + [w] + [w]^2 / (1 + c)`
/// with
/// `w = a x b`, `c = a . b`; exact for small angles too.
fn turned(a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    let cross = a.cross(b).cross_matrix();
    Matrix3::identity() + cross + cross * cross / (1.0 + a.dot(b))
}

fn inverse(placement: &Placement) -> Placement {
    let rotation = placement.rotation.transpose();
    Placement { rotation, translation: -(rotation * placement.translation) }
}

/// How the frame of a joint has moved at q = 0: by the offset of one that mimics another one.
fn moved(joint: &Joint) -> Placement {
    let offset = joint.mimic.map_or(0.0, |mimic| mimic.offset);
    let (mut by, axis) = (Placement::identity(), joint.axis * offset);
    match joint.kind {
        JointKind::Revolute => by.rotation = Rotation3::from_scaled_axis(axis).into_inner(),
        JointKind::Prismatic => by.translation = axis,
    }
    by
}

/// The frames of all joints in the world at q = 0.
fn placed_at_zero(joints: &[Joint]) -> Vec<Placement> {
    let mut placed: Vec<Placement> = Vec::with_capacity(joints.len());
    for joint in joints {
        let base = joint.parent.map_or_else(Placement::identity, |parent| placed[parent]);
        placed.push(base.then(&joint.placement).then(&moved(joint)));
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lagrangian::Lagrangian;
    use crate::robot::{FrameSpec, JointSpec};

    /// A trunk that moves freely in space, with two legs of two joints. Numbers of the right one differ by
    /// `off`, in proportion to their sizes.
    fn biped(off: f64) -> Robot {
        let mut random = fastrand::Rng::with_seed(3);
        let mut uneven = move |x: f64| x * (1.0 + off * (2.0 * random.f64() - 1.0));
        let mut builder = Robot::builder("biped");
        let axes = [("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0]), ("z", [0.0, 0.0, 1.0])];
        let mut parent: Option<String> = None;
        for (kind, (name, axis)) in axes.iter().map(|axis| (0, axis)).chain(axes.iter().map(|axis| (1, axis)))
        {
            let own = format!("{}_{name}", ["move", "turn"][kind]);
            let joint = if kind == 0 { JointSpec::prismatic(&own) } else { JointSpec::revolute(&own) };
            let mut joint = joint.axis(*axis);
            if let Some(parent) = &parent {
                joint = joint.on(parent);
            }
            if own == "turn_z" {
                let trunk = [0.3, 0.25, 0.1, uneven(0.001) - 0.001, 0.02, uneven(0.001) - 0.001];
                joint =
                    joint.carrying(LinkInertia::from_entries(9.0, [0.01, uneven(0.01) - 0.01, 0.2], trunk));
            }
            builder = builder.joint(joint);
            parent = Some(own);
        }
        for (side, y) in [("left", 1.0), ("right", -1.0)] {
            let mut of = |x: f64| if y < 0.0 { uneven(x) } else { x };
            let at =
                Placement::from_xyz_rpy([of(0.02), y * of(0.12), of(-0.1)], [y * of(0.2), 0.1, y * 0.05]);
            let thigh = [of(0.02), 0.021, 0.004, y * of(0.001), 0.001, y * 0.002];
            builder = builder.joint(
                JointSpec::revolute(format!("{side}_hip"))
                    .on("turn_z")
                    .axis([1.0, 0.0, 0.0])
                    .placed(at)
                    .carrying(LinkInertia::from_entries(of(2.0), [0.01, y * of(0.03), of(-0.15)], thigh)),
            );
            let at = Placement::from_xyz_rpy([of(0.01), y * 0.02, of(-0.3)], [0.0, 0.0, y * of(0.1)]);
            let shank = LinkInertia::from_entries(
                of(1.0),
                [0.0, y * 0.01, of(-0.2)],
                [0.01, 0.01, 0.001, 0.0, 0.0, 0.0],
            );
            builder = builder.joint(
                JointSpec::revolute(format!("{side}_knee"))
                    .on(format!("{side}_hip"))
                    .axis([0.0, 1.0, 0.0])
                    .placed(at)
                    .carrying(shank),
            );
            let foot = Placement::from_xyz_rpy([of(0.01), y * of(0.01), of(-0.35)], [0.0; 3]);
            builder =
                builder.frame(FrameSpec::new(format!("{side}_foot")).on(format!("{side}_knee")).placed(foot));
        }
        builder.build().unwrap()
    }

    /// Joints that change places, with the signs of a robot in space.
    const EXCHANGE: [(usize, f64); 10] = [
        (0, 1.0),
        (1, -1.0),
        (2, 1.0),
        (3, -1.0),
        (4, 1.0),
        (5, -1.0),
        (8, -1.0),
        (9, 1.0),
        (6, -1.0),
        (7, 1.0),
    ];

    /// The largest difference of the torques of mirrored motions.
    fn asymmetry(robot: &Robot) -> f64 {
        let list = |first: f64| (0..10).map(|i| (first + 1.7 * f64::from(i)).sin()).collect::<Vec<f64>>();
        let swapped = |list: &[f64]| EXCHANGE.iter().map(|&(i, sign)| sign * list[i]).collect::<Vec<f64>>();
        let (q, v, a) = (list(0.1), list(0.3), list(2.0));
        let mut model = Lagrangian::<f64>::new(robot);
        let tau = swapped(model.inverse_dynamics(&q, &v, &a).unwrap());
        let image = model.inverse_dynamics(&swapped(&q), &swapped(&v), &swapped(&a)).unwrap();
        tau.iter().zip(image).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
    }

    #[test]
    fn mean_with_the_mirror_image_is_its_own_mirror_image() {
        let feet = [["left_foot".to_owned(), "right_foot".to_owned()]];
        for off in [1e-6, 1e-3, 0.1] {
            let robot = biped(off);
            let (even, change) = robot.symmetrised(&EXCHANGE, &feet).unwrap();
            assert!(asymmetry(&robot) > 0.1 * off, "{off}");
            assert!(asymmetry(&even) < 1e-12, "{off}: {:e}", asymmetry(&even));
            let mass = |robot: &Robot| robot.joints().iter().map(|joint| joint.inertia.mass).sum::<f64>();
            assert!((mass(&robot) - mass(&even)).abs() < 1e-13);
            let largest = (robot.joints()[8].inertia.mass - 2.0).abs() * 0.5;
            assert!(change.mass.amount >= largest * (1.0 - 1e-9), "{change:?}");
            assert!(change.place.amount > 0.0 && change.place.amount < 0.3 * off, "{change:?}");
            // The lines of the axes are mirror images, whatever place on them is the origin of a frame.
            let [left, right] = [6, 8].map(|joint| &even.joints()[joint].placement);
            let axis = left.rotation * even.joints()[6].axis;
            let between = left.translation - mirrored(&right.translation);
            assert!((between - axis * axis.dot(&between)).amax() < 1e-15, "{between}");
        }
    }

    #[test]
    fn symmetric_robot_stays() {
        let robot = biped(0.0);
        let (even, change) = robot.symmetrised(&EXCHANGE, &[]).unwrap();
        let changes = [&change.mass, &change.com, &change.inertia, &change.place, &change.direction];
        assert!(changes.iter().all(|change| change.amount < 1e-15), "{change:?}");
        for (a, b) in robot.joints().iter().zip(even.joints()) {
            assert!((a.placement.rotation - b.placement.rotation).amax() < 1e-15);
            assert!((a.inertia.inertia - b.inertia.inertia).amax() < 1e-15);
        }
    }

    #[test]
    fn joints_that_are_no_pair_are_named() {
        let mut exchange = EXCHANGE;
        exchange[6].1 = 1.0;
        let error = biped(0.0).symmetrised(&exchange, &[]).unwrap_err().to_string();
        assert!(error.contains("'left_hip' and 'right_hip'") && error.contains("axes"), "{error}");
        let mut exchange = EXCHANGE;
        (exchange[6], exchange[8]) = ((6, 1.0), (8, 1.0));
        let error = biped(0.0).symmetrised(&exchange, &[]).unwrap_err().to_string();
        assert!(error.contains("_knee'") && error.contains("links that carry them"), "{error}");
    }
}
