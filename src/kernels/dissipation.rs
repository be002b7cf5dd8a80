//! Joint friction and its derivatives.

use crate::robot::{Friction, Tree, scaled};
use crate::scalar::Scalar;

/// Friction of one joint and its first two derivatives in v.
#[derive(Clone, Copy, Debug)]
pub struct FrictionDerivatives<S> {
    /// D(v) (N m or N).
    pub value: S,
    /// dD/dv.
    pub first: S,
    /// d2D/dv2.
    pub second: S,
}

/// `D = -b v - c t`, `dD/dv = -b - c (1 - t^2) / s`, `d2D/dv2 = 2 c t (1 - t^2) / s^2` with
/// `t = tanh(v / s)`, viscous coefficient b, Coulomb limit c, transition velocity s.
#[inline]
pub fn friction<S: Scalar>(law: &Friction, v: S) -> FrictionDerivatives<S> {
    let mut d = FrictionDerivatives {
        value: v.times(-law.viscous),
        first: S::from_f64(-law.viscous),
        second: S::zero(),
    };
    if law.coulomb != 0.0 {
        let (limit, sharpness) = (law.coulomb, law.coulomb_velocity.recip());
        let (t, slope) = v.times(sharpness).tanh_and_slope();
        d.value -= t.times(limit);
        d.first -= slope.times(limit * sharpness);
        d.second = (t * slope).times(2.0 * limit * sharpness * sharpness);
    }
    d
}

/// Friction of coordinate i at its velocity v: with `v_j = g_j v` of its joints, `sum g_j D_j(g_j v)`,
/// `sum g_j^2 D'_j`, `sum g_j^3 D''_j`.
#[inline]
pub(crate) fn friction_of<S: Scalar>(tree: &Tree, i: usize, v: S) -> FrictionDerivatives<S> {
    let Some(map) = tree.joint_map() else { return friction(&tree.joints()[i].friction, v) };
    let mut sum = FrictionDerivatives { value: S::zero(), first: S::zero(), second: S::zero() };
    for &j in map.joints_of(i) {
        let (law, g) = (&tree.joints()[j].friction, map.rows()[j].ratio);
        let of_joint = friction(law, scaled(g, v));
        sum.value += scaled(g, of_joint.value);
        sum.first += scaled(g * g, of_joint.first);
        sum.second += scaled(g * g * g, of_joint.second);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{friction, friction_of};
    use crate::robot::{Friction, JointSpec, LinkInertia, Robot, Tree};
    use num_dual::Dual2_64;

    #[test]
    fn derivatives_are_those_of_the_law() {
        let law = Friction { viscous: 0.7, coulomb: 3.0, coulomb_velocity: 0.25 };
        for v in [-1e6, -3.0, -0.1, 0.0, 1e-9, 0.2, 5.0] {
            let hand = friction(&law, v);
            let dual = friction(&law, Dual2_64::from_re(v).derivative()).value;
            for (hand, dual) in [(hand.value, dual.re), (hand.first, dual.v1), (hand.second, dual.v2)] {
                assert!((hand - dual).abs() <= 1e-14 * dual.abs(), "at {v}: {hand} is not {dual}");
            }
            assert!(hand.value * v <= 0.0, "friction never drives");
        }
    }

    #[test]
    fn friction_of_mimic_joints_adds_up() {
        let link = LinkInertia::about_com(1.0, [0.1, 0.0, 0.2], nalgebra::Matrix3::identity());
        let laws = [0.3, 0.0, 0.9].map(|coulomb| Friction { viscous: 0.4, coulomb, coulomb_velocity: 0.5 });
        let joint = |name: &str, law: usize| JointSpec::revolute(name).carrying(link).friction(laws[law]);
        let robot = Robot::builder("mimics")
            .joint(joint("a", 0))
            .joint(joint("b", 1).on("a"))
            .joint(joint("c", 2).on("b").mimicking("a", -1.5, 0.1))
            .build()
            .unwrap();
        let tree = Tree::from(&robot);
        for v in [-3.0, 0.2] {
            let power = |v: Dual2_64| {
                let [a, c] = [(0, 1.0), (2, -1.5)].map(|(law, g)| friction(&laws[law], v * g).value * g);
                a + c
            };
            let (hand, dual) = (friction_of(&tree, 0, v), power(Dual2_64::from_re(v).derivative()));
            for (hand, dual) in [(hand.value, dual.re), (hand.first, dual.v1), (hand.second, dual.v2)] {
                assert!((hand - dual).abs() <= 1e-14 * dual.abs(), "at {v}: {hand} is not {dual}");
            }
            assert_eq!(friction_of(&tree, 1, v).value, friction(&laws[1], v).value);
        }
    }
}
