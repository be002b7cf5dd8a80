//! Properties of the state equation: symmetries, energy, the momentum map, changes of description.

use costate::EvalError;
use costate::derivative::{Jacobian, PhaseVelocity, largest};
use costate::hamiltonian::Hamiltonian;
use costate::kernels::KernelOne;
use costate::robot::{JointSpec, LinkInertia, Placement, Robot, Tree, dh};
use costate_test_support::properties;
use costate_test_support::random_position::Kind;
use costate_test_support::random_robot::{Case, all_cases, cases, condition, difference, tolerance};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use proptest::prelude::*;

/// Kernel one at the state of a case.
fn kernel(case: &Case) -> KernelOne<f64> {
    let tree = Tree::from(&case.robot());
    let mut kernel = KernelOne::new(&tree);
    kernel.set_position(&tree, &case.q).unwrap();
    kernel.set_velocity(&tree, &case.v).unwrap();
    kernel.second_order(&tree);
    kernel
}

/// `dM/dt` along v, by a dual number through the mass matrix.
fn mass_matrix_rate(case: &Case) -> DMatrix<f64> {
    let mut dual = Hamiltonian::<num_dual::Dual64>::new(&case.robot());
    let q: Vec<_> = case.q.iter().zip(&case.v).map(|(&q, &v)| num_dual::Dual64::new(q, v)).collect();
    let m = dual.mass_matrix(&q).unwrap();
    DMatrix::from_fn(case.n(), case.n(), |i, j| m[(i, j)].eps)
}

/// Robots a property.
const CASES: u32 = 192;

