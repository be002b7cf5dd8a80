//! Properties of the state equation: symmetries, energy, the momentum map, changes of description.

use costate::EvalError;
use costate::derivative::{Jacobian, PhaseVelocity};
use costate::hamiltonian::Hamiltonian;
use costate::kernels::KernelOne;
use costate::robot::{JointSpec, LinkInertia, Placement, Robot, Tree, dh};
use costate::scalar::{Count, Scalar, Tangent};
use costate_test_support::random_position::Kind;
use costate_test_support::random_robot::{Case, all_cases, cases, condition};
use costate_test_support::rounding::{
    Bounds, InverseBounds, apart, bound, close, lift, moving, rows, terms, times, transposed_times,
};
use costate_test_support::{properties, rounding};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

/// Kernel one at (q, v).
fn kernel<S: Scalar>(robot: &Robot, q: &[S], v: &[S]) -> KernelOne<S> {
    let tree = Tree::from(robot);
    let mut kernel = KernelOne::new(&tree);
    kernel.set_position(&tree, q).unwrap();
    kernel.set_velocity(&tree, v).unwrap();
    kernel.second_order(&tree);
    kernel
}

/// The trace of a square matrix with these rows, `size` entries each.
fn trace<S: Scalar>(matrix: &[S], size: usize) -> S {
    (0..size).fold(S::zero(), |sum, i| sum + matrix[i * (size + 1)])
}

/// The largest bounds of these robots.
fn bounds_of_all(robots: &[&Robot], at: [&[f64]; 4]) -> Bounds {
    robots.iter().map(|robot| Bounds::new(robot, at)).reduce(Bounds::largest).unwrap()
}

/// Robots a property.
const CASES: u32 = 192;

