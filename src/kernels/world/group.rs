//! Joints side by side in the lanes of packs.

use crate::robot::{JointFrame, JointKind};
use crate::scalar::{Pack, Scalar, inlined};
use crate::spatial::{Force, Motion, Symmetric3, Vec3};

/// Inertia of a body about the origin of its joint, whose mass is a number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<P> {
    pub mass: P,
    pub first_moment: Vec3<P>,
    pub matrix: Symmetric3<P>,
}

impl<P: Scalar> Body<P> {
    pub fn zero() -> Self {
        Self { mass: P::zero(), first_moment: Vec3::zero(), matrix: Symmetric3::zero() }
    }

    /// Momentum of the body in the motion, as [`Inertia::apply`](crate::spatial::Inertia::apply).
    #[inline(always)]
    pub fn apply(&self, motion: Motion<P>) -> Force<P> {
        inlined!(P, {
            let (w, v, h) = (motion.angular, motion.linear, self.first_moment);
            Force {
                moment: self.matrix.apply(w).plus_product(h, v),
                force: w.cross(h).plus_scaled(v, self.mass),
            }
        })
    }
}

/// Constants of the links of one group, in their own frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct Links<P> {
    /// First moment and mass of the links, with regrouped parameters.
    pub first_moment: Vec3<P>,
    pub mass: P,
    /// `J = yy + x p' + p x' + z g' + g z'`: the components of p, and y and z of g.
    pub across_x: Vec3<P>,
    pub across_z: [P; 2],
    pub spherical: P,
    /// Mass of the composite bodies.
    pub composite_mass: P,
}

/// Motions, bodies and forces of the joints of one group, about their origins, in the axes of the world.
///
/// Lanes without a joint are zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group<P> {
    /// Axes of the joint frames.
    pub axes: [Vec3<P>; 3],
    /// S: the joint axis is its angular part for a revolute joint, its linear part for a prismatic one.
    pub axis: Motion<P>,
    pub velocity: Motion<P>,
    pub acceleration: Motion<P>,
    /// `psi = v x S`.
    pub psi: Motion<P>,
    /// `v x psi + a x S`.
    pub psi_rate: Motion<P>,
    /// psi and the rate of S: `2 psi` for joints of one degree of freedom.
    pub drift: Motion<P>,
    /// The link.
    pub body: Body<P>,
    /// The composite body, its momentum, the force on it and the rate of its inertia matrix.
    pub composite: Body<P>,
    pub momentum: Force<P>,
    pub force: Force<P>,
    pub rate: Symmetric3<P>,
}

/// The forces of which every entry is a scalar product, about the origins of their joints.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried<P> {
    /// Origin of the joint, seen from that of the first revolute joint of its branch.
    pub origin: Vec3<P>,
    /// F.
    pub inertial: Force<P>,
    /// The moment E; its force is zero.
    pub turning: Vec3<P>,
    /// A.
    pub by_position: Force<P>,
    /// C.
    pub by_velocity: Force<P>,
}

impl<P: Scalar> Carried<P> {
    pub fn zero() -> Self {
        let (none, slack) = (Vec3::zero(), Force::zero());
        Self { origin: none, inertial: slack, turning: none, by_position: slack, by_velocity: slack }
    }
}

impl<P: Scalar> Group<P> {
    pub fn zero() -> Self {
        let (none, still, slack) = (Vec3::zero(), Motion::zero(), Force::zero());
        let body = Body::zero();
        Self {
            axes: [none; 3],
            axis: still,
            velocity: still,
            acceleration: still,
            psi: still,
            psi_rate: still,
            drift: still,
            body,
            composite: body,
            momentum: slack,
            force: slack,
            rate: Symmetric3::zero(),
        }
    }

    /// The links of the group in the axes of the world.
    #[inline(always)]
    pub fn turn_links(&mut self, links: &Links<P>) {
        let [x, y, z] = self.axes;
        let along = |a: Vec3<P>| x.scaled(a.x).plus_scaled(y, a.y).plus_scaled(z, a.z);
        let p = along(links.across_x);
        let g = y.scaled(links.across_z[0]).plus_scaled(z, links.across_z[1]);
        let twice = |a: P| a + a;
        let both = |[xa, pa, za, ga]: [P; 4], [xb, pb, zb, gb]: [P; 4]| {
            xa.mul_add(pb, pa.mul_add(xb, za.mul_add(gb, ga * zb)))
        };
        let [a, b, c] = [[x.x, p.x, z.x, g.x], [x.y, p.y, z.y, g.y], [x.z, p.z, z.z, g.z]];
        let own = |[x, p, z, g]: [P; 4]| twice(x.mul_add(p, z * g)) + links.spherical;
        let matrix =
            Symmetric3 { xx: own(a), yy: own(b), zz: own(c), xy: both(a, b), xz: both(a, c), yz: both(b, c) };
        self.body = Body { mass: links.mass, first_moment: along(links.first_moment), matrix };
    }
}

