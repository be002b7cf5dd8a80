//! Wrenches from outside: every quantity with them against automatic differentiation of the same pipeline,
//! and against the same generalised force given as actuation.

use crate::lagrangian::{separate_calls_agree, torque_hessian};
use costate::derivative::{ForwardDynamics, Hessian, Jacobian, PhaseVelocity};
use costate::hamiltonian::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
use costate::kinematics::{ExternalForces, Kinematics, ReferenceFrame};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder, LegendreTransform};
use costate::matrix::Matrix;
use costate::robot::{FrameSpec, JointSpec, LinkInertia, Placement, Robot, Wrench, WrenchAxes};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases, difference};
use costate_test_support::reach::Reach;
use costate_test_support::reference::flat;
use costate_test_support::rounding::{At, Bounds, InverseBounds, close};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

const AXES: [(WrenchAxes, ReferenceFrame); 2] =
    [(WrenchAxes::Local, ReferenceFrame::Local), (WrenchAxes::Aligned, ReferenceFrame::LocalWorldAligned)];

/// A robot with wrenches of both kinds, on its last link and on its first.
fn loaded(case: &Case) -> Robot {
    let on_last = Placement::from_xyz_rpy([0.3, -0.2, 0.5], [0.4, -1.0, 2.0]);
    let tool = FrameSpec::new("tool").on(format!("j{}", case.parts.len() - 1)).placed(on_last);
    let [a, b, c] = [case.y[0], case.u[0], case.y[1]];
    let follower = Wrench { moment: [2.0, b, -a], force: [c, -3.0, 1.5], axes: WrenchAxes::Local };
    let dead = Wrench { moment: [c, 1.0, a], force: [4.0, a, b], axes: WrenchAxes::Aligned };
    let robot = case.robot().with_frame(tool).unwrap();
    let robot = robot.with_wrench("tool", follower).unwrap().with_wrench("tool", dead).unwrap();
    robot.with_wrench("j0", dead).unwrap()
}

/// The sum of `J'W` by Jacobians.
fn generalised_force(robot: &Robot, q: &[f64]) -> DVector<f64> {
    let mut kinematics = Kinematics::<f64>::new(robot);
    kinematics.set_position(q).unwrap();
    robot.wrenches().iter().fold(DVector::zeros(q.len()), |sum, applied| {
        let (_, axes) = AXES.into_iter().find(|(axes, _)| *axes == applied.wrench.axes).unwrap();
        let jacobian = kinematics.jacobian(applied.frame, axes).unwrap().view().to_nalgebra();
        let both = [applied.wrench.moment, applied.wrench.force].concat();
        sum + jacobian.transpose() * DVector::from_vec(both)
    })
}

fn matrix(flat: &Matrix<f64>) -> DMatrix<f64> {
    flat.view().to_nalgebra()
}

