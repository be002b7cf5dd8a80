//! Lengths and inertias in millimetres are noticed, and those of no published robot are.

use costate::robot::{LoadOptions, Robot, RobotFormat, Warning};
use std::path::Path;

/// An arm of three links with these factors of its lengths and of its inertias.
fn arm(lengths: f64, inertias: f64) -> Robot {
    let link = |k: usize, mass: f64| {
        let [x, i, j] = [0.2 * lengths, 0.01 * mass * inertias, 0.05 * mass * inertias];
        format!(
            "<link name=\"l{k}\"><inertial><origin xyz=\"{x} 0 0\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"{i}\" iyy=\"{j}\" izz=\"{j}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n"
        )
    };
    let joint = |k: usize| {
        format!(
            "<joint name=\"j{k}\" type=\"continuous\"><origin xyz=\"{} 0 0\"/><parent link=\"l{}\"/>\
             <child link=\"l{k}\"/><axis xyz=\"0 0 1\"/></joint>\n",
            0.4 * lengths,
            k - 1
        )
    };
    let links: String = [6.0, 3.0, 1.0].iter().enumerate().map(|(k, mass)| link(k + 1, *mass)).collect();
    let joints: String = (1..=3).map(joint).collect();
    let text = format!("<robot name=\"arm\"><link name=\"l0\"/>{links}{joints}</robot>");
    Robot::read(text.as_bytes(), RobotFormat::Urdf, LoadOptions::default()).unwrap()
}

fn said(robot: &Robot) -> Vec<&Warning> {
    robot.warnings().iter().filter(|warning| matches!(warning, Warning::Millimetres { .. })).collect()
}

#[test]
fn millimetres_are_noticed() {
    assert!(said(&arm(1.0, 1.0)).is_empty());
    // Small and large robots, of wood and of lead.
    for (lengths, inertias) in [(0.05, 0.0025), (30.0, 900.0), (1.0, 0.1), (1.0, 20.0)] {
        assert!(said(&arm(lengths, inertias)).is_empty(), "{lengths} {inertias}");
    }
    for (lengths, inertias, words) in [
        (1e3, 1.0, "'l3' reaches 1e3 m from the first joint"),
        (1e3, 1e6, "lengths are in m, are these in mm?"),
        (50.0 * 1e3, 1.0, "are these in mm?"),
        (1.0, 1e6, "inertias are in kg m^2, are these in kg mm^2?"),
    ] {
        let robot = arm(lengths, inertias);
        let [warning] = said(&robot)[..] else { panic!("{:?}", robot.warnings()) };
        assert!(warning.is_refused_when_strict() && !warning.is_note());
        let message = warning.to_string();
        let words = words.replace("1e3 m", "1000 m");
        assert!(message.contains(&words), "{message}");
    }
}

#[test]
fn published_robots_are_in_metres() {
    let mut count = 0;
    for folder in ["robots", "tests/fixtures", "tests/fixtures/public"] {
        for entry in Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).read_dir().unwrap() {
            let path = entry.unwrap().path();
            let Ok(robot) = Robot::from_file(&path) else { continue };
            assert!(said(&robot).is_empty(), "{}: {:?}", path.display(), said(&robot));
            count += 1;
        }
    }
    assert!(count >= 20, "{count}");
}

/// An attribute of one element is one warning, and so are several in the same elements; the mass of the base
/// of an arm is a note.
#[test]
fn a_panda_of_a_public_package_has_one_warning() {
    let text = "<robot name=\"arm\"><link name=\"base\"><inertial><mass value=\"0.6\"/><inertia ixx=\"0.1\" iyy=\"0.1\" \
                izz=\"0.1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n<link name=\"l1\"><inertial>\
                <mass value=\"1\"/><inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>\
                </link>\n<joint name=\"j1\" type=\"continuous\"><parent link=\"base\"/><child link=\"l1\"/>\
                <dynamics D=\"1\" K=\"7000\" damping=\"0.003\" friction=\"0.2\" mu_coulomb=\"0\" mu_viscous=\"16\"/></joint></robot>";
    let robot = Robot::read(text.as_bytes(), RobotFormat::Urdf, LoadOptions::default()).unwrap();
    let warnings: Vec<String> =
        robot.warnings().iter().filter(|warning| !warning.is_note()).map(ToString::to_string).collect();
    let [one] = &warnings[..] else { panic!("{warnings:?}") };
    let expected = "D, K, mu_coulomb, mu_viscous in <dynamics> of joint 'j1' (line 3) are unknown to URDF and were ignored";
    assert_eq!(one, expected);
    let notes: Vec<String> =
        robot.warnings().iter().filter(|warning| warning.is_note()).map(ToString::to_string).collect();
    assert!(
        notes.len() == 2 && notes.iter().any(|note| note.contains("mass of the root link 'base'")),
        "{notes:?}"
    );
}
