//! `--feedback`: gains and derivatives by limits.

use super::{folder, json, optimize, two_link};
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|entry| entry.as_f64().unwrap()).collect()
}

/// The problem with this start.
fn from(q: [f64; 2], v: [f64; 2]) -> String {
    two_link().replace("q = [0.0, 0.0]", &format!("q = {q:?}\nv = {v:?}"))
}

/// q, v and torques at k/100 s.
fn sampled(test: &str, text: &str, k: usize) -> [Vec<f64>; 3] {
    let found = json(&optimize(test, text, &["--json", "--sample", "100", "--polish=false"]));
    ["q", "v", "tau"].map(|key| numbers(&found["samples"][key][k]))
}

#[test]
fn gains_give_the_torques_of_motions_nearby() {
    let file = folder("feedback").join("feedback.json");
    let path = file.to_str().unwrap();
    let output =
        optimize("feedback", &two_link(), &["--feedback", path, "--sample", "100", "--polish=false"]);
    assert!(output.status.success(), "{output:?}");
    let found: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    assert_eq!((found["format"].as_u64(), found["robot"].as_str()), (Some(1), Some("two_link")));
    assert_eq!(found["t"].as_array().unwrap().len(), 101);
    let (dq, dv) = ([0.004, -0.003], [0.02, 0.03]);
    let minus = |x: [f64; 2]| x.map(|x| -x);
    for k in [0, 30, 55, 80] {
        let above = sampled("feedback_above", &from(dq, dv), k);
        let below = sampled("feedback_below", &from(minus(dq), minus(dv)), k);
        let change: [Vec<f64>; 3] =
            std::array::from_fn(|i| above[i].iter().zip(&below[i]).map(|(a, b)| 0.5 * (a - b)).collect());
        let size = change[2].iter().fold(0.0, |most: f64, tau| most.max(tau.abs()));
        for j in 0..2 {
            let row = |key: &str| numbers(&found[key][k][j]);
            let product = |row: Vec<f64>, x: &[f64]| row.iter().zip(x).map(|(a, b)| a * b).sum::<f64>();
            let torque = product(row("gain_q"), &change[0]) + product(row("gain_v"), &change[1]);
            assert!((torque - change[2][j]).abs() < 0.02 * size, "{k} {j}: {torque} {change:?}");
        }
    }
}

#[test]
fn limits_have_derivatives() {
    let text = two_link() + "[limits]\ntorque_max = [8.0, 3.0]\n";
    let file = folder("feedback_limits").join("feedback.json");
    let output =
        optimize("feedback_limits", &text, &["--feedback", file.to_str().unwrap(), "--polish=false"]);
    assert!(output.status.success(), "{output:?}");
    let found: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    let parameters = found["derivatives"]["parameters"].as_array().unwrap();
    let torque = |joint: usize| {
        let own = parameters.iter().filter(|one| one["name"] == "limits.torque_max");
        own.clone().nth(joint).unwrap()["cost"].as_f64().unwrap()
    };
    // Solving again with a little more.
    let total = |more: [f64; 2]| {
        let limits = format!("[limits]\ntorque_max = {:?}\n", [8.0 + more[0], 3.0 + more[1]]);
        let found = json(&optimize("feedback_again", &(two_link() + &limits), &["--json", "--polish=false"]));
        found["cost"].as_f64().unwrap()
    };
    for joint in 0..2 {
        let mut more = [0.0; 2];
        more[joint] = 0.05;
        let slope = (total(more) - total(more.map(|more| -more))) / 0.1;
        let (found, size) = (torque(joint), torque(0).abs().max(torque(1).abs()));
        assert!((found - slope).abs() < 0.02 * size, "{joint}: {found} {slope}");
    }
    let points = found["derivatives"]["t"].as_array().unwrap().len();
    assert!(parameters.iter().all(|one| one["tau"].as_array().unwrap().len() == points));
}

#[test]
fn what_has_no_feedback_is_told() {
    let says = |text: &str, words: &str| {
        let output = optimize("feedback_refused", text, &["--feedback", "-"]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && message.contains(words), "{message}");
    };
    says(&two_link().replace("effort = [1.0, 1.0]", "effort = [1.0, 1.0]\njerk = [0.1, 0.1]"), "cost.jerk");
    says(&two_link().replace("[end]", "q_free = [1]\n[end]"), "something is free at the start");
}
