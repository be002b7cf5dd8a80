//! Relations between derivatives by parameters, and with other robots, for every kind of parameter.

use super::{
    column, everything, everything_with_wrenches, last, of_regressor, of_state_equation, times, tool,
};
use costate::lagrangian::Lagrangian;
use costate::parameters::{
    DisplacedIn, Displacement, HamiltonianParameters, Parameter, ParameterSet, Regressor,
};
use costate::robot::{LinkInertia, Robot};
use costate::scalar::{Scalar, Tangent};
use costate_test_support::random_robot::{Case, all_cases, cases};
use costate_test_support::rounding::{InverseBounds, apart, close, lift, moving, times as product};
use costate_test_support::{properties, rounding};
use nalgebra::{DVector, Matrix3, Vector3};
use num_dual::Dual64;
use proptest::prelude::*;

/// The same joints with other masses, friction limits, stiffness and armature: all that is linear.
fn with_other_values(case: &Case) -> Case {
    let mut other = case.clone();
    for (i, part) in other.parts.iter_mut().enumerate() {
        let shift = 1.0 + i as f64;
        part.mass *= 1.5 + shift.sin();
        part.com = part.com.map(|x| 0.5 * x - 0.1 * shift.cos());
        part.massless = false;
        part.armature += 0.3;
        part.spring[0] = 5.0 * (1.5 + shift.cos());
        (part.friction[0], part.friction[1]) = (0.4 * shift, 1.0 + shift.sin());
    }
    other
}

