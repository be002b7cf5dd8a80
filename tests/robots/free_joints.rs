//! Floating and spherical joints: descriptions, and what is refused.

use costate::configuration::{ConfigurationSpace, FreeKinematics};
use costate::derivative::{ForwardDynamics, PhaseVelocity};
use costate::hamiltonian::{DualPass, FullHessian, Hamiltonian};
use costate::kinematics::Kinematics;
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::robot::{
    FrameSpec, FreeKind, Friction, JointSpec, Limits, LinkInertia, LoadOptions, Robot, RobotError, Spring,
    Tree, file, urdf,
};
use costate::tensors::Christoffel;
use costate::{EvalError, LengthError};
use nalgebra::Matrix3;

fn body() -> LinkInertia {
    LinkInertia::about_com(2.0, [0.1, -0.2, 0.3], Matrix3::from_diagonal(&[0.2, 0.3, 0.25].into()))
}

fn drone() -> Robot {
    Robot::builder("drone").joint(JointSpec::floating("root").carrying(body())).build().unwrap()
}

#[test]
fn a_free_joint_is_a_chain_of_which_the_last_moves_the_link() {
    let robot = drone();
    let names: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["root_x", "root_y", "root_z", "root_rx", "root_ry", "root"]);
    assert_eq!((robot.dof(), robot.nq(), robot.warnings()), (6, 7, &[][..]));
    let [free] = robot.free_joints() else { panic!("{:?}", robot.free_joints()) };
    assert_eq!((free.kind, free.position, free.coordinate, free.turned), (FreeKind::Floating, 0, 0, 3));
    assert_eq!(robot.frame("root").unwrap().joint, Some(5));
    // Inside of the chain nothing moves as a body does: there are no frames.
    let frames: Vec<&str> = robot.frames().iter().map(|frame| frame.name.as_str()).collect();
    assert_eq!(frames, ["world", "root"]);
    assert_eq!([4, 5, 6].map(|joint| robot.frame_of_joint(joint)), [None, Some(1), None]);
    assert!(matches!(robot.frame("joint:root_rx"), Err(RobotError::UnknownFrame { .. })));
    assert!(robot.with_frame(FrameSpec::new("tool").on("root_y")).is_err());
}

/// An arm on a satellite; its forearm slides, and one of two fingers mimics the other.
fn satellite() -> Robot {
    Robot::builder("satellite")
        .joint(JointSpec::revolute("boom").carrying(body()))
        .joint(JointSpec::floating("base").on("boom").carrying(body()))
        .joint(JointSpec::revolute("shoulder").on("base").link("arm").carrying(body()))
        .joint(JointSpec::spherical("ball").on("shoulder").carrying(body()))
        .joint(JointSpec::prismatic("finger").on("ball").axis([1.0, 0.0, 0.0]).carrying(body()))
        .joint(JointSpec::prismatic("thumb").on("ball").carrying(body()).mimicking("finger", -1.0, 0.0))
        .build()
        .unwrap()
}

#[test]
fn free_joints_remain_where_other_joints_are_held() {
    let robot = satellite();
    assert_eq!((robot.dof(), robot.nq()), (12, 14));
    let mut q = ConfigurationSpace::new(&robot).neutral();
    (q[0], q[8], q[13]) = (0.4, -0.7, 0.2);
    let reduced = robot.reduced_to(&["base", "ball", "boom"], &q).unwrap();
    assert_eq!(reduced, robot.lock(&[("shoulder", -0.7), ("finger", 0.2)]).unwrap());
    assert_eq!((reduced.dof(), reduced.nq()), (10, 12));
    // Frames follow in the order of the joints that are left, then those that are held.
    let names: Vec<&str> = reduced.frames().iter().map(|frame| frame.name.as_str()).collect();
    assert_eq!(names, ["world", "boom", "base", "ball", "shoulder", "finger", "thumb", "arm"]);
    let carriers: Vec<Option<usize>> = reduced.frames().iter().map(|frame| frame.joint).collect();
    assert_eq!(carriers[1..4], [Some(0), Some(6), Some(9)]);
    assert_eq!([1, 6, 9].map(|joint| reduced.frame_of_joint(joint)), [None, Some(2), Some(3)]);
    // Links are where they were, at rest and in any other pose.
    let mut rest = q.clone();
    rest[4..8].copy_from_slice(&[0.5, -0.5, 0.5, 0.5]);
    rest[9..13].copy_from_slice(&[0.0, 0.6, 0.0, 0.8]);
    let left: Vec<f64> = (0..14).filter(|k| ![8, 13].contains(k)).map(|k| rest[k]).collect();
    let (mut whole, mut part) = (FreeKinematics::<f64>::new(&robot), FreeKinematics::<f64>::new(&reduced));
    whole.set_position(&rest).unwrap();
    part.set_position(&left).unwrap();
    for frame in robot.frames() {
        let pose = |robot: &Robot, of: &FreeKinematics<f64>| {
            let pose = of.pose(robot.frame_index(&frame.name).unwrap()).unwrap();
            [pose.position, pose.rotation[0], pose.rotation[1], pose.rotation[2]].concat()
        };
        let (before, after) = (pose(&robot, &whole), pose(&reduced, &part));
        let error = before.iter().zip(&after).fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()));
        assert!(error < 1e-14, "{}: {before:?} {after:?}", frame.name);
    }
    let refused = |joints: &[&str]| robot.reduced_to(joints, &q).unwrap_err();
    for error in [refused(&["shoulder", "base"]), refused(&["base", "ball", "base_rx"])] {
        assert!(matches!(error, RobotError::FreeJoint { .. }), "{error}");
    }
    assert!(refused(&["shoulder", "base"]).to_string().contains("'ball' is spherical"));
    assert!(matches!(refused(&["base", "base"]), RobotError::RepeatedJoint { .. }));
    let wrong = robot.reduced_to(&["base", "ball"], &q[1..]).unwrap_err();
    assert!(matches!(wrong, RobotError::WrongPositions { expected: 14, found: 13 }), "{wrong}");
}

