//! Mass matrices that are singular by structure are refused, regular ones are not, however badly scaled.

use costate::EvalError;
use costate::derivative::worse;
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::Lagrangian;
use costate::robot::{JointSpec, LinkInertia, Placement, Robot, Warning};
use costate::scalar::Scalar;
use fastrand::Rng;
use nalgebra::Matrix3;
use num_dual::Dual64;

fn random_placement(rng: &mut Rng) -> Placement {
    let mut uniform = |range: f64| range * (2.0 * rng.f64() - 1.0);
    let xyz = [uniform(0.5), uniform(0.5), uniform(0.5)];
    Placement::from_xyz_rpy(xyz, [uniform(3.0), uniform(3.0), uniform(3.0)])
}

/// A chain of revolute joints, each link as given; joint frames in random positions.
fn chain(links: impl IntoIterator<Item = LinkInertia>, rng: &mut Rng) -> Robot {
    let mut builder = Robot::builder("chain");
    for (i, link) in links.into_iter().enumerate() {
        let mut spec = JointSpec::revolute(format!("j{i}")).placed(random_placement(rng)).carrying(link);
        if i > 0 {
            spec = spec.on(format!("j{}", i - 1));
        }
        builder = builder.joint(spec);
    }
    builder.build().unwrap()
}

/// How many of 500 random states are refused, and the largest error of `M^-1 M v` among the others (|v| <=
/// 1).
fn refused_and_worst<S: Scalar>(robot: &Robot, rng: &mut Rng, value: impl Fn(S) -> f64) -> (usize, f64) {
    let (mut hamiltonian, n) = (Hamiltonian::<S>::new(robot), robot.dof());
    let (mut refused, mut worst) = (0, 0.0_f64);
    for _ in 0..500 {
        let mut uniform =
            |range: f64| (0..n).map(|_| S::from_f64(range * (2.0 * rng.f64() - 1.0))).collect::<Vec<_>>();
        let (q, v) = (uniform(3.0), uniform(1.0));
        let p = hamiltonian.momentum(&q, &v).unwrap().to_vec();
        match hamiltonian.velocity(&q, &p) {
            Ok(found) => {
                let errors = found.iter().zip(&v).map(|(a, b)| (value(*a) - value(*b)).abs());
                worst = errors.fold(worst, worse);
            }
            Err(EvalError::SingularMassMatrix { .. }) => refused += 1,
            Err(error) => unreachable!("{error}"),
        }
    }
    (refused, worst)
}

fn body(mass: f64) -> LinkInertia {
    LinkInertia::about_com(mass, [0.1, -0.2, 0.15], Matrix3::from_diagonal(&[0.03, 0.04, 0.05].into()) * mass)
}

/// A point mass has three degrees of freedom, a body six: joints beyond that are redundant in every pose.
#[test]
fn redundant_joints_are_refused_in_every_pose() {
    let mut rng = Rng::with_seed(3);
    for _ in 0..4 {
        let point = |n: usize| {
            vec![LinkInertia::massless(); n - 1].into_iter().chain([LinkInertia::point(1.0, [0.3, 0.2, 0.1])])
        };
        let rigid = |n: usize| vec![LinkInertia::massless(); n - 1].into_iter().chain([body(2.0)]);
        for robot in [chain(point(4), &mut rng), chain(rigid(7), &mut rng)] {
            let (refused, worst) = refused_and_worst::<f64>(&robot, &mut rng, |x| x);
            assert!(refused == 500, "f64: {} accepted, error {worst:.1e}", 500 - refused);
            let (refused, worst) = refused_and_worst::<f32>(&robot, &mut rng, f64::from);
            assert!(refused == 500, "f32: {} accepted, error {worst:.1e}", 500 - refused);
        }
    }
}

/// What is accepted has digits; what is regular is accepted.
#[test]
fn badly_scaled_but_regular_robots_are_accepted() {
    let mut rng = Rng::with_seed(5);
    let tapering = (0..6).map(|i| body(10.0_f64.powi(2 - i)));
    let light_wrist = [500.0, 300.0, 100.0, 1e-3, 1e-4, 1e-5].map(body);
    let heavy_tip = [1e-6, 1e-6, 1e3].map(body);
    let tiny = [1e-15; 4].map(body);
    for robot in [
        chain(tapering, &mut rng),
        chain(light_wrist, &mut rng),
        chain(heavy_tip, &mut rng),
        chain(tiny, &mut rng),
        chain(vec![body(1.0); 40], &mut rng),
    ] {
        let (refused, worst) = refused_and_worst::<f64>(&robot, &mut rng, |x| x);
        assert!(refused <= 5, "{refused} of 500 refused, n = {}", robot.dof());
        assert!(worst < 1e-2, "error {worst:.1e}, n = {}", robot.dof());
    }
}

/// How many of 200 random states forward dynamics refuses, and the largest error of inverse dynamics at the
/// accelerations of the others, in relation to |M| |a| or |u|.
fn refused_by_forward_dynamics(robot: &Robot, rng: &mut Rng) -> (usize, f64) {
    let (mut lagrangian, n) = (Lagrangian::<f64>::new(robot), robot.dof());
    let (mut refused, mut worst) = (0, 0.0_f64);
    for _ in 0..200 {
        let mut uniform = |range: f64| (0..n).map(|_| range * (2.0 * rng.f64() - 1.0)).collect::<Vec<_>>();
        let (q, v, u) = (uniform(3.0), uniform(1.0), uniform(5.0));
        match lagrangian.forward_dynamics(&q, &v, &u).map(<[f64]>::to_vec) {
            Ok(a) => {
                let m = lagrangian.mass_matrix(&q).unwrap();
                let size = (0..n).map(|i| m.row(i).iter().zip(&a).map(|(m, a)| (m * a).abs()).sum::<f64>());
                let size = size.fold(5.0, worse);
                let found = lagrangian.inverse_dynamics(&q, &v, &a).unwrap();
                let errors = found.iter().zip(&u).map(|(a, b)| (a - b).abs() / size);
                worst = errors.fold(worst, worse);
            }
            Err(EvalError::SingularMassMatrix { .. }) => refused += 1,
            Err(error) => unreachable!("{error}"),
        }
    }
    (refused, worst)
}