properties! {
    CASES;

    #[test]
    fn mass_matrix_is_symmetric_and_positive_semidefinite(case in all_cases(12)) {
        let robot = case.robot();
        let m = kernel(&robot, &case.q, &case.v).mass_matrix().view().to_nalgebra();
        prop_assert_eq!(&m, &m.transpose());
        let values = nalgebra::SymmetricEigen::new(m).eigenvalues;
        // An eigenvalue changes by at most the norm of the error of M, n times its largest entry, and by a
        // few roundings of the largest eigenvalue in the decomposition.
        let n = case.n() as f64;
        let counted = kernel::<Count>(&robot, &lift(&case.q), &lift(&case.v));
        let of_m = 2.0 * bound(counted.mass_matrix().as_slice());
        let rounding = n * (of_m + 4.0 * f64::EPSILON * values.max());
        prop_assert!(values.min() >= -rounding, "{values}");
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
        let robot = case.robot();
        rounding!(|S| {
            let [q, v] = [&case.q[..], &case.v].map(lift::<S>);
            let kernel = kernel(&robot, &q, &v);
            vec![("p - M v", apart(kernel.momentum(), &times(kernel.mass_matrix().as_slice(), &v)))]
        })?;
    }

    #[test]
    fn coupling_times_velocity_is_rate_of_mass_matrix_times_velocity(case in cases(10)) {
        let robot = case.robot();
        rounding!(|S| {
            let [q, v] = [&case.q[..], &case.v].map(lift::<S>);
            let p_v = times(kernel(&robot, &q, &v).l_vq().as_slice(), &v);
            let mut dual = Hamiltonian::<Tangent<S>>::new(&robot);
            let m = dual.mass_matrix(&moving(&q, &v)).unwrap();
            let rate: Vec<S> = m.as_slice().iter().map(|entry| entry.eps).collect();
            vec![("P v - dM/dt v", apart(&p_v, &times(&rate, &v)))]
        })?;
    }

    #[test]
    fn transposed_coupling_times_velocity_is_twice_the_gradient_of_kinetic_energy(case in cases(10)) {
        let case = Case { gravity: [0.0; 3], ..case };
        let mut free = case.clone();
        free.parts.iter_mut().for_each(|part| part.spring = [0.0; 2]);
        let robot = free.robot();
        rounding!(|S| {
            let [q, v] = [&free.q[..], &free.v].map(lift::<S>);
            let kernel = kernel(&robot, &q, &v);
            let p_v = transposed_times(kernel.l_vq().as_slice(), &v);
            let gradient: Vec<S> = kernel.l_q().iter().map(|&entry| entry.times(2.0)).collect();
            vec![("P'v - 2 T_q", apart(&p_v, &gradient))]
        })?;
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
        // Each entry and its negative: only partial sums round, by at most the sum of all magnitudes each
        // time.
        let n = case.n();
        let f_x = rows(linear.matrix());
        let both = trace(&f_x, 2 * n);
        let size: f64 = (0..2 * n).map(|i| f_x[i * (2 * n + 1)].abs()).sum();
        prop_assert!(both.abs() <= 2.0 * n as f64 * f64::EPSILON * size, "{both}");
        let by_dual = PhaseVelocity::new(&robot).under(&case.u);
        let mut dual: Jacobian<_> = Jacobian::new(by_dual);
        let f_x = dual.linearise(&[case.q.clone(), p.clone()].concat()).unwrap().jacobian.view().to_nalgebra();
        let (pq, qq) = (f_x.view((n, 0), (n, n)), f_x.view((0, 0), (n, n)));
        let bound = Bounds::new(&robot, [&case.q, &case.v, &case.u, &case.y]).f_x;
        close("F^p,q", pq.clone_owned().as_slice(), pq.transpose().as_slice(), bound)?;
        close("F^p,p", f_x.view((n, n), (n, n)).clone_owned().as_slice(), (-qq.transpose()).as_slice(), bound)?;
    }

    /// dH/dt = v.(D + u): what friction takes and actuation gives.
    #[test]
    fn power_balance(case in cases(10)) {
        let robot = case.robot();
        let conservative = robot.without_friction();
        rounding!(|S| {
            let [q, v, u] = [&case.q[..], &case.v, &case.u].map(lift::<S>);
            let mut hamiltonian = Hamiltonian::<S>::new(&robot);
            let p = hamiltonian.momentum(&q, &v).unwrap().to_vec();
            let f = hamiltonian.evaluate(&q, &p, &u).unwrap().to_vec();
            let (n, rest) = (case.n(), vec![S::zero(); case.n()]);
            let smooth = Hamiltonian::<S>::new(&conservative).evaluate(&q, &p, &rest).unwrap().to_vec();
            let mut dual = Hamiltonian::<Tangent<S>>::new(&robot);
            let rate = dual.hamiltonian(&moving(&q, &f[..n]), &moving(&p, &f[n..])).unwrap().eps;
            vec![("dH/dt", vec![(0..n).fold(rate, |rest, i| rest - f[i] * (f[n + i] - smooth[n + i]))])]
        })?;
    }

    #[test]
    fn legendre_map_and_its_jacobians_invert_each_other(case in cases(10)) {
        let robot = case.robot();
        rounding!(|S| {
            let [q, v] = [&case.q[..], &case.v].map(lift::<S>);
            let (n, mut hamiltonian) = (case.n(), Hamiltonian::<S>::new(&robot));
            let p = hamiltonian.momentum(&q, &v).unwrap().to_vec();
            let found = hamiltonian.velocity(&q, &p).unwrap().to_vec();
            let mut blocks = vec![("v", apart(&found, &v))];
            let to_p = hamiltonian.linearise_momentum(&q, &v).unwrap();
            let (in_q, in_v) = (to_p.dp_dq.clone(), to_p.dp_dv.clone());
            let to_v = hamiltonian.linearise_velocity(&q, &p).unwrap();
            let (v_q, v_p) = (rows(to_v.dv_dq), rows(to_v.dv_dp));
            let product = |i: usize, j: usize, from: S, of: &dyn Fn(usize, usize) -> S| {
                (0..n).fold(from, |sum, k| sum + v_p[i * n + k] * of(k, j))
            };
            let one = |i: usize, j: usize| if i == j { -S::one() } else { S::zero() };
            let all = || (0..n * n).map(|k| (k / n, k % n));
            blocks.push(("v_p p_v - 1", all().map(|(i, j)| product(i, j, one(i, j), &|k, j| in_v[(k, j)])).collect()));
            blocks.push(("v_q + v_p p_q", all().map(|(i, j)| product(i, j, v_q[i * n + j], &|k, j| in_q[(k, j)])).collect()));
            blocks
        })?;
        let p = case.p(&robot);
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let v = hamiltonian.velocity(&case.q, &p).unwrap().to_vec();
        let mut solved = p.clone();
        hamiltonian.solve_mass_matrix(&case.q, &mut solved).unwrap();
        prop_assert_eq!(&solved, &v);
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
        // The turned constants are rounded once more than those that the bounds start from.
        let bounds = bounds_of_all(&[&turned, &original], [&case.q, &case.v, &case.u, &case.y]);
        close("F", &f(&turned), &f(&original), bounds.f)?;
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
        // What cancels are products of velocities and momenta, and arms of weights of about 1 m. 60
        // operations of each term pass one of at most 8 joints.
        let energy: f64 = f.iter().zip(&p).map(|(v, p)| (v * p).abs()).sum();
        let weight = 9.81 * robot.joints().iter().map(|joint| joint.inertia.mass).sum::<f64>();
        close("dp_1/dt", &f[n..=n], &[0.0], terms(60 * 8, &[energy, weight]))?;
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
        let bound = InverseBounds::new(&plain.robot(), [&case.q, &case.v, &case.u, &case.u]).m;
        close("M", &m(&builder.build().unwrap()), &expected, scale * bound)?;
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
        let [p, y] = [n, 2 * n].map(|count| (0..count).map(|i| 0.3 + 0.2 * i as f64).collect::<Vec<_>>());
        for robot in [&modified, &standard] {
            let found = numbers(robot).unwrap();
            let bounds = bounds_of_all(&[robot, &placed], [&q[..n], &velocity(&placed, &q[..n], &p), &vec![0.0; n], &y]);
            close(robot.name(), &found[..2 * n], &expected[..2 * n], bounds.f)?;
            close(robot.name(), &found[2 * n..], &expected[2 * n..], bounds.f_x)?;
        }
    }
}

/// The velocity of momenta.
fn velocity(robot: &Robot, q: &[f64], p: &[f64]) -> Vec<f64> {
    Hamiltonian::<f64>::new(robot).velocity(q, p).unwrap().to_vec()
}

fn about_x(angle: f64) -> Matrix3<f64> {
    Placement::from_xyz_rpy([0.0; 3], [angle, 0.0, 0.0]).rotation
}

fn about_z(angle: f64) -> Matrix3<f64> {
    Placement::from_xyz_rpy([0.0; 3], [0.0, 0.0, angle]).rotation
}
