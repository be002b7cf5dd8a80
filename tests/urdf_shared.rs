//! The robots that lie beside a checkout of the project's design documents, where present: URDF against JSON.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use costate::robot::LoadOptions;
use costate::robot::urdf::parse;
use nalgebra::{Matrix3, Vector3};

/// Texts of the robots beside the repository, URDF and JSON; none where they are missing.
fn shared_robots() -> impl Iterator<Item = (String, String)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/robots");
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let urdfs = files.filter(|path| path.extension().is_some_and(|extension| extension == "urdf"));
    urdfs.filter_map(|path| {
        Some((
            std::fs::read_to_string(&path).ok()?,
            std::fs::read_to_string(path.with_extension("json")).ok()?,
        ))
    })
}

#[test]
fn shared_robots_are_read_as_they_should_be() {
    for (urdf, json) in shared_robots() {
        let robot = parse(&urdf, LoadOptions::default()).unwrap();
        let expected: serde_json::Value = serde_json::from_str(&json).unwrap();
        let joints = expected["joints"].as_array().unwrap();
        assert_eq!((robot.name(), robot.len()), (expected["name"].as_str().unwrap(), joints.len()));
        // ur5.json has 4.9e-12 where the right angles of ur5.urdf have 0.
        let tolerance = if robot.name() == "ur5" { 1e-11 } else { 1e-12 };
        assert_eq!(robot.gravity(), vector(&expected["gravity"]));
        for (joint, expected) in robot.joints().iter().zip(joints) {
            let name = &joint.name;
            assert_eq!(
                (name.as_str(), joint.kind.name()),
                (expected["name"].as_str().unwrap(), expected["kind"].as_str().unwrap())
            );
            assert_eq!(
                joint.parent.map_or(0, |parent| parent as u64 + 1),
                expected["parent"].as_u64().unwrap(),
                "{name}"
            );
            let (placement, inertia) = (&expected["placement"], &expected["inertia"]);
            let gaps = [
                (joint.placement.rotation - matrix(&placement["rotation"])).amax(),
                (joint.placement.translation - vector(&placement["translation"])).amax(),
                (joint.axis - vector(&expected["axis"])).amax(),
                joint.inertia.mass - inertia["mass"].as_f64().unwrap(),
                (joint.inertia.com - vector(&inertia["com"])).amax(),
                (joint.inertia.inertia - matrix(&inertia["I_com"])).amax(),
            ];
            assert!(gaps.iter().all(|gap| gap.abs() < tolerance), "{name}: {gaps:?} {}", robot.name());
        }
    }
}

fn vector(value: &serde_json::Value) -> Vector3<f64> {
    Vector3::from_fn(|i, _| value[i].as_f64().unwrap())
}

fn matrix(value: &serde_json::Value) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| value[i][j].as_f64().unwrap())
}