properties! {
    64;

    #[test]
    fn in_momenta_all_derivatives_are_those_of_automatic_differentiation(case in cases(4)) {
        let robot = loaded(&case);
        let (n, x, y) = (case.n(), case.x(&robot), &case.y);
        let (q, p) = x.split_at(n);
        let d = [&case.v[..], &case.u[..]].concat();
        let bounds = Bounds::at(&robot, At { q, v: &case.v, u: &case.u, y, d: &d });
        let mut function = PhaseVelocity::new(&robot);
        function.u.copy_from_slice(&case.u);
        let mut first: Jacobian<_> = Jacobian::new(function.clone());
        let mut second = Hessian::new(function);
        let expected = first.linearise(&x).unwrap();
        let curvature = second.contract(&x, y).unwrap().as_slice();
        let mut analytic = HamiltonianSecondOrder::<f64>::new(&robot);
        let found = analytic.contract(q, p, &case.u, y).unwrap();
        close("F", found.linearisation().f(), expected.value, bounds.f)?;
        close("F_x", &flat(found.linearisation().matrix()), expected.jacobian.as_slice(), bounds.f_x)?;
        close("y'F_xx", &flat(found.matrix()), curvature, bounds.y_f_xx)?;
        let product = analytic.hessian_product(q, p, y, &d).unwrap();
        let whole = DMatrix::from_row_slice(2 * n, 2 * n, curvature);
        close("y'F_xx d", product, (&whole * DVector::from_vec(d)).as_slice(), bounds.product.max(2.0 * n as f64 * bounds.y_f_xx))?;
        let adjoint = analytic.first().adjoint(q, p, &case.u, y).unwrap();
        let f_x = DMatrix::from_row_slice(2 * n, 2 * n, expected.jacobian.as_slice());
        let pulled = f_x.transpose() * DVector::from_column_slice(y);
        close("F of the adjoint", adjoint.f, expected.value, bounds.f)?;
        close("y'F_x", adjoint.y_f_x, pulled.as_slice(), bounds.y_f_x.max(2.0 * n as f64 * bounds.f_x))?;
        let mut dual = DualPass::<f64>::new(&robot);
        let found = dual.contract(q, p, &case.u, y).unwrap();
        close("F by a dual pass", found.linearisation().f(), expected.value, bounds.f)?;
        close("F_x by a dual pass", &flat(found.linearisation().matrix()), expected.jacobian.as_slice(), bounds.f_x)?;
        close("y'F_xx by a dual pass", &flat(found.matrix()), curvature, bounds.y_f_xx)?;
        let mut tensor = FullHessian::<f64>::new(&robot);
        let mut contracted = Matrix::zeros(2 * n, 2 * n);
        tensor.hessian_tensor(q, p).unwrap().contract(y, &mut contracted).unwrap();
        close("y'F_xx by the tensor", contracted.as_slice(), curvature, bounds.y_f_xx)?;
    }

    #[test]
    fn in_velocities_all_derivatives_are_those_of_automatic_differentiation(case in cases(4)) {
        let robot = loaded(&case);
        let n = case.n();
        let (q, v, u) = (&case.q[..], &case.v[..], &case.u[..]);
        let bounds = Bounds::new(&robot, [q, v, u, &case.y]);
        let (z, y) = ([q, v, u].concat(), &case.y[n..]);
        let mut first: Jacobian<_> = Jacobian::new(ForwardDynamics::new(&robot));
        let mut second = Hessian::new(ForwardDynamics::new(&robot));
        let expected = first.linearise(&z).unwrap();
        let curvature = second.contract(&z, y).unwrap().as_slice();
        let mut analytic = LagrangianSecondOrder::<f64>::new(&robot);
        let found = analytic.contract_forward_dynamics(q, v, u, y).unwrap();
        close("a", found.forward_dynamics().acceleration(), expected.value, bounds.a)?;
        close("a_z", &flat(found.forward_dynamics().matrix()), expected.jacobian.as_slice(), bounds.a_z)?;
        close("y'a_zz", found.to_matrix().as_slice(), curvature, bounds.y_a_zz)?;
        let linear = analytic.first().linearise_forward_dynamics(q, v, u).unwrap();
        close("a_z alone", &flat(linear.matrix()), expected.jacobian.as_slice(), bounds.a_z)?;
        let lagrangian = analytic.first();
        let mut w = y.to_vec();
        lagrangian.solve_mass_matrix(q, &mut w).unwrap();
        let (mut f, mut product) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
        lagrangian.adjoint_factored([q, v, u, &w], &mut f, &mut product).unwrap();
        let a_z = DMatrix::from_row_slice(n, 3 * n, expected.jacobian.as_slice());
        let pulled = a_z.columns(0, 2 * n).transpose() * DVector::from_column_slice(y);
        // y'a_z is the sum of n products of entries of y, at most 1, with such of a_z.
        close("y'a_z", &product, pulled.as_slice(), bounds.y_a_z.max(n as f64 * bounds.a_z))?;
        // The error of a comes back as M times it.
        let a = expected.value.to_vec();
        let m = lagrangian.mass_matrix(q).unwrap().view().to_nalgebra();
        let of_a = n as f64 * m.amax() * bounds.a;
        let of_tau = InverseBounds::new(&robot, [q, v, &a, u]).tau;
        close("tau", lagrangian.inverse_dynamics(q, v, &a).unwrap(), u, of_a + of_tau)?;
        let mut transform = LegendreTransform::<f64>::new(&robot);
        let mut map = transform.at(q, v, u).unwrap();
        let f_x = flat(map.hamiltonian().f_x.view());
        let p = map.momentum().to_vec();
        let direct = flat(Hamiltonian::<f64>::new(&robot).linearise(q, &p, u).unwrap().matrix());
        close("F_x from a_z", &f_x, &direct, bounds.f_x.max(n as f64 * m.amax() * bounds.a_z))?;
    }

    #[test]
    fn derivatives_of_inverse_dynamics_are_those_of_automatic_differentiation(case in cases(4)) {
        let (robot, n) = (loaded(&case), case.n());
        let (q, v, a, w) = (&case.q[..], &case.v[..], &case.y[n..], &case.u[..]);
        separate_calls_agree(&robot, [q, v, a, w])?;
        let mut second = LagrangianSecondOrder::<f64>::new(&robot);
        let found = matrix(second.contract_inverse_dynamics(q, v, a, w).unwrap().zz());
        let expected = torque_hessian(&robot, &[q, v, a].concat(), w);
        let bound = InverseBounds::new(&robot, [q, v, a, w]).w_tau_zz;
        close("w'tau_zz", found.as_slice(), expected.as_slice(), bound)?;
    }

    #[test]
    fn a_wrench_acts_as_its_generalised_force_does(case in cases(4)) {
        let robot = loaded(&case);
        let bare = case.robot();
        let (q, v, u) = (&case.q[..], &case.v[..], &case.u[..]);
        let force = generalised_force(&robot, q);
        let pushed: Vec<f64> = u.iter().zip(&force).map(|(u, force)| u + force).collect();
        // The one robot adds J'W to u beforehand, the other one on its way.
        let bounds = Bounds::new(&robot, [q, v, u, &case.y]).largest(Bounds::new(&bare, [q, v, &pushed, &case.y]));
        let found = Lagrangian::<f64>::new(&robot).forward_dynamics(q, v, u).unwrap().to_vec();
        let mut without = Lagrangian::<f64>::new(&bare);
        let expected = without.forward_dynamics(q, v, &pushed).unwrap();
        close("a", &found, expected, bounds.a)?;
        let p = case.p(&bare);
        let found = Hamiltonian::<f64>::new(&robot).evaluate(q, &p, u).unwrap().to_vec();
        let mut without = Hamiltonian::<f64>::new(&bare);
        close("F", &found, without.evaluate(q, &p, &pushed).unwrap(), bounds.f)?;
        // The same wrenches, set later.
        let none = Wrench::default();
        let robot_of_none = robot.wrenches().iter().fold(robot.without_wrenches(), |robot, applied| {
            let frame = robot.frames()[applied.frame].name.clone();
            robot.with_wrench(&frame, Wrench { axes: applied.wrench.axes, ..none }).unwrap()
        });
        let mut later = Hamiltonian::<f64>::new(&robot_of_none);
        for (k, applied) in robot.wrenches().iter().enumerate() {
            later.set_wrench(k, &applied.wrench.moment, &applied.wrench.force).unwrap();
        }
        prop_assert_eq!(later.evaluate(q, &p, u).unwrap(), &found[..]);
        let mut transform = LegendreTransform::<f64>::new(&robot_of_none);
        for (k, applied) in robot.wrenches().iter().enumerate() {
            transform.set_wrench(k, &applied.wrench.moment, &applied.wrench.force).unwrap();
        }
        let changed = transform.at(q, v, u).unwrap().lagrangian().f.to_vec();
        let mut loaded = Lagrangian::<f64>::new(&robot);
        close("f", &changed, loaded.evaluate(q, v, u).unwrap(), bounds.a)?;
        let mut external = ExternalForces::<f64>::new(&robot);
        // An arm times a force, and a moment, of each wrench.
        let applied = robot.wrenches().iter().map(|applied| applied.wrench);
        let size: f64 = applied.flat_map(|wrench| [wrench.moment, wrench.force]).flatten().map(f64::abs).sum();
        let bound = size * Reach::of_case(&robot, &case).position(1);
        close("J'W", external.evaluate(q).unwrap(), force.as_slice(), bound)?;
    }

    #[test]
    fn a_force_in_axes_of_the_world_is_the_gradient_of_its_work(case in cases(4)) {
        let robot = case.robot();
        let frame = format!("j{}", case.n() - 1);
        let pull = Wrench { force: [case.y[0], -2.0, 1.0], axes: WrenchAxes::Aligned, ..Wrench::default() };
        let robot = robot.with_wrench(&frame, pull).unwrap();
        let mut external = ExternalForces::<f64>::new(&robot);
        let slope = matrix(external.jacobian(&case.q).unwrap());
        let size: f64 = pull.force.iter().map(|force| force.abs()).sum();
        let bound = size * Reach::of_case(&robot, &case).position(2);
        close("(J'W)_q, transposed", slope.as_slice(), slope.transpose().as_slice(), bound)?;
        let mut kinematics = Kinematics::<f64>::new(&robot);
        kinematics.set_position(&case.q).unwrap();
        let index = robot.frame_index(&frame).unwrap();
        let hessian = matrix(kinematics.position_hessian(index, &pull.force).unwrap());
        close("(J'W)_q", slope.as_slice(), hessian.as_slice(), bound)?;
    }
}

