//! Augmented bodies and the global inertia tensors of a joint about its own origin.

use crate::robot::Tree;
use crate::scalar::Scalar;
use crate::spatial::{JointPosition, Symmetric3, Transform, Vec3};

/// `pi*_j = m_j OG_j + sum M_c Lambda_jc`, `K*_j = K_j + sum M_c Lambda_jc (x) Lambda_jc` over the children c
/// of j: the link with, at the origin of each child joint, all the mass beyond it; in frame j.
///
/// Lambda is taken at q = 0 of a prismatic child, so that these are constants; [`Body::moved_up`] adds the
/// effect of its q.
#[derive(Clone, Copy, Debug)]
pub(super) struct AugmentedBody {
    first_moment: [f64; 3],
    /// xx, yy, zz, xy, xz, yz.
    tensor: [f64; 6],
}

impl AugmentedBody {
    /// The augmented bodies of all links; `origins[c]` is the origin of frame c with q_c = 0, in the frame of
    /// its parent.
    pub fn of_links(tree: &Tree, origins: &[[f64; 3]]) -> Vec<Self> {
        let link = |j: usize| {
            let inertia = &tree.joints()[j].inertia;
            let [xx, yy, zz, xy, xz, yz] = inertia.matrix;
            let half = 0.5 * (xx + yy + zz);
            let mut body = Self {
                first_moment: inertia.first_moment,
                tensor: [half - xx, half - yy, half - zz, -xy, -xz, -yz],
            };
            for &c in tree.children(j) {
                let (mass, [x, y, z]) = (tree.joints()[c].subtree_mass, origins[c]);
                for (sum, term) in body.first_moment.iter_mut().zip([x, y, z]) {
                    *sum += mass * term;
                }
                for (sum, term) in body.tensor.iter_mut().zip([x * x, y * y, z * z, x * y, x * z, y * z]) {
                    *sum += mass * term;
                }
            }
            body
        };
        (0..tree.joints().len()).map(link).collect()
    }

    /// The same as scalars.
    pub fn lift<S: Scalar>(&self) -> Body<S> {
        let [xx, yy, zz, xy, xz, yz] = self.tensor.map(S::from_f64);
        Body {
            first_moment: Vec3::constant(self.first_moment),
            tensor: Symmetric3 { xx, yy, zz, xy, xz, yz },
        }
    }
}

/// `Pi_jj = int O_jP dm` (kg m) and `L_jj = int O_jP (x) O_jP dm` (kg m^2) over all that joint j moves, in
/// frame j.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<S> {
    pub first_moment: Vec3<S>,
    pub tensor: Symmetric3<S>,
}

impl<S: Scalar> Body<S> {
    /// The terms of a child joint in (66), (67), `Pi_cc` and `L_cc + Lambda (x) Pi_cc + Pi_cc (x) Lambda`, in
    /// the frame of its parent.
    ///
    /// A prismatic joint first moves its body along its z axis by q: `Pi + M q e_z`,
    /// `L + q (e_z (x) Pi + Pi (x) e_z) + M q^2 e_z (x) e_z`.
    #[inline]
    pub fn moved_up(mut self, transform: &Transform<'_, S>, mass: f64) -> Self {
        let (p, l) = (&mut self.first_moment, &mut self.tensor);
        match &transform.joint {
            JointPosition::Rotated(turn) => {
                [p.x, p.y] = turn.apply([p.x, p.y]);
                *l = l.rotated_about_z(turn);
                let rise = transform.fixed.rise;
                l.zz += p.z.times(2.0 * rise);
                l.xz += p.x.times(rise);
                l.yz += p.y.times(rise);
            }
            &JointPosition::Translated(distance) => {
                let moved = distance.times(mass);
                l.zz += distance * (p.z + p.z + moved);
                l.xz += distance * p.x;
                l.yz += distance * p.y;
                p.z += moved;
            }
            JointPosition::Oriented(orientation) => {
                let rotation = orientation.rotation();
                (*p, *l) = (rotation.apply(*p), rotation.congruence(l));
            }
        }
        [p.y, p.z] = transform.fixed.alpha.apply([p.y, p.z]);
        *l = l.rotated_about_x_constant(&transform.fixed.alpha);
        let [x, y, z] = transform.fixed.translation;
        l.xx += p.x.times(2.0 * x);
        l.yy += p.y.times(2.0 * y);
        l.zz += p.z.times(2.0 * z);
        l.xy += p.x.times(y) + p.y.times(x);
        l.xz += p.x.times(z) + p.z.times(x);
        l.yz += p.y.times(z) + p.z.times(y);
        if let Some(gamma) = &transform.fixed.gamma {
            [p.x, p.y] = gamma.apply([p.x, p.y]);
            *l = l.rotated_about_z_constant(gamma);
        }
        self
    }

    /// Adds another body in the same frame.
    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.first_moment = self.first_moment + other.first_moment;
        self.tensor += other.tensor;
    }
}