/// Long chains, whose accelerations come from articulated bodies: these refuse what the factors of M refuse.
#[test]
fn articulated_bodies_refuse_redundant_joints_and_no_others() {
    let mut rng = Rng::with_seed(11);
    let massless = |n: usize| vec![LinkInertia::massless(); n];
    for links in [
        [massless(23), vec![body(2.0)]].concat(),
        [vec![body(1.0); 12], massless(8), vec![body(2.0)]].concat(),
        [massless(8), vec![body(2.0)], vec![body(1.0); 14]].concat(),
        [vec![body(1.0); 16], massless(4), vec![LinkInertia::point(1.0, [0.3, 0.2, 0.1])]].concat(),
    ] {
        let robot = chain(links, &mut rng);
        let (refused, worst) = refused_by_forward_dynamics(&robot, &mut rng);
        assert!(refused == 200, "{} accepted, error {worst:.1e}, n = {}", 200 - refused, robot.dof());
    }
    for links in [
        vec![body(1.0); 20],
        vec![body(1.0); 40],
        vec![body(1e-15); 20],
        (0..24).map(|i| body(10.0_f64.powf(2.0 - 0.25 * f64::from(i)))).collect(),
        [vec![body(500.0); 14], [1e-3, 1e-4, 1e-5].map(body).to_vec()].concat(),
        [vec![body(1e-3); 16], vec![body(1e3)]].concat(),
    ] {
        let robot = chain(links, &mut rng);
        let (refused, worst) = refused_by_forward_dynamics(&robot, &mut rng);
        assert!(refused <= 2, "{refused} of 200 refused, n = {}", robot.dof());
        assert!(worst < 1e-8, "error {worst:.1e}, n = {}", robot.dof());
    }
}

/// A chain whose last link has no mass, and a branch of one more joint before it.
fn with_idle_joint(n: usize, rng: &mut Rng) -> Robot {
    let chain = chain((0..n - 1).map(|_| body(2.0)), rng);
    let specs = chain.joints().iter().map(|joint| {
        let spec = JointSpec::revolute(&joint.name).placed(joint.placement).carrying(joint.inertia);
        joint.parent.map_or(spec.clone(), |parent| spec.on(&chain.joints()[parent].name))
    });
    let idle = JointSpec::revolute("idle").on("j0").placed(random_placement(rng));
    let builder = specs.fold(Robot::builder("idle"), |builder, spec| builder.joint(spec));
    let branch = JointSpec::revolute("arm").on("j1").placed(random_placement(rng)).carrying(body(1.0));
    builder.joint(idle).joint(branch).build().unwrap()
}

/// All that inverts M names the joint that moves nothing, whichever algorithm the size of the robot calls
/// for; what does not invert it is computed.
#[test]
fn a_joint_that_moves_nothing_is_named_where_its_inertia_is_needed() {
    let mut rng = Rng::with_seed(11);
    for n in [3, 7, 13, 14, 18, 25, 40] {
        let robot = with_idle_joint(n, &mut rng);
        let dof = robot.dof();
        assert!(robot.warnings().contains(&Warning::MovesNothing { joint: "idle".into() }));
        let (x, y) = (vec![0.3; dof], vec![0.7; 2 * dof]);
        let idle = |result: Result<(), EvalError>| {
            let expected = EvalError::SingularMassMatrix { joint: "idle".into() };
            assert_eq!(result.unwrap_err(), expected, "{dof} joints");
        };
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        idle(hamiltonian.velocity(&x, &x).map(|_| ()));
        idle(hamiltonian.linearise(&x, &x, &x).map(|_| ()));
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        idle(second.contract(&x, &x, &x, &y).map(|_| ()));
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        idle(lagrangian.forward_dynamics(&x, &x, &x).map(|_| ()));
        idle(lagrangian.linearise_forward_dynamics(&x, &x, &x).map(|_| ()));
        let tau = lagrangian.linearise_inverse_dynamics(&x, &x, &x).unwrap();
        assert!(tau.tau_q.as_slice().iter().chain(tau.tau).all(|entry| entry.is_finite()));
        let mut slow = Hamiltonian::<Dual64>::new(&robot);
        let dual: Vec<_> = x.iter().map(|&x| Dual64::new(x, 1.0)).collect();
        idle(slow.linearise(&dual, &dual, &dual).map(|_| ()));
        let mended = robot.lock(&[("idle", 0.2)]).unwrap();
        assert_eq!((mended.warnings(), mended.dof()), (&[][..], dof - 1));
        let x = &x[1..];
        assert!(Lagrangian::<f64>::new(&mended).forward_dynamics(x, x, x).is_ok());
        let geared = robot.with_joint_armature("idle", 0.1).unwrap();
        assert!(!geared.warnings().contains(&Warning::MovesNothing { joint: "idle".into() }));
        let lead = vec![0.3; dof];
        assert!(Lagrangian::<f64>::new(&geared).forward_dynamics(&lead, &lead, &lead).is_ok());
    }
}