/// The tool as a body: its ten parameters at the placement of [`tool`], and the link of the last joint with
/// it.
fn with_tool(case: &Case) -> (Robot, [f64; 10]) {
    let (mass, com, placement) = (0.8, Vector3::new(0.1, -0.2, 0.05), tool(case));
    let about_com = Matrix3::new(0.02, 0.001, 0.0, 0.001, 0.03, -0.002, 0.0, -0.002, 0.025);
    let body = LinkInertia::about_com(mass, com.into(), about_com);
    let (h, j) = (com * mass, body.inertia_about_origin());
    let parameters = [mass, h.x, h.y, h.z, j[(0, 0)], j[(1, 1)], j[(2, 2)], j[(0, 1)], j[(0, 2)], j[(1, 2)]];
    let mut specs = case.specs();
    let last = specs.pop().unwrap();
    let link = case.robot().joints()[case.parts.len() - 1].inertia;
    let moved = placement.rotation * com + placement.translation;
    let total = link.mass + mass;
    let centre = (link.com * link.mass + moved * mass) / total;
    let around = |part: f64, at: Vector3<f64>| {
        let d = at - centre;
        (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * part
    };
    let turned = placement.rotation * about_com * placement.rotation.transpose();
    let whole = link.inertia + turned + around(link.mass, link.com) + around(mass, moved);
    specs.push(last.carrying(LinkInertia::about_com(total, centre.into(), whole)));
    let builder = specs.into_iter().fold(Robot::builder("with tool"), |builder, spec| builder.joint(spec));
    let armature = case.robot().armature_matrix();
    (builder.gravity(case.gravity).build().unwrap().with_armature(armature).unwrap(), parameters)
}

properties! {
    96;

    /// `tau = Y pi`, Y of another robot with the same joints: Y does not depend on what is linear.
    #[test]
    fn the_regressor_times_the_parameters_of_any_robot_is_its_torque(case in all_cases(8)) {
        let other = with_other_values(&case).robot();
        let linear = |robot: &Robot| {
            let set = ParameterSet::new(robot).links().stiffness().friction().armature();
            robot.armature().iter().filter(|(i, j, _)| i != j).fold(set, |set, (i, j, _)| {
                set.named(&format!("j{i}, j{j}.armature")).unwrap()
            })
        };
        let (ours, theirs) = (linear(&case.robot()), linear(&other));
        prop_assert_eq!(ours.names(), theirs.names());
        prop_assert!(ours.parameters().iter().all(Parameter::is_linear));
        rounding!(|S| {
            let [q, v, a] = [&case.q[..], &case.v, &case.u].map(lift::<S>);
            let mut regressor = Regressor::<S>::new(&ours);
            let mut lagrangian = Lagrangian::<S>::new(&other);
            let tau = times(regressor.inverse_dynamics(&q, &v, &a).unwrap(), theirs.values());
            let mut blocks = vec![("tau", apart(&tau, lagrangian.inverse_dynamics(&q, &v, &a).unwrap()))];
            let p = times(regressor.momentum(&q, &v).unwrap().momentum, theirs.values());
            let m_v = product(lagrangian.mass_matrix(&q).unwrap().as_slice(), &v);
            blocks.push(("p", apart(&p, &m_v)));
            let energy = lagrangian.energy(&q, &v).unwrap();
            let row = regressor.energy(&q, &v).unwrap();
            let rest = |rest: S, (&e, &pi): (&S, &f64)| rest - e.times(pi);
            blocks.push(("E", vec![row.iter().zip(theirs.values()).fold(energy.kinetic + energy.potential, rest)]));
            blocks
        })?;
    }

    /// A payload changes tau by its columns times its ten parameters.
    #[test]
    fn the_columns_of_a_payload_are_what_the_body_adds(case in all_cases(6)) {
        let (with, parameters) = with_tool(&case);
        let set = everything(&case);
        let start = column(&set, "tool.mass");
        let (q, v, a) = (&case.q, &case.v, &case.u);
        let tau = |robot: &Robot| Lagrangian::<f64>::new(robot).inverse_dynamics(q, v, a).unwrap().to_vec();
        let mut regressor = Regressor::<f64>::new(&set);
        let y = regressor.inverse_dynamics(q, v, a).unwrap();
        let columns = |i: usize| y.row(i)[start..start + 10].iter().zip(&parameters);
        let bare = tau(&case.robot());
        let found: Vec<f64> = (0..case.n()).map(|i| columns(i).fold(bare[i], |sum, (y, pi)| sum + y * pi)).collect();
        // The robots start from constants that were put together in other ways.
        let [of_y, ..] = of_regressor(&set, [q, v, a, a]);
        let of_tau = [&case.robot(), &with].map(|robot| InverseBounds::new(robot, [q, v, a, a]).tau);
        let bound = of_tau[0] + of_tau[1] + of_y * parameters.iter().map(|pi| pi.abs()).sum::<f64>();
        close("tau with a tool", &found, &tau(&with), bound)?;
    }

    /// `tau_theta = D p_theta - (L_q,theta + D_theta)` along (v, a), by dual numbers as positions.
    #[test]
    fn the_regressors_of_momentum_and_of_inverse_dynamics_agree(case in all_cases(5)) {
        let set = everything_with_wrenches(&case);
        rounding!(|S| {
            let [q, v, a] = [&case.q[..], &case.v, &case.u].map(lift::<S>);
            let mut along = Regressor::<Tangent<S>>::new(&set);
            let sides = along.momentum(&moving(&q, &v), &moving(&v, &a)).unwrap();
            let rates = sides.momentum.as_slice().iter().zip(sides.force.as_slice());
            let expected: Vec<S> = rates.map(|(p, force)| p.eps - force.re).collect();
            let mut regressor = Regressor::<S>::new(&set);
            vec![("tau_theta", apart(regressor.inverse_dynamics(&q, &v, &a).unwrap().as_slice(), &expected))]
        })?;
    }

    /// `E = p.v - L`: its derivatives along any (dq, dv) by dual numbers, and those of momentum and force.
    #[test]
    fn the_regressors_of_energy_and_of_momentum_agree(case in all_cases(5)) {
        let (set, n) = (everything(&case), case.n());
        let friction = |k: usize| matches!(
            set.parameters()[k],
            Parameter::Viscous { .. } | Parameter::Coulomb { .. } | Parameter::CoulombVelocity { .. }
        );
        rounding!(|S| {
            let [q, v, dq, dv] = [&case.q[..], &case.v, &case.y[..n], &case.y[n..]].map(lift::<S>);
            let (q_along, v_along) = (moving(&q, &dq), moving(&v, &dv));
            let mut along = Regressor::<Tangent<S>>::new(&set);
            let energy: Vec<S> = along.energy(&q_along, &v_along).unwrap().iter().map(|e| e.eps).collect();
            let sides = along.momentum(&q_along, &v_along).unwrap();
            // D E_theta = D p_theta . v - L_q,theta . dq; D is no part of L.
            let rest = |k: usize| (0..n).fold(energy[k], |rest, i| {
                let rest = rest - sides.momentum[(i, k)].eps * v[i];
                if friction(k) { rest } else { rest + sides.force[(i, k)].re * dq[i] }
            });
            vec![("D E_theta", (0..set.len()).map(rest).collect())]
        })?;
    }

    /// A displacement of a joint along its own axis is that of q, but for its spring.
    #[test]
    fn displacements_along_the_joint_axis_are_those_of_q(case in all_cases(6)) {
        let robot = case.robot();
        let set = robot.joints().iter().enumerate().fold(ParameterSet::new(&robot), |set, (i, joint)| {
            let displacement = Displacement { frame: DisplacedIn::Joint, kind: joint.kind, axis: joint.axis.into() };
            set.displacement(&format!("d{i}"), &joint.name, displacement).unwrap()
        });
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let (q, v, a) = (&case.q, &case.v, &case.u);
        let tau_q = lagrangian.linearise_inverse_dynamics(q, v, a).unwrap().tau_q.view().to_nalgebra();
        let mut regressor = Regressor::<f64>::new(&set);
        let by_joints = regressor.inverse_dynamics(q, v, a).unwrap().view().to_nalgebra();
        let mut found = tau_q.map(|_| 0.0);
        for (k, joint) in robot.joints().iter().enumerate() {
            let (master, ratio) = joint.mimic.map_or((k, 1.0), |mimic| (mimic.joint, mimic.ratio));
            let i = robot.independent_indices().iter().position(|&other| other == master).unwrap();
            found[(i, i)] += joint.spring.stiffness * ratio * ratio;
            found.column_mut(i).axpy(ratio, &by_joints.column(k), 1.0);
        }
        // A column of tau_q is the sum of those of the joints that follow it, times their ratios.
        let ratios: f64 = robot.joints().iter().map(|joint| joint.mimic.map_or(1.0, |mimic| mimic.ratio.abs())).sum();
        let [by_regressor, ..] = of_regressor(&set, [q, v, a, a]);
        let bound = InverseBounds::new(&robot, [q, v, a, a]).tau_z + ratios * by_regressor;
        close("tau_q", found.as_slice(), tau_q.as_slice(), bound)?;
    }

    /// A rotation about an axis of the joint frame is one about the parent's, with a translation.
    #[test]
    fn rotations_in_the_joint_frame_are_rotations_in_the_frame_of_the_parent(case in all_cases(6)) {
        let robot = case.robot();
        let axis = Vector3::new(0.48, -0.6, 0.64);
        let place = robot.joints()[case.parts.len() - 1].placement;
        let (turned, moved) = (place.rotation * axis, place.translation.cross(&(place.rotation * axis)));
        let set = ParameterSet::new(&robot)
            .rotations()
            .translations()
            .displacement("t", &last(&case), Displacement::about(DisplacedIn::Parent, turned.into()))
            .unwrap();
        let mut regressor = Regressor::<f64>::new(&set);
        let found = regressor.inverse_dynamics(&case.q, &case.v, &case.u).unwrap().view().to_nalgebra();
        let by = |entry: &str| found.column(column(&set, &format!("{}.{entry}", last(&case)))).into_owned();
        let in_joint = by("rotation_x") * axis.x + by("rotation_y") * axis.y + by("rotation_z") * axis.z;
        let along = by("x") * moved.x + by("y") * moved.y + by("z") * moved.z;
        let in_parent = found.column(column(&set, "t")) + &along;
        // Three columns each, times components of directions and of an offset.
        let [of_tau, ..] = of_regressor(&set, [&case.q, &case.v, &case.u, &case.u]);
        let bound = (4.0 + moved.abs().sum()) * of_tau;
        close("tau_theta", in_joint.as_slice(), in_parent.as_slice(), bound)?;
    }

    /// To rotate everything about an axis of the world is to rotate gravity backwards.
    #[test]
    fn rotations_of_all_roots_are_rotations_of_gravity(case in all_cases(6), axis in prop::array::uniform3(-1.0..1.0_f64)) {
        let axis = Vector3::from(axis);
        prop_assume!(axis.norm() > 0.1);
        let robot = case.robot().with_gravity([1.0, -2.0, 9.0]).unwrap();
        let axis = axis.normalize();
        let roots: Vec<_> = robot.joints().iter().filter(|joint| joint.parent.is_none()).collect();
        let set = roots.iter().fold(ParameterSet::new(&robot).gravity(), |set, root| {
            let turn = Displacement::about(DisplacedIn::Parent, axis.into());
            set.displacement(&format!("turn of {}", root.name), &root.name, turn).unwrap()
        });
        let mut regressor = Regressor::<f64>::new(&set);
        let tau = regressor.inverse_dynamics(&case.q, &case.v, &case.u).unwrap().view().to_nalgebra();
        let turned = tau.columns(3, roots.len()).column_sum();
        let rate = robot.gravity().cross(&axis);
        let expected = tau.columns(0, 3) * rate;
        // The sum of so many columns, and three times components of g.
        let [of_tau, ..] = of_regressor(&set, [&case.q, &case.v, &case.u, &case.u]);
        let bound = (roots.len() as f64 + rate.abs().sum()) * of_tau;
        close("tau_theta", turned.as_slice(), expected.as_slice(), bound)?;
    }

    /// Every column is the difference of the torques of two robots with other values of its parameter, as far
    /// as that with twice the step is, and rounding over the step.
    #[test]
    fn columns_are_differences_between_robots_with_other_values(case in all_cases(4)) {
        const STEP: f64 = 1e-4;
        let set = everything_with_wrenches(&case);
        let mut regressor = Regressor::<f64>::new(&set);
        let (q, v, a) = (&case.q, &case.v, &case.u);
        let tau_theta = regressor.inverse_dynamics(q, v, a).unwrap().view().to_nalgebra();
        let [of_tau_theta, ..] = of_regressor(&set, [q, v, a, a]);
        let rounding = InverseBounds::new(set.robot(), [q, v, a, a]).tau / STEP + of_tau_theta;
        for (k, name) in set.names().iter().enumerate() {
            let tau = |step: f64| {
                let mut values = set.values().to_vec();
                values[k] += step;
                let robot = set.robot_with(&values).ok()?;
                let tau = Lagrangian::<f64>::new(&robot).inverse_dynamics(q, v, a).unwrap().to_vec();
                Some(DVector::from_vec(tau))
            };
            let difference = |step: f64| Some((tau(step)? - tau(-step)?) / (2.0 * step));
            // A friction of 0 has no robot on its other side; some inertias of thin links have neither.
            let (Some(near), Some(far)) = (difference(STEP), difference(2.0 * STEP)) else { continue };
            let bound = (&far - &near).amax() + rounding;
            close(name, tau_theta.column(k).as_slice(), near.as_slice(), bound)?;
        }
    }

    /// `y'F_x,theta`, y'F_theta and F_theta by dual numbers as states, for every kind of parameter.
    #[test]
    fn dual_states_give_the_mixed_derivatives_of_the_state_equation(case in cases(4)) {
        let (set, n) = (everything_with_wrenches(&case), case.n());
        let robot = case.robot();
        let p = case.p(&robot);
        let mut dual = HamiltonianParameters::<Dual64>::new(&set);
        let mut x: Vec<_> = [&case.q[..], &p].concat().into_iter().map(Dual64::from_re).collect();
        let (mut f_theta, mut y_f_x_theta) = (Vec::new(), Vec::new());
        for i in 0..2 * n {
            x[i].eps = 1.0;
            let along = dual.linearise(&x[..n], &x[n..]).unwrap();
            for k in 0..set.len() {
                y_f_x_theta.push((0..2 * n).map(|j| case.y[j] * along[(j, k)].eps).sum::<f64>());
            }
            f_theta = along.as_slice().iter().map(|entry| entry.re).collect();
            x[i].eps = 0.0;
        }
        let [of_f, of_y_f, of_y_f_x] = of_state_equation(&set, [&case.q, &case.v, &case.y]);
        let mut parameters = HamiltonianParameters::<f64>::new(&set);
        let all = parameters.contract(&case.q, &p, &case.y).unwrap();
        close("F_theta", all.f_theta().as_slice(), &f_theta, of_f)?;
        close("y'F_x,theta", all.y_f_x_theta().as_slice(), &y_f_x_theta, of_y_f_x.max(2.0 * n as f64 * of_f))?;
        let y_f_theta: Vec<f64> = (0..set.len())
            .map(|k| (0..2 * n).map(|j| case.y[j] * f_theta[j * set.len() + k]).sum())
            .collect();
        close("y'F_theta", all.y_f_theta(), &y_f_theta, of_y_f.max(2.0 * n as f64 * of_f))?;
    }
}
