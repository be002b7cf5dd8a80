//! Mimic joints of URDF, TOML and the builder: what follows what.

use crate::texts::{load, names, tree};
use costate::hamiltonian::Hamiltonian;
use costate::robot::{
    JointSpec, Limits, LinkInertia, LoadOptions, Mimic, Placement, Robot, RobotError, Warning, file,
};

fn mimic(robot: &Robot, joint: usize) -> [f64; 3] {
    let Mimic { joint, ratio, offset } = robot.joints()[joint].mimic.unwrap();
    [joint as f64, ratio, offset]
}

#[test]
fn a_mimic_of_a_mimic_follows_the_independent_joint() {
    // The joints of which others are mimics come later.
    let text = tree(
        &["base", "a", "b", "c"],
        &[
            ("x", "revolute", "base", "a", "<mimic joint=\"y\" multiplier=\"-2\" offset=\"0.1\"/>"),
            ("y", "prismatic", "a", "b", "<mimic joint=\"z\" multiplier=\"0.5\" offset=\"0.3\"/>"),
            ("z", "continuous", "b", "c", ""),
        ],
    );
    let robot = load(&text);
    assert_eq!((names(&robot), robot.dof()), (vec!["x", "y", "z"], 1));
    assert_eq!(robot.independent_joints().map(|joint| &joint.name).collect::<Vec<_>>(), ["z"]);
    assert_eq!(robot.independent_indices(), [2]);
    assert_eq!((mimic(&robot, 0), mimic(&robot, 1)), ([2.0, -1.0, -0.5], [2.0, 0.5, 0.3]));
    let positions = robot.joint_positions(&[2.0]).unwrap();
    assert!(positions.iter().zip([-2.5, 1.3, 2.0]).all(|(a, b)| (a - b).abs() < 1e-15), "{positions:?}");
    assert!(robot.joint_positions(&[2.0; 3]).is_err() && robot.poses(&[2.0; 3]).is_err());
}

#[test]
fn the_multiplier_of_a_urdf_is_1_and_its_offset_0() {
    let text = tree(
        &["base", "a", "b"],
        &[("x", "revolute", "base", "a", ""), ("y", "revolute", "a", "b", "<mimic joint=\"x\"/>")],
    );
    assert_eq!(mimic(&load(&text), 1), [0.0, 1.0, 0.0]);
}

#[test]
fn mimics_of_fixed_joints_are_fixed_at_their_offset() {
    let joints = |kind, mimic_x, offset| {
        let origin = "<origin xyz=\"0.1 0 0.2\" rpy=\"0 0.3 0\"/><axis xyz=\"0 2 0\"/>";
        tree(
            &["base", "a", "b", "c"],
            &[
                ("x", "fixed", "base", "a", mimic_x),
                (
                    "y",
                    kind,
                    "a",
                    "b",
                    &format!("{origin}<mimic joint=\"x\" multiplier=\"3\" offset=\"{offset}\"/>"),
                ),
                ("z", "revolute", "b", "c", ""),
            ],
        )
    };
    let place = Placement::from_xyz_rpy([0.1, 0.0, 0.2], [0.0, 0.3, 0.0]);
    let turned = place.then(&Placement::from_xyz_rpy([0.0; 3], [0.0, 0.7, 0.0]));
    let slid = place.then(&Placement::from_xyz_rpy([0.0, 0.7, 0.0], [0.0; 3]));
    // A fixed joint with <mimic> stays where it is.
    for (kind, expected) in [("revolute", turned), ("prismatic", slid)] {
        for mimic_x in ["", "<mimic joint=\"z\" offset=\"5\"/>"] {
            let robot = load(&joints(kind, mimic_x, 0.7));
            assert_eq!(names(&robot), ["z"]);
            let found = robot.joints()[0].placement;
            assert!((found.rotation - expected.rotation).amax() < 1e-15, "{kind}");
            assert!((found.translation - expected.translation).amax() < 1e-15, "{kind}");
        }
    }
}