#[test]
fn bad_wrenches_are_refused() {
    let robot = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/ur5.urdf")).unwrap();
    let error = robot.with_wrench("tol0", Wrench::default()).unwrap_err().to_string();
    assert!(error.contains("'tool0'"), "{error}");
    let bad = Wrench { force: [f64::NAN, 0.0, 0.0], ..Wrench::default() };
    assert!(robot.with_wrench("tool0", bad).unwrap_err().to_string().contains("'tool0'"));
    let mut none = Hamiltonian::<f64>::new(&robot);
    assert!(none.set_wrench(0, &[0.0; 3], &[0.0; 3]).is_err());
    let mut one = Lagrangian::<f64>::new(&robot.with_wrench("tool0", Wrench::default()).unwrap());
    assert!(one.set_wrench(1, &[0.0; 3], &[0.0; 3]).is_err());
    assert!(one.set_wrench(0, &[0.0; 3], &[f64::INFINITY, 0.0, 0.0]).is_err());
    assert!(one.set_wrench(0, &[1.0; 3], &[0.0; 3]).is_ok());
    let loaded = robot.with_wrench("tool0", Wrench::default()).unwrap();
    let mut external = ExternalForces::<f64>::new(&loaded);
    assert!(external.evaluate(&[0.0; 5]).is_err() && external.jacobian(&[f64::NAN; 6]).is_err());
    assert!(
        external.hessian(&[0.0; 6], &[0.0; 7]).is_err() && external.hessian(&[0.0; 6], &[0.0; 6]).is_ok()
    );
}

