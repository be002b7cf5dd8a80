//! Masses and inertias of URDF files that no real body has, and what is left without them.

use crate::texts::*;
use costate::EvalError;
use costate::kinematics::Kinematics;
use costate::lagrangian::Lagrangian;
use costate::robot::RobotError as E;
use costate::robot::urdf::parse;
use costate::robot::{JointSpec, LinkInertia, LoadOptions, Positivity, Robot, RobotEdit, Warning};
use nalgebra::Matrix3;

/// A link of 2 kg with these moments about axes through its centre of mass, of which x is the joint axis.
fn with_moments(com: &str, [x, y, z]: [f64; 3]) -> String {
    let old = ["0.1 0 0.2", "ixx=\"0.3\"", "iyy=\"0.3\"", "izz=\"0.2\""];
    let new = [com.to_owned(), format!("ixx=\"{x:e}\""), format!("iyy=\"{y:e}\""), format!("izz=\"{z:e}\"")];
    arm(&old.iter().zip(new).fold(INERTIAL.to_owned(), |text, (old, new)| text.replace(old, &new)))
}

#[test]
fn moments_that_are_negative_by_rounding_are_those_of_points() {
    for moments in [
        [-2.4e-38, 0.0, 2.4e-38],
        [-5.4e-20, -5.4e-20, 0.0],
        [-1e-19; 3],
        [-2e-13, 0.1, 0.1],
        [1e-19, 0.0, 0.0],
    ] {
        assert_eq!(load(&with_moments("0.1 0 0.2", moments)).warnings(), [], "{moments:?}");
    }
}

#[test]
fn moments_that_are_slightly_negative_are_a_warning_while_m_is_positive() {
    let strict = LoadOptions::default().strict(true);
    for moments in [[-0.01, 0.3, 0.3], [0.3, -0.02, 0.3], [0.1, -1e-8, 0.1]] {
        let text = with_moments("0.1 0 0.2", moments);
        let robot = load(&text);
        let [warning] = robot.warnings() else { panic!("{:?}", robot.warnings()) };
        assert!(
            matches!(warning, Warning::NegativeMoment { body, .. } if body.name() == "arm"),
            "{warning:?}"
        );
        let words = ["'arm'", "negative principal moment", "check the matrix"];
        assert!(words.iter().all(|word| warning.to_string().contains(word)), "{warning}");
        let error = parse(&text, strict).unwrap_err();
        assert!(matches!(error, E::Strict { .. }), "{error}");
    }
    // No figures of a body look like this.
    let text = with_moments("0.1 0 0.2", [-0.2, 0.3, 0.3]);
    let E::InFile { error, line, .. } = parse(&text, LoadOptions::default()).unwrap_err() else { panic!() };
    assert!(matches!(*error, E::IndefiniteInertia { .. }), "{error}");
    assert_eq!(line, Some(3));
}

/// What dynamics lacks is a warning, mended by edits; kinematics and inverse dynamics work.
#[test]
fn a_robot_whose_mass_matrix_is_not_positive_is_loaded() {
    // The inertia about the joint axis is negative.
    let robot = load(&with_moments("0.1 0 0", [-0.03, 0.3, 0.3]));
    let [warning] = robot.warnings() else { panic!("{:?}", robot.warnings()) };
    assert!(matches!(warning, Warning::NegativeMoment { positive: Positivity::Violated, .. }), "{warning:?}");
    assert!(warning.to_string().contains("M is not positive everywhere"), "{warning}");
    let mut lagrangian = Lagrangian::<f64>::new(&robot);
    let tau = lagrangian.inverse_dynamics(&[0.4], &[0.0], &[1.0]).unwrap()[0];
    let gravity = lagrangian.gravity(&[0.4]).unwrap()[0];
    assert!((tau - gravity + 0.03).abs() < 1e-12, "M = I_xx, not {}", tau - gravity);
    let error = lagrangian.forward_dynamics(&[0.4], &[0.0], &[0.0]).unwrap_err().to_string();
    assert!(error.contains("'elbow'") && error.contains("negative moment"), "{error}");
    let mended = robot.with_joint_armature("elbow", 0.1).unwrap();
    let [warning] = mended.warnings() else { panic!("{:?}", mended.warnings()) };
    assert!(matches!(warning, Warning::NegativeMoment { positive: Positivity::WhereTried, .. }));
    assert!(Lagrangian::<f64>::new(&mended).forward_dynamics(&[0.4], &[0.0], &[0.0]).is_ok());
}