#[test]
fn keys_of_toml_say_the_same_as_the_builder() {
    let text = "name = 'hand'\n[[joint]]\nname = 'a'\nmass = 1.0\ncom = [0.1, 0.0, 0.0]\n\
                [[joint]]\nname = 'b'\nmass = 1.0\ncom = [0.1, 0.0, 0.0]\nmimic = { joint = 'a', ratio = -0.5, offset = 0.25 }\n\
                [[joint]]\nname = 'c'\nmass = 1.0\ncom = [0.1, 0.0, 0.0]\nmimic = { joint = 'b' }";
    let link = LinkInertia::point(1.0, [0.1, 0.0, 0.0]);
    let built = Robot::builder("hand")
        .joint(JointSpec::revolute("a").carrying(link))
        .joint(JointSpec::revolute("b").on("a").carrying(link).mimicking("a", -0.5, 0.25))
        .joint(JointSpec::revolute("c").on("b").carrying(link).mimicking("b", 1.0, 0.0))
        .build()
        .unwrap();
    let read = file::parse(text, LoadOptions::default()).unwrap();
    assert_eq!(read.joints(), built.joints());
    assert_eq!(mimic(&built, 2), [0.0, -0.5, 0.25]);
}

#[test]
fn limits_of_mimics_narrow_those_of_the_independent_joint() {
    let limits = |lower, upper, velocity| Limits { lower, upper, velocity, effort: 7.0 };
    let link = LinkInertia::point(1.0, [0.1, 0.0, 0.0]);
    let pair = |of_mimic: Limits| {
        let [a, b] = ["a", "b"].map(|name| JointSpec::revolute(name).carrying(link));
        let a = a.limits(limits(-2.0, 3.0, 5.0));
        Robot::builder("pair").joint(a).joint(b.mimicking("a", -2.0, 1.0).limits(of_mimic)).build().unwrap()
    };
    // -3 <= 1 - 2 q <= 2 is -0.5 <= q <= 2.
    let narrowed = pair(limits(-3.0, 2.0, 6.0));
    assert_eq!(narrowed.joints()[0].limits, limits(-0.5, 2.0, 3.0));
    assert_eq!(narrowed.warnings(), []);
    assert_eq!(pair(Limits::default()).joints()[0].limits, limits(-2.0, 3.0, 5.0));
    assert_eq!(pair(limits(0.0, 0.0, 6.0)).joints()[0].limits, limits(-2.0, 3.0, 3.0));
    let apart = pair(limits(10.0, 12.0, 6.0));
    assert_eq!(apart.joints()[0].limits.lower, -2.0);
    assert!(
        matches!(apart.warnings(), [Warning::MimicLimits { joint, master }] if joint == "b" && master == "a")
    );
    assert!(apart.warnings()[0].to_string().contains("'b'"));
}

#[test]
fn what_one_joint_of_a_coordinate_moves_is_enough() {
    let light = JointSpec::revolute("a");
    let heavy = JointSpec::revolute("b").carrying(LinkInertia::point(1.0, [0.1, 0.0, 0.0]));
    let free = Robot::builder("free").joint(light.clone()).joint(heavy.clone()).build().unwrap();
    assert!(free.warnings().contains(&Warning::MovesNothing { joint: "a".into() }));
    let coupled =
        Robot::builder("coupled").joint(light).joint(heavy.mimicking("a", 2.0, 0.0)).build().unwrap();
    let m = Hamiltonian::<f64>::new(&coupled).mass_matrix(&[0.3]).unwrap()[(0, 0)];
    assert!((m - 0.04).abs() < 1e-16, "4 times 1 kg at 0.1 m: {m}");
}

#[test]
fn a_long_chain_of_mimics_is_read_at_once() {
    let mut builder = Robot::builder("chain");
    let count = 20_000;
    for i in (0..count).rev() {
        let joint = JointSpec::prismatic(format!("j{i}")).carrying(LinkInertia::point(1.0, [0.0; 3]));
        builder =
            builder.joint(if i == 0 { joint } else { joint.mimicking(format!("j{}", i - 1), -1.0, 0.0) });
    }
    let robot = builder.build().unwrap();
    assert_eq!((robot.joints().len(), robot.dof()), (count, 1));
    assert_eq!(robot.joints()[0].mimic, Some(Mimic { joint: count - 1, ratio: -1.0, offset: 0.0 }));
    let growing = |name: &str, of: &str| {
        JointSpec::revolute(name).carrying(LinkInertia::point(1.0, [0.1, 0.0, 0.0])).mimicking(of, 1e60, 0.0)
    };
    let free = JointSpec::revolute("a").carrying(LinkInertia::point(1.0, [0.1, 0.0, 0.0]));
    let grown = Robot::builder("grown").joint(free).joint(growing("b", "a")).joint(growing("c", "b")).build();
    assert!(matches!(grown, Err(RobotError::BadValue { joint, .. }) if joint == "c"));
}