#[test]
fn a_wrench_on_the_world_changes_nothing() {
    let robot = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/ur5.urdf")).unwrap();
    let fixed = robot.with_wrench("world", Wrench { force: [1.0; 3], ..Wrench::default() }).unwrap();
    let (q, v, u) = ([0.3; 6], [0.2; 6], [0.1; 6]);
    let expected = Lagrangian::<f64>::new(&robot).forward_dynamics(&q, &v, &u).unwrap().to_vec();
    assert_eq!(Lagrangian::<f64>::new(&fixed).forward_dynamics(&q, &v, &u).unwrap(), expected);
}

/// A tree of n joints: a spine with a branch at every fourth joint.
fn tree(n: usize) -> Robot {
    let wave = |k: usize, shift: f64| (1.7 * k as f64 + shift).sin();
    let body = |k: usize| {
        let com = [0.2 * wave(k, 0.1), 0.3 * wave(k, 1.0), 0.1];
        LinkInertia::about_com(1.0 + 0.5 * wave(k, 2.0), com, nalgebra::Matrix3::identity() * 0.1)
    };
    let spec = |k: usize| {
        let xyz = [0.3 * wave(k, 3.0), -0.2, 0.4 * wave(k, 0.4)];
        let placed = Placement::from_xyz_rpy(xyz, [wave(k, 0.7), 2.0 * wave(k, 4.0), 0.3]);
        let joint = if k % 5 == 3 {
            JointSpec::prismatic(format!("j{k}"))
        } else {
            JointSpec::revolute(format!("j{k}"))
        };
        let parent = if k % 4 == 2 { k - 2 } else { k.max(1) - 1 };
        let joint = joint.placed(placed).carrying(body(k));
        if k == 0 { joint } else { joint.on(format!("j{parent}")) }
    };
    (0..n).fold(Robot::builder("tree"), |builder, k| builder.joint(spec(k))).build().unwrap()
}