#[test]
fn each_entry_of_q_has_a_joint() {
    let robot = satellite();
    let names: Vec<&str> = (0..14).filter_map(|entry| robot.joint_of_position(entry)).collect();
    let expected = [&["boom"][..], &["base"; 7], &["shoulder"], &["ball"; 4], &["finger"]].concat();
    assert_eq!(names, expected);
    assert_eq!(robot.joint_of_position(14), None);
    let mut q = ConfigurationSpace::new(&robot).neutral();
    q[13] = f64::NAN;
    let error = Hamiltonian::<f64>::new(&robot).evaluate(&q, &[0.0; 12], &[0.0; 12]).unwrap_err();
    assert!(matches!(&error, EvalError::NonFinite { joint, index: 13, .. } if joint == "finger"), "{error}");
}

#[test]
fn a_centre_of_another_length_is_refused() {
    let (robot, chain) =
        (satellite(), Robot::builder("chain").joint(JointSpec::revolute("a").carrying(body())));
    let wrong = |expected, found| LengthError { what: "q", expected, found };
    let mut function = PhaseVelocity::new(&robot);
    function.set_centre(&ConfigurationSpace::new(&robot).neutral()).unwrap();
    assert_eq!(function.set_centre(&[0.0; 13]), Err(wrong(14, 13)));
    assert_eq!(ForwardDynamics::new(&robot).set_centre(&[0.0; 15]), Err(wrong(14, 15)));
    assert_eq!(PhaseVelocity::new(&chain.build().unwrap()).set_centre(&[0.0; 2]), Err(wrong(1, 2)));
}

#[test]
fn the_same_robot_is_read_from_toml_and_urdf() {
    let toml = r#"
        name = "drone"
        [[joint]]
        name = "root"
        type = "floating"
        mass = 2.0
        com = [0.1, -0.2, 0.3]
        inertia = { xx = 0.2, yy = 0.3, zz = 0.25 }
    "#;
    let toml = file::parse(toml, LoadOptions::default()).unwrap();
    let inertial = r#"<inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/>
        <inertia ixx="0.2" iyy="0.3" izz="0.25" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    let whole = format!(
        r#"<robot name="drone"><link name="world"/><link name="body">{inertial}</link>
        <joint name="root" type="floating"><parent link="world"/><child link="body"/></joint></robot>"#
    );
    let options = LoadOptions::default();
    let of_urdf = urdf::parse(&whole, options.quaternions(true)).unwrap();
    assert_eq!(of_urdf.warnings(), []);
    assert_eq!(urdf::parse(&whole, options).unwrap().nq(), 6, "six joints unless asked for");
    // A robot whose root link floats needs a joint: here a fixed one.
    let alone = format!(
        r#"<robot name="drone"><link name="body">{inertial}</link><link name="tool"/>
        <joint name="mount" type="fixed"><parent link="body"/><child link="tool"/></joint></robot>"#
    );
    let base = urdf::parse(&alone, options.floating_base(true)).unwrap();
    assert!(urdf::parse(&alone, options).is_err(), "nothing moves");
    let expected = drone();
    let (q, p) = ([0.3, 1.0, -0.4, 0.5, -0.5, 0.5, 0.5], [1.0, 0.4, -0.3, 0.2, 0.8, -0.5]);
    let rate = |robot: &Robot| Hamiltonian::<f64>::new(robot).evaluate(&q, &p, &[0.0; 6]).unwrap().to_vec();
    for robot in [toml, of_urdf, base] {
        assert_eq!(rate(&robot), rate(&expected), "{:?}", robot.joints());
    }
}

