//! Robots that stand on nothing but one floating joint: what moving the whole changes, and its momentum.

use super::{moving, retracted};
use costate::configuration::FreeKinematics;
use costate::derivative::largest;
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::Lagrangian;
use costate::robot::{Placement, Robot};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, flying_cases};
use costate_test_support::reference::flat;
use costate_test_support::rounding::{Bounds, InverseBounds, close, terms};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use num_dual::Dual64;
use proptest::prelude::*;

/// Where the floating joint stands.
fn base(case: &Case) -> Placement {
    Placement::from_xyz_rpy(case.parts[0].xyz, case.parts[0].rpy)
}

/// q after a rotation about the origin of the frame that the floating joint stands in, and a displacement.
fn moved(q: &[f64], turn: UnitQuaternion<f64>, by: Vector3<f64>) -> Vec<f64> {
    let of = UnitQuaternion::new_normalize(Quaternion::new(q[6], q[3], q[4], q[5]));
    let at = turn * Vector3::new(q[0], q[1], q[2]) + by;
    [at.as_slice(), (turn * of).coords.as_slice(), &q[7..]].concat()
}

/// F, F_x, y'F_xx, and a with a_z.
fn all(robot: &Robot, q: &[f64], case: &Case) -> [Vec<f64>; 5] {
    let p = case.p(robot);
    let mut second = HamiltonianSecondOrder::<f64>::new(robot);
    let contracted = second.contract(q, &p, &case.u, &case.y).unwrap();
    let linear = contracted.linearisation();
    let (f, f_x, y_f_xx) = (linear.f().to_vec(), flat(linear.matrix()), flat(contracted.matrix()));
    let mut lagrangian = Lagrangian::<f64>::new(robot);
    let linear = lagrangian.linearise_forward_dynamics(q, &case.v, &case.u).unwrap();
    [f, f_x, y_f_xx, linear.acceleration().to_vec(), flat(linear.matrix())]
}

properties! {
    64;

    /// Without gravity any motion of the whole; with gravity displacements, and turns about its direction.
    #[test]
    fn moving_the_whole_robot_changes_no_derivative(
        case in flying_cases(4),
        turn in prop::array::uniform3(-3.0..3.0_f64),
        by in prop::array::uniform3(-30.0..30.0_f64),
    ) {
        let robot = case.robot();
        let up = base(&case).rotation.transpose() * Vector3::from(case.gravity);
        let turn = Vector3::from(turn);
        let turn = if up.norm() > 0.0 { up.normalize() * turn.x } else { turn };
        let q = moved(&case.q, UnitQuaternion::from_scaled_axis(turn), by.into());
        let [f, f_x, y_f_xx, a, a_z] = all(&robot, &case.q, &case);
        let found = all(&robot, &q, &case);
        // At both places; that q is rounded where the robot has been moved to changes rotations as rounding
        // does.
        let at = |q: &[f64]| Bounds::new(&robot, [q, &case.v, &case.u, &case.y]);
        let bounds = at(&case.q).largest(at(&q));
        close("F", &found[0], &f, 2.0 * bounds.f)?;
        close("F_x", &found[1], &f_x, 2.0 * bounds.f_x)?;
        close("y'F_xx", &found[2], &y_f_xx, 2.0 * bounds.y_f_xx)?;
        close("a", &found[3], &a, 2.0 * bounds.a)?;
        close("a_z", &found[4], &a_z, 2.0 * bounds.a_z)?;
    }

    /// The map (q, p) to the momentum `(R l, R k + r x R l)` about the origin of the frame that the floating
    /// joint stands in: the momentum of all links, which gravity alone changes while nothing drives the base.
    #[test]
    fn the_momentum_of_the_whole_changes_by_gravity_alone(case in flying_cases(6)) {
        let (robot, n, q) = (case.robot(), case.n(), &case.q);
        let p = case.p(&robot);
        let momentum = |q: &[Dual64], p: &[Dual64]| -> [Vector3<Dual64>; 2] {
            let vector = |x: &[Dual64], k: usize| Vector3::new(x[k], x[k + 1], x[k + 2]);
            let (axis, two) = (vector(q, 3), Dual64::from_re(2.0));
            // R x = x + 2 w a x x + 2 a x (a x x) for the quaternion (a, w).
            let apply = |k: usize| {
                let across = axis.cross(&vector(p, k)) * two;
                vector(p, k) + across * q[6] + axis.cross(&across)
            };
            let linear = apply(0);
            [linear, apply(3) + vector(q, 0).cross(&linear)]
        };
        let mut u = case.u.clone();
        u[..6].fill(0.0);
        let f = Hamiltonian::<f64>::new(&robot).evaluate(q, &p, &u).unwrap().to_vec();
        let step = retracted(&robot, q, &moving(&vec![0.0; n], &f[..n]));
        let [linear, angular] = momentum(&step, &moving(&p, &f[n..]));
        let mut kinematics = FreeKinematics::<f64>::new(&robot);
        kinematics.set_state(q, &case.v).unwrap();
        let seen = base(&case);
        let here = |x: [f64; 3]| seen.rotation.transpose() * Vector3::from(x);
        let centre = kinematics.centre_of_mass().unwrap().position;
        let arm = here((Vector3::from(centre) - seen.translation).into());
        let of_links = kinematics.momentum().unwrap();
        let (expected, about_centre) = (here(of_links.linear), here(of_links.angular));
        let far = arm.norm().max(q[..3].iter().fold(1.0, |most: f64, q| most.max(q.abs())));
        let weight = here(case.gravity) * robot.joints().iter().map(|joint| joint.inertia.mass).sum::<f64>();
        // F is rounded; it turns momenta and changes them. Of the map itself there are fewer than 200
        // operations.
        let of_f = Bounds::new(&robot, [q, &case.v, &u, &case.y]).f;
        let of_p = InverseBounds::new(&robot, [q, &case.v, &case.v, &case.v]).p;
        let size = weight.norm() + largest(&p) * (1.0 + largest(&f));
        let bound = 6.0 * of_p * (1.0 + largest(&f)) + 6.0 * (1.0 + largest(&p)) * of_f + terms(200, &[size]);
        let re = |x: &Vector3<Dual64>| x.map(|x| x.re);
        let rate = |x: &Vector3<Dual64>| x.map(|x| x.eps);
        prop_assert!((re(&linear) - expected).amax() <= bound, "{linear} {expected}");
        let expected = about_centre + arm.cross(&expected);
        prop_assert!((re(&angular) - expected).amax() <= bound * far, "{angular} {expected}");
        prop_assert!((rate(&linear) - weight).amax() <= bound, "{linear} {weight}");
        let moment = arm.cross(&weight);
        prop_assert!((rate(&angular) - moment).amax() <= bound * far, "{angular} {moment}");
    }
}