/// Robots of every size take another algorithm: products in registers, in blocks, articulated bodies.
#[test]
fn on_robots_of_every_size_wrenches_act_as_actuation_that_depends_on_q() {
    for n in [3, 7, 13, 18, 25, 40] {
        let bare = tree(n);
        let pull = |axes, size: f64| Wrench { moment: [size, -1.0, 0.5], force: [3.0, size, -4.0], axes };
        let robot = bare.with_wrench(&format!("j{}", n - 1), pull(WrenchAxes::Local, 2.0)).unwrap();
        let robot = robot.with_wrench(&format!("j{}", n / 2), pull(WrenchAxes::Aligned, -5.0)).unwrap();
        let values =
            |shift: f64, count: usize| (0..count).map(|k| (1.3 * k as f64 + shift).cos()).collect::<Vec<_>>();
        let (q, v, u, y) = (values(0.1, n), values(0.9, n), values(2.0, n), values(3.0, 2 * n));
        let mut external = ExternalForces::<f64>::new(&robot);
        let force = external.evaluate(&q).unwrap().to_vec();
        let force_q = matrix(external.jacobian(&q).unwrap());
        let force_qq = matrix(external.hessian(&q, &y[n..]).unwrap());
        let pushed: Vec<f64> = u.iter().zip(&force).map(|(u, force)| u + force).collect();
        let tolerance = 1e-10;
        let p = Hamiltonian::<f64>::new(&bare).momentum(&q, &v).unwrap().to_vec();
        let [mut ours, mut theirs] = [&robot, &bare].map(HamiltonianSecondOrder::<f64>::new);
        let expected = theirs.contract(&q, &p, &pushed, &y).unwrap();
        let found = ours.contract(&q, &p, &u, &y).unwrap();
        assert!(difference(found.linearisation().f(), expected.linearisation().f()) < tolerance, "F, {n}");
        let mut f_x = expected.linearisation().matrix().to_nalgebra();
        f_x.view_mut((n, 0), (n, n)).zip_apply(&force_q, |entry, slope| *entry += slope);
        let f_x_found = found.linearisation().matrix().to_nalgebra();
        assert!(difference(f_x_found.as_slice(), f_x.as_slice()) < tolerance, "F_x, {n}");
        let mut y_f_xx = expected.matrix().to_nalgebra();
        y_f_xx.view_mut((0, 0), (n, n)).zip_apply(&force_qq, |entry, slope| *entry += slope);
        let y_f_xx_found = found.matrix().to_nalgebra();
        assert!(difference(y_f_xx_found.as_slice(), y_f_xx.as_slice()) < tolerance, "y'F_xx, {n}");
        let [mut ours, mut theirs] = [&robot, &bare].map(Lagrangian::<f64>::new);
        let alone = ours.forward_dynamics(&q, &v, &u).unwrap().to_vec();
        let expected = theirs.linearise_forward_dynamics(&q, &v, &pushed).unwrap();
        let found = ours.linearise_forward_dynamics(&q, &v, &u).unwrap();
        assert!(difference(&alone, expected.acceleration()) < tolerance, "a alone, {n}");
        assert!(difference(found.acceleration(), expected.acceleration()) < tolerance, "a, {n}");
        let a_q = expected.a_q().to_nalgebra() + expected.a_u().to_nalgebra() * &force_q;
        assert!(difference(found.a_q().to_nalgebra().as_slice(), a_q.as_slice()) < tolerance, "a_q, {n}");
    }
}
