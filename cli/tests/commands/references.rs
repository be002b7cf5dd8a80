//! `costate eval` against the independent references.

use crate::child::{costate, flat, json_lines, root, stderr};
use crate::eval::ROUTES;
use serde_json::Value;

/// Every route, every fixture: the references hold for what comes out of the command.
#[test]
fn eval_agrees_with_the_references_by_every_route() {
    for (robot, fixture) in [
        ("robots/ur5.urdf", "ur5"),
        ("robots/biped.toml", "biped"),
        ("robots/manutec_r3.toml", "manutec_r3"),
        ("tests/fixtures/friction_tree.toml", "friction_tree"),
        ("tests/fixtures/mixed_chain.urdf", "mixed_chain"),
        ("tests/fixtures/mixed_tree.urdf", "mixed_tree"),
        ("tests/fixtures/mimic_tree.toml", "mimic_tree"),
        ("tests/fixtures/mimic_hand.urdf", "mimic_hand"),
        ("tests/fixtures/long_chain.urdf", "long_chain"),
    ] {
        for &route in ROUTES {
            agrees_with(robot, &format!("tests/fixtures/{fixture}.jsonl"), route);
        }
    }
}

/// The keys of an answer in each of the coordinates.
const KEYS: [(&str, &[&str]); 2] = [
    ("hamiltonian", &["M", "energy", "f", "f_x", "p", "q", "v", "y_f_xx"]),
    ("lagrangian", &["M", "energy", "q", "qdd", "qdd_z", "v", "yv_qdd_zz"]),
];

fn agrees_with(robot: &str, states: &str, route: &str) {
    let text = std::fs::read_to_string(root().join(states)).unwrap();
    let exist = |&&(coordinates, _): &&(&str, _)| route != "tensors" || coordinates == "hamiltonian";
    for &(coordinates, keys) in KEYS.iter().filter(exist) {
        let output = costate(
            &["eval", robot, "--states", states, "--route", route, "--coordinates", coordinates],
            b"",
        );
        assert!(output.status.success(), "{}", stderr(&output));
        let answers = json_lines(&output);
        assert_eq!(answers.len(), text.lines().count());
        for (answer, line) in answers.iter().zip(text.lines()) {
            let expected: Value = serde_json::from_str(line).unwrap();
            assert!(answer.as_object().unwrap().keys().eq(keys), "{robot} {route} {coordinates}");
            for &key in keys {
                let (found, expected) = (&answer[key], &expected[key]);
                let length = |value: &Value| value[0].as_array().map(Vec::len);
                assert_eq!(length(found), length(expected), "{robot} {route} {key}");
                let (found, expected) = (flat(found), flat(expected));
                assert_eq!(found.len(), expected.len(), "{robot} {route} {key}");
                let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                for (found, expected) in found.iter().zip(&expected) {
                    assert!((found - expected).abs() <= 1e-10 * size, "{robot} {route} {key}");
                }
            }
        }
    }
}