#[test]
fn what_a_free_joint_cannot_have_is_refused_by_name() {
    let build =
        |spec: JointSpec| Robot::builder("r").joint(spec.carrying(body())).build().unwrap_err().to_string();
    let floating = || JointSpec::floating("root");
    let limits = Limits { lower: -1.0, ..Limits::default() };
    let refused = [
        build(floating().armature(0.1)),
        build(floating().limits(limits)),
        build(floating().spring(Spring { stiffness: 1.0, rest: 0.0 })),
        build(floating().friction(Friction { viscous: 1.0, ..Friction::none() })),
        build(floating().mimicking("other", 1.0, 0.0)),
    ];
    assert!(refused.iter().all(|message| message.contains("'root'")), "{refused:?}");
    let follower = JointSpec::revolute("a").on("root").carrying(body()).mimicking("root", 1.0, 0.0);
    let error = Robot::builder("r").joint(floating().carrying(body())).joint(follower).build().unwrap_err();
    assert!(matches!(error, RobotError::UnsupportedMimic { .. }), "{error}");
    let robot = drone();
    let edits = [
        robot.lock(&[("root_rx", 0.0)]).err(),
        robot.reduced_to(&[], &[0.0; 7]).err(),
        robot.reduced_to(&["root_rx"], &[0.0; 7]).err(),
        robot.with_joint_armature("root", 1.0).err(),
        robot.with_friction("root_x", Friction::none()).err(),
        robot.with_limits("root", limits).err(),
    ];
    for error in edits.map(Option::unwrap) {
        assert!(matches!(&error, RobotError::FreeJoint { joint, .. } if joint == "root"), "{error}");
    }
}

#[test]
fn what_does_not_take_free_joints_says_so() {
    let robot = drone();
    let (q, p, y) = (ConfigurationSpace::new(&robot).neutral(), [0.1; 6], [0.2; 12]);
    let tree = || Tree::from(&robot);
    let outcomes = [
        Lagrangian::<f64>::new(&robot).coriolis_matrix(&q, &p).map(drop),
        Kinematics::<f64>::new(&robot).set_position(&p).map(drop),
        DualPass::<f64>::new(&robot).contract(&q, &p, &p, &y).map(drop),
        FullHessian::<f64>::new(&robot).hessian_tensor(&q, &p).map(drop),
        Hamiltonian::<f64, _>::with_route(tree(), Christoffel).evaluate(&q, &p, &p).map(drop),
        Hamiltonian::<f64>::new(&robot).linearise_momentum(&q, &p).map(drop),
        Hamiltonian::<f64>::new(&robot).linearise_velocity(&q, &p).map(drop),
        robot.joint_positions(&q).map(drop),
    ];
    let pulled = robot.with_wrench("root", Default::default()).unwrap();
    for error in [
        Hamiltonian::<f64>::new(&pulled).evaluate(&q, &p, &p).map(drop).unwrap_err(),
        Lagrangian::<f64>::new(&pulled).inverse_dynamics(&q, &p, &p).map(drop).unwrap_err(),
    ] {
        assert!(matches!(&error, EvalError::FreeJointAndWrench { joint, .. } if joint == "root"), "{error}");
    }
    for (k, outcome) in outcomes.into_iter().enumerate() {
        let error = outcome.unwrap_err();
        assert!(matches!(&error, EvalError::FreeJoint { joint, .. } if joint == "root"), "{k}: {error}");
    }
    let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
    assert!(matches!(hamiltonian.evaluate(&p, &p, &p), Err(EvalError::FreeJoint { .. })));
    assert!(matches!(hamiltonian.evaluate(&p[1..], &p, &p), Err(EvalError::WrongLength(_))));
    let mut turned = q.clone();
    turned[6] = 1.1;
    assert!(matches!(hamiltonian.evaluate(&turned, &p, &p), Err(EvalError::NotUnit { .. })));
    turned[6] = f64::NAN;
    assert!(matches!(hamiltonian.evaluate(&turned, &p, &p), Err(EvalError::NonFinite { .. })));
    hamiltonian.evaluate(&q, &p, &p).unwrap();
}

/// dq/dt = v is linear in the tangent space: of a costate (y_q, y_v) only y_v counts.
#[test]
fn second_derivatives_of_the_state_are_those_of_accelerations() {
    let robot = drone();
    let (q, v, u) = (ConfigurationSpace::new(&robot).neutral(), [0.3, -0.2, 0.1, 0.5, -0.4, 0.6], [0.1; 6]);
    let y: [f64; 12] = std::array::from_fn(|i| (1.0 + i as f64).sin());
    let mut second = LagrangianSecondOrder::<f64>::new(&robot);
    let state = second.contract(&q, &v, &u, &y).unwrap().to_matrix();
    let accelerations = second.contract_forward_dynamics(&q, &v, &u, &y[6..]).unwrap().to_matrix();
    assert_eq!(state.as_slice(), accelerations.as_slice());
    assert!(state.as_slice().iter().any(|entry| entry.abs() > 1e-3));
}