/// A URDF for pictures only, without `<inertial>`.
#[test]
fn a_robot_without_mass_has_kinematics() {
    let robot = load(&arm(""));
    let about_all =
        |warning: &Warning| matches!(warning, Warning::KinematicsOnly { joint } if joint == "elbow");
    assert!(robot.warnings().iter().any(about_all), "{:?}", robot.warnings());
    let message = robot.warnings().iter().find(|warning| about_all(warning)).unwrap().to_string();
    assert!(message.contains("kinematics only") && message.contains("<inertial>"), "{message}");
    let mut kinematics = Kinematics::<f64>::new(&robot);
    kinematics.set_position(&[0.4]).unwrap();
    assert!(kinematics.pose(robot.frame_index("arm").unwrap()).is_ok());
    assert!(matches!(
        Lagrangian::<f64>::new(&robot).forward_dynamics(&[0.4], &[0.0], &[0.0]),
        Err(EvalError::SingularMassMatrix { joint }) if joint == "elbow"
    ));
    let loaded = robot.with_payload("arm", &LinkInertia::point(1.0, [0.1, 0.2, 0.3])).unwrap();
    assert_eq!(loaded.warnings(), []);
    assert!(Lagrangian::<f64>::new(&loaded).forward_dynamics(&[0.4], &[0.0], &[0.0]).is_ok());
    let floating = load(&one_joint("floating", "", "", ""));
    assert!(floating.warnings().iter().any(|warning| matches!(warning, Warning::KinematicsOnly { .. })));
    let strict = parse(&arm(""), LoadOptions::default().strict(true)).unwrap_err();
    assert!(strict.to_string().contains("kinematics only"), "{strict}");
}

#[test]
fn a_slightly_negative_part_of_a_body_is_named() {
    let part = "<link name=\"tool\"><inertial><mass value=\"1e-6\"/><inertia ixx=\"-3.5e-8\" ixy=\"0\" ixz=\"0\" iyy=\"9e-8\" iyz=\"0\" izz=\"9e-8\"/></inertial></link>\
                <joint name=\"weld\" type=\"fixed\"><parent link=\"arm\"/><child link=\"tool\"/></joint>";
    let robot = load(&more(part));
    assert!(
        matches!(robot.warnings(), [Warning::NegativeMoment { body, .. }] if body.name() == "tool"),
        "{:?}",
        robot.warnings()
    );
}

#[test]
fn impossible_inertias_are_named_once() {
    let odd = INERTIAL.replace("izz=\"0.2\"", "izz=\"0.9\"");
    let alone = load(&arm(&odd));
    assert!(
        matches!(alone.warnings(), [Warning::TriangleInequality { body, .. }] if body.name() == "arm"),
        "{alone:?}"
    );
    let tool = format!(
        "<link name=\"tool\">{odd}</link><joint name=\"t\" type=\"fixed\"><parent link=\"arm\"/><child link=\"tool\"/></joint>"
    );
    let merged = load(&more(&tool));
    assert!(
        matches!(merged.warnings(), [Warning::TriangleInequality { body, .. }] if body.name() == "tool"),
        "{merged:?}"
    );
    let strict = LoadOptions::default().strict(true);
    let error = parse(&more(&tool), strict).unwrap_err();
    assert!(matches!(&error, E::Strict { warnings } if warnings.len() == 1), "{error}");
    assert!(error.to_string().contains("'tool'"), "{error}");
    assert!(parse(&more(""), strict).is_ok());
}

#[test]
fn a_joint_that_moves_nothing_is_a_warning_that_locking_it_mends() {
    let spin = "<joint name=\"spin\" type=\"continuous\"><parent link=\"arm\"/><child link=\"tip\"/></joint>";
    let text = more(&format!("<link name=\"tip\"/>{spin}"));
    let robot = load(&text);
    let warnings: Vec<String> = robot.warnings().iter().map(ToString::to_string).collect();
    assert!(
        warnings.iter().any(|one| one.contains("'spin' moves no mass") && one.contains("lock it")),
        "{warnings:?}"
    );
    let strict = LoadOptions::default().strict(true);
    assert!(matches!(parse(&text, strict), Err(E::Strict { .. })));
    let edit = [RobotEdit::Lock(vec![("spin".into(), 0.0)])];
    assert_eq!(robot.edited(&edit, strict).unwrap().warnings(), []);
}

/// Links between the joints of a free base or a ball joint have none.
#[test]
fn links_without_mass_are_told_where_nothing_beyond_them_has_some_or_m_is_singular() {
    let strict = LoadOptions::default().strict(true);
    for file in ["rabbit", "seven_link", "quadruped", "biped", "biped_walker", "delta"] {
        Robot::from_file_with(format!("robots/{file}.toml"), strict).unwrap();
    }
    let body = LinkInertia::about_com(2.0, [0.1, 0.2, 0.3], Matrix3::from_diagonal(&[0.2, 0.3, 0.4].into()));
    let two = |axis: [f64; 3]| {
        let last = JointSpec::revolute("b").on("a").axis(axis).carrying(body);
        Robot::builder("two").joint(JointSpec::revolute("a")).joint(last).build().unwrap()
    };
    let massless = |link: &str| [Warning::MasslessLink { link: link.into() }];
    assert_eq!(two([1.0, 0.0, 0.0]).warnings(), []);
    // About one axis: M is singular until the first joint has a rotor.
    let coaxial = two([0.0, 0.0, 1.0]);
    assert_eq!(coaxial.warnings(), massless("a"));
    let rotor = [RobotEdit::Armature("a".into(), 0.1)];
    assert_eq!(coaxial.edited(&rotor, strict).unwrap().warnings(), []);
    // The last one of a chain, until it carries something.
    let spinning = JointSpec::revolute("tip").on("arm").armature(0.1);
    let arm = Robot::builder("arm").joint(JointSpec::revolute("arm").carrying(body)).joint(spinning);
    let arm = arm.build().unwrap();
    assert_eq!(arm.warnings(), massless("tip"));
    assert_eq!(arm.with_payload("tip", &body).unwrap().warnings(), []);
}