impl<P: Scalar> Links<P> {
    /// Of up to as many joints as a pack has lanes.
    pub fn new<S: Scalar>(joints: &[&JointFrame]) -> Self
    where
        P: Pack<S>,
    {
        let read = |value: &dyn Fn(&JointFrame) -> f64| {
            let mut pack = P::zero();
            for (lane, joint) in joints.iter().enumerate() {
                pack.set_lane(lane, S::from_f64(value(joint)));
            }
            pack
        };
        let moment = |k: usize| read(&move |joint| joint.lumped.first_moment[k]);
        let entry = |k: usize| read(&move |joint| joint.lumped.matrix[k]);
        let less_yy = |k: usize| read(&move |joint| 0.5 * (joint.lumped.matrix[k] - joint.lumped.matrix[1]));
        Self {
            first_moment: Vec3::new(moment(0), moment(1), moment(2)),
            mass: read(&|joint| joint.lumped.mass),
            across_x: Vec3::new(less_yy(0), entry(3), entry(4)),
            across_z: [entry(5), less_yy(2)],
            spherical: entry(1),
            composite_mass: read(&|joint| joint.lumped_mass),
        }
    }
}

/// A joint axis as S.
#[inline(always)]
pub(super) fn motion_along<S: Scalar>(kind: JointKind, axis: Vec3<S>) -> Motion<S> {
    match kind {
        JointKind::Revolute => Motion { angular: axis, linear: Vec3::zero() },
        JointKind::Prismatic => Motion { angular: Vec3::zero(), linear: axis },
    }
}

/// `S . f` for the axis of a joint.
#[inline(always)]
pub(super) fn along_axis<S: Scalar>(kind: JointKind, axis: Vec3<S>, force: &Force<S>) -> S {
    match kind {
        JointKind::Revolute => axis.dot(force.moment),
        JointKind::Prismatic => axis.dot(force.force),
    }
}

/// The vectors in lane `k`.
#[inline(always)]
pub(super) fn motion_lane<S: Scalar, P: Pack<S>>(motion: &Motion<P>, k: usize) -> Motion<S> {
    Motion { angular: motion.angular.lane(k), linear: motion.linear.lane(k) }
}

#[inline(always)]
pub(super) fn set_motion<S: Scalar, P: Pack<S>>(motion: &mut Motion<P>, k: usize, value: Motion<S>) {
    motion.angular.set_lane(k, value.angular);
    motion.linear.set_lane(k, value.linear);
}

/// The vectors in lane `k`.
#[inline(always)]
pub(super) fn force_lane<S: Scalar, P: Pack<S>>(force: &Force<P>, k: usize) -> Force<S> {
    Force { moment: force.moment.lane(k), force: force.force.lane(k) }
}

/// Adds a force to lane `k`.
#[inline(always)]
pub(super) fn add_force<S: Scalar, P: Pack<S>>(force: &mut Force<P>, k: usize, value: Force<S>) {
    let sum = force_lane(force, k) + value;
    force.moment.set_lane(k, sum.moment);
    force.force.set_lane(k, sum.force);
}

/// The matrix in lane `k`.
#[inline(always)]
pub(super) fn matrix_lane<S: Scalar, P: Pack<S>>(matrix: &Symmetric3<P>, k: usize) -> Symmetric3<S> {
    let Symmetric3 { xx, yy, zz, xy, xz, yz } = matrix;
    let lane = |pack: &P| pack.lane(k);
    Symmetric3 { xx: lane(xx), yy: lane(yy), zz: lane(zz), xy: lane(xy), xz: lane(xz), yz: lane(yz) }
}

/// Adds a matrix to lane `k`.
#[inline(always)]
pub(super) fn add_matrix<S: Scalar, P: Pack<S>>(matrix: &mut Symmetric3<P>, k: usize, value: &Symmetric3<S>) {
    let add = |pack: &mut P, term: S| pack.set_lane(k, pack.lane(k) + term);
    add(&mut matrix.xx, value.xx);
    add(&mut matrix.yy, value.yy);
    add(&mut matrix.zz, value.zz);
    add(&mut matrix.xy, value.xy);
    add(&mut matrix.xz, value.xz);
    add(&mut matrix.yz, value.yz);
}