properties! {
    CASES;

    #[test]
    fn mass_matrix_is_symmetric_and_positive_semidefinite(case in all_cases(12)) {
        let m = kernel(&case).mass_matrix().view().to_nalgebra();
        prop_assert_eq!(&m, &m.transpose());
        let values = nalgebra::SymmetricEigen::new(m).eigenvalues;
        prop_assert!(values.min() >= -1e-14 * values.max(), "{values}");
    }

    /// Regular in double precision or refused by name: never a result without digits.
    #[test]
    fn a_singular_mass_matrix_is_refused(case in all_cases(6)) {
        let robot = case.robot();
        let p = case.p(&robot);
        let condition = condition(&robot, &case.q);
        match Hamiltonian::<f64>::new(&robot).velocity(&case.q, &p) {
            Ok(v) => prop_assert!(v.iter().all(|v| v.is_finite())),
            Err(EvalError::SingularMassMatrix { .. }) => prop_assert!(!(0.0..1e11).contains(&condition)),
            Err(error) => prop_assert!(false, "{error}"),
        }
    }

    #[test]
    fn momentum_is_mass_matrix_times_velocity(case in cases(12)) {
        let kernel = kernel(&case);
        let mv = kernel.mass_matrix().view().to_nalgebra() * DVector::from_column_slice(&case.v);
        prop_assert!(difference(kernel.momentum(), mv.as_slice()) <= 1e-13);
    }

    #[test]
    fn coupling_times_velocity_is_rate_of_mass_matrix_times_velocity(case in cases(10)) {
        let v = DVector::from_column_slice(&case.v);
        let pv = kernel(&case).l_vq().view().to_nalgebra() * &v;
        let mdot_v = mass_matrix_rate(&case) * &v;
        prop_assert!(largest(&(pv - &mdot_v)) <= 1e-12 * largest(&mdot_v).max(1.0));
    }

    #[test]
    fn transposed_coupling_times_velocity_is_twice_the_gradient_of_kinetic_energy(case in cases(10)) {
        let case = Case { gravity: [0.0; 3], ..case };
        let mut free = case.clone();
        free.parts.iter_mut().for_each(|part| part.spring = [0.0; 2]);
        let kernel = kernel(&free);
        let pv = kernel.l_vq().view().to_nalgebra().transpose() * DVector::from_column_slice(&free.v);
        let gradient = DVector::from_column_slice(kernel.l_q()) * 2.0;
        prop_assert!(largest(&(pv - &gradient)) <= 1e-12 * largest(&gradient).max(1.0));
    }

    /// Without friction: F^p,q symmetric (22), F^p,p = -(F^q,q)' (21d), J F_x symmetric, trace 0.
    #[test]
    fn jacobian_is_a_hamiltonian_matrix(case in cases(12)) {
        let robot = case.robot().without_friction();
        let p = case.p(&robot);
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let linear = hamiltonian.linearise(&case.q, &p, &case.u).unwrap();
        let [qq, qp, pq, pp] = [linear.qq(), linear.qp(), linear.pq(), linear.pp()].map(|b| b.to_nalgebra());
        prop_assert_eq!(&pq, &pq.transpose());
        prop_assert_eq!(&qp, &qp.transpose());
        prop_assert_eq!(&pp, &-qq.transpose());
        prop_assert!((qq.trace() + pp.trace()).abs() <= 1e-14 * largest(&qq));
        let by_dual = PhaseVelocity::new(&robot).under(&case.u);
        let mut dual: Jacobian<_> = Jacobian::new(by_dual);
        let f_x = dual.linearise(&[case.q.clone(), p.clone()].concat()).unwrap().jacobian.view().to_nalgebra();
        let n = case.n();
        let (pq, qq) = (f_x.view((n, 0), (n, n)), f_x.view((0, 0), (n, n)));
        let bound = tolerance(&robot, &case.q);
        prop_assert!(largest(&(pq - pq.transpose())) <= bound * largest(&f_x));
        prop_assert!(largest(&(f_x.view((n, n), (n, n)) + qq.transpose())) <= bound * largest(&f_x));
    }

    /// dH/dt = v.(D + u): what friction takes and actuation gives.
    #[test]
    fn power_balance(case in cases(10)) {
        let robot = case.robot();
        let p = case.p(&robot);
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let f = hamiltonian.evaluate(&case.q, &p, &case.u).unwrap().to_vec();
        let conservative = robot.without_friction();
        let rest = vec![0.0; case.n()];
        let smooth = Hamiltonian::<f64>::new(&conservative).evaluate(&case.q, &p, &rest).unwrap().to_vec();
        let n = case.n();
        let mut dual = Hamiltonian::<num_dual::Dual64>::new(&robot);
        let seed = |x: &[f64], d: &[f64]| -> Vec<_> {
            x.iter().zip(d).map(|(&x, &d)| num_dual::Dual64::new(x, d)).collect()
        };
        let rate = dual.hamiltonian(&seed(&case.q, &f[..n]), &seed(&p, &f[n..])).unwrap().eps;
        let power: f64 = (0..n).map(|i| f[i] * (f[n + i] - smooth[n + i])).sum();
        let size: f64 = (0..n).map(|i| (f[i] * f[n + i]).abs() + (f[i] * smooth[n + i]).abs()).sum();
        prop_assert!((rate - power).abs() <= tolerance(&robot, &case.q) * size.max(1e-3), "{rate} {power}");
    }

    #[test]
    fn legendre_map_and_its_jacobians_invert_each_other(case in cases(10)) {
        let robot = case.robot();
        let bound = tolerance(&robot, &case.q);
        let p = case.p(&robot);
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let v = hamiltonian.velocity(&case.q, &p).unwrap().to_vec();
        prop_assert!(difference(&v, &case.v) <= bound);
        let mut solved = p.clone();
        hamiltonian.solve_mass_matrix(&case.q, &mut solved).unwrap();
        prop_assert_eq!(&solved, &v);
        let to_p = hamiltonian.linearise_momentum(&case.q, &case.v).unwrap();
        let (in_q, in_v) = (to_p.dp_dq.view().to_nalgebra(), to_p.dp_dv.view().to_nalgebra());
        let to_v = hamiltonian.linearise_velocity(&case.q, &p).unwrap();
        let (v_q, v_p) = (to_v.dv_dq.to_nalgebra(), to_v.dv_dp.to_nalgebra());
        let identity = DMatrix::identity(case.n(), case.n());
        prop_assert!(largest(&(&v_p * &in_v - identity)) <= bound * largest(&in_v) * largest(&v_p));
        prop_assert!(largest(&(v_q + v_p * &in_q)) <= 10.0 * bound * largest(&in_q).max(1.0));
    }

    /// A rotated base under rotated gravity moves alike.
    #[test]
    fn a_turned_world_changes_nothing(case in cases(8), turn in prop::array::uniform3(-3.0..3.0)) {
        let world = Placement::from_xyz_rpy([0.0; 3], turn);
        let mut builder = Robot::builder("turned").gravity((world.rotation * Vector3::from(case.gravity)).into());
        for (i, spec) in case.specs().into_iter().enumerate() {
            let spec = match case.parent(i) {
                None => {
                    let part = &case.parts[i];
                    spec.placed(world.then(&Placement::from_xyz_rpy(part.xyz, part.rpy)))
                }
                Some(_) => spec,
            };
            builder = builder.joint(spec);
        }
        let (turned, original) = (builder.build().unwrap(), Case { coupling: Vec::new(), ..case.clone() }.robot());
        prop_assume!((0.0..1e9).contains(&condition(&original, &case.q)));
        let p = Hamiltonian::<f64>::new(&original).momentum(&case.q, &case.v).unwrap().to_vec();
        let f = |robot: &Robot| {
            let mut hamiltonian = Hamiltonian::<f64>::new(robot);
            hamiltonian.evaluate(&case.q, &p, &case.u).unwrap().to_vec()
        };
        prop_assert!(difference(&f(&turned), &f(&original)) <= tolerance(&original, &case.q));
    }

    /// Gravity along the first, revolute axis on which all stands, nothing driving it: dp_1/dt = 0.
    #[test]
    fn momentum_about_the_direction_of_gravity_is_conserved(case in cases(8)) {
        let mut case = Case { coupling: Vec::new(), ..case.all_independent() };
        case.parts[0].kind = Kind::Revolute;
        case.parts[0].spring = [0.0; 2];
        case.parts[0].friction = [0.0, 0.0, 0.1];
        case.parts.iter_mut().for_each(|part| part.parent = 0);
        let robot = case.robot();
        let joint = &robot.joints()[0];
        let robot = robot.with_gravity((joint.placement.rotation * joint.axis * -9.81).into()).unwrap();
        prop_assume!((0.0..1e9).contains(&condition(&robot, &case.q)));
        let p = case.p(&robot);
        let n = case.n();
        let f = Hamiltonian::<f64>::new(&robot).evaluate(&case.q, &p, &vec![0.0; n]).unwrap().to_vec();
        let energy: f64 = f.iter().zip(&p).map(|(v, p)| (v * p).abs()).sum();
        let weight = 9.81 * robot.joints().iter().map(|joint| joint.inertia.mass).sum::<f64>();
        prop_assert!(f[n].abs() <= 1e-13 * (energy + weight), "{}", f[n]);
    }

    /// Scaling all masses (and armature) scales M and p.
    #[test]
    fn mass_matrix_is_linear_in_the_masses(case in cases(8), scale in 1e-6..1e6_f64) {
        let mut builder = Robot::builder("scaled");
        for (spec, joint) in case.specs().into_iter().zip(case.robot().joints()) {
            let link = &joint.inertia;
            let heavier = LinkInertia { mass: link.mass * scale, inertia: link.inertia * scale, ..*link };
            builder = builder.joint(spec.carrying(heavier).armature(0.0));
        }
        let mut plain = Case { coupling: Vec::new(), ..case.clone() };
        plain.parts.iter_mut().for_each(|part| part.armature = 0.0);
        let m = |robot: &Robot| Hamiltonian::<f64>::new(robot).mass_matrix(&case.q).unwrap().as_slice().to_vec();
        let expected: Vec<f64> = m(&plain.robot()).into_iter().map(|x| x * scale).collect();
        prop_assert!(difference(&m(&builder.build().unwrap()), &expected) <= 1e-13);
    }

    /// One robot by a modified table, a standard table and placements.
    #[test]
    fn tables_and_placements_describe_the_same_robot(
        rows in prop::collection::vec(prop::array::uniform4(-1.5..1.5), 1..8),
        prismatic in prop::collection::vec(any::<bool>(), 8),
        q in prop::collection::vec(-3.0..3.0, 8),
    ) {
        let n = rows.len();
        let body = LinkInertia::about_com(1.3, [0.1, -0.2, 0.05], Matrix3::from_diagonal(&Vector3::new(0.3, 0.4, 0.5)));
        let name = |i: usize| format!("j{i}");
        let spec = |i: usize| if prismatic[i] { JointSpec::prismatic(name(i)) } else { JointSpec::revolute(name(i)) };
        let row = |i: usize| dh::DhRow { alpha: rows[i][0], a: rows[i][1], d: rows[i][2], theta: rows[i][3] };
        let modified = dh::chain("m", dh::Convention::Modified, (0..n).map(|i| (spec(i).carrying(body), row(i))));
        let mut placed = Robot::builder("p");
        // The standard table whose frame i is the modified frame i, seen from behind the next joint's x part.
        let mut standard_rows = Vec::new();
        for i in 0..n {
            let joint = row(i);
            let x = Placement { rotation: about_x(joint.alpha), translation: Vector3::new(joint.a, 0.0, 0.0) };
            let z = Placement { rotation: about_z(joint.theta), translation: Vector3::new(0.0, 0.0, joint.d) };
            let before = if i == 0 { spec(0) } else { spec(i).on(name(i - 1)) };
            placed = placed.joint(before.placed(x.then(&z)).carrying(body));
            let next = if i + 1 < n { row(i + 1) } else { dh::DhRow::default() };
            let far = Placement { rotation: about_x(next.alpha), translation: Vector3::new(next.a, 0.0, 0.0) };
            let seen = Placement {
                rotation: far.rotation.transpose(),
                translation: -(far.rotation.transpose() * far.translation),
            };
            let row = dh::DhRow { alpha: next.alpha, a: next.a, ..joint };
            standard_rows.push((spec(i).carrying(body.placed(&seen)), row));
        }
        let standard = dh::chain("s", dh::Convention::Standard, standard_rows);
        let first = row(0);
        let base = Placement { rotation: about_x(first.alpha), translation: Vector3::new(first.a, 0.0, 0.0) };
        let gravity = Vector3::new(0.0, 0.0, -9.81);
        let standard = standard.gravity((base.rotation.transpose() * gravity).into()).build().unwrap();
        let (modified, placed) = (modified.build().unwrap(), placed.build().unwrap());
        let numbers = |robot: &Robot| {
            let mut hamiltonian = Hamiltonian::<f64>::new(robot);
            let p: Vec<f64> = (0..n).map(|i| 0.3 + 0.2 * i as f64).collect();
            hamiltonian.linearise(&q[..n], &p, &vec![0.0; n]).map(|l| [l.f().to_vec(), l.matrix().to_nalgebra().as_slice().to_vec()].concat())
        };
        let expected = numbers(&placed);
        prop_assume!(expected.is_ok());
        let expected = expected.unwrap();
        let bound = tolerance(&placed, &q[..n]);
        for robot in [modified, standard] {
            let found = numbers(&robot).unwrap();
            prop_assert!(difference(&found, &expected) <= bound, "{}", robot.name());
        }
    }
}

fn about_x(angle: f64) -> Matrix3<f64> {
    Placement::from_xyz_rpy([0.0; 3], [angle, 0.0, 0.0]).rotation
}

fn about_z(angle: f64) -> Matrix3<f64> {
    Placement::from_xyz_rpy([0.0; 3], [0.0, 0.0, angle]).rotation
}
