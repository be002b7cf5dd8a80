//! `--feedback`: gains and derivatives by limits.

use super::{folder, json, optimize, two_link};
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|entry| entry.as_f64().unwrap()).collect()
}

/// The problem of the two-link arm to a tolerance at which differences of motions are derivatives.
fn precise() -> String {
    two_link() + "[solver]\ntolerance = 1e-6\n"
}

/// The problem with this start.
fn from(q: [f64; 2], v: [f64; 2]) -> String {
    precise().replace("q = [0.0, 0.0]", &format!("q = {q:?}\nv = {v:?}"))
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
    let output = optimize("feedback", &precise(), &["--feedback", path, "--sample", "100", "--polish=false"]);
    assert!(output.status.success(), "{output:?}");
    let found: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    assert_eq!((found["format"].as_u64(), found["robot"].as_str()), (Some(1), Some("two_link")));
    assert_eq!(found["t"].as_array().unwrap().len(), 101);
    assert_eq!(found["active"].as_array().unwrap().len(), 101);
    assert_eq!(found["held"].to_string(), "[[0.98,1.0]]");
    let (dq, dv) = ([0.004, -0.003], [0.02, 0.03]);
    let minus = |x: [f64; 2]| x.map(|x| -x);
    for k in [0, 30, 55] {
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

/// A quarter turn of both joints in free time, with this torque limit of the second one.
fn limited(torque: f64) -> String {
    let text = precise().replace("q = [1.0, 0.5]", "q = [1.5707963267948966, 1.5707963267948966]");
    let text =
        text.replace("final = 1.0", "free = true\nguess = 2.0").replace("[cost]", "[cost]\ntime = 20.0");
    text + &format!("[limits]\ntorque_max = [12.0, {torque:?}]\nfrom_robot = false\n")
}

#[test]
fn limits_have_derivatives() {
    let file = folder("feedback_limits").join("feedback.json");
    let path = file.to_str().unwrap();
    let output = optimize("feedback_limits", &limited(5.0), &["--feedback", path, "--polish=false"]);
    assert!(output.status.success(), "{output:?}");
    let found: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    let parameters = found["derivatives"]["parameters"].as_array().unwrap();
    let of_torques: Vec<&Value> =
        parameters.iter().filter(|one| one["name"] == "limits.torque_max").collect();
    // Solving again with a little more and a little less, on meshes of their own.
    let total = |torque: f64| {
        let found = json(&optimize("feedback_again", &limited(torque), &["--json", "--polish=false"]));
        found["cost"].as_f64().unwrap()
    };
    let slope = (total(5.05) - total(4.95)) / 0.1;
    let cost = of_torques[1]["cost"].as_f64().unwrap();
    assert!(of_torques.len() == 2 && (cost - slope).abs() < 0.02 * slope.abs(), "{cost} {slope}");
    let points = found["derivatives"]["t"].as_array().unwrap().len();
    assert!(parameters.iter().all(|one| one["tau"].as_array().unwrap().len() == points));
}

#[test]
fn other_kinds_of_motions_have_feedback() {
    let via = "[[via]]\nq = [0.5, 1.0]\n[limits]\nfrom_robot = false\n[cost]";
    let found = |text: &str| {
        let file = folder("feedback_kinds").join("feedback.json");
        let path = file.to_str().unwrap();
        let output = optimize("feedback_kinds", text, &["--feedback", path, "--sample", "100Hz"]);
        assert!(output.status.success(), "{output:?}");
        let found: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        assert_eq!(found["t"].as_array().unwrap().len(), 101, "{found}");
        found
    };
    let through = found(&two_link().replace("[cost]", via));
    assert!(through.get("gain_q").is_some() && through.get("gain_a").is_none());
    let costly = "effort = [1.0, 1.0]\njerk = [0.1, 0.1]\n[limits]\nfrom_robot = false";
    let smooth = found(&two_link().replace("effort = [1.0, 1.0]", costly));
    assert_eq!(smooth["gain_a"].as_array().unwrap().len(), 101);
    assert_eq!(smooth["cost_by_start"].as_array().unwrap().len(), 6);
    assert!(found(&two_link().replace("[end]", "q_free = [1]\n[end]")).get("gain_q").is_some());
}

#[test]
fn what_has_no_feedback_is_told() {
    let says = |text: &str, words: &str| {
        let output = optimize("feedback_refused", text, &["--feedback", "-"]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && message.contains(words), "{message}");
    };
    let limited = "[limits]\nfrom_robot = false\njerk_max = [150.0, 200.0]\n[cost]";
    says(&two_link().replace("[cost]", limited), "the rate of the torque of joint 'shoulder' costs");
    let costly = "effort = [1.0, 1.0]\ntime = 60.0\njerk = [0.1, 0.1]\n[limits]\nfrom_robot = false";
    let free = two_link().replace("final = 1.0", "free = true\nguess = 1.5");
    says(&free.replace("effort = [1.0, 1.0]", costly), "give the final time");
    // No motion.
    let fast = "effort = [1.0, 1.0]\n[limits]\nv_max = [0.5, 0.5]";
    says(&two_link().replace("effort = [1.0, 1.0]", fast), "feedback");
}

/// Masses that are carried by the problem file and the power of all joints are among the parameters.
#[test]
fn payloads_and_the_power_of_all_joints_have_derivatives() {
    let file = folder("feedback_masses").join("feedback.json");
    let path = file.to_str().unwrap();
    let text = |mass: f64, power: f64| {
        let own = two_link();
        let (robot, rest) = own.split_once('\n').unwrap();
        let robot = robot.replace("robot = ", "[robot]\nfile = ");
        let payload =
            format!("[[robot.payload]]\nframe = \"elbow\"\nmass = {mass:?}\ncom = [1.0, 0.0, 0.0]\n");
        format!("{robot}\n{payload}{rest}[limits]\nfrom_robot = false\ntotal_power_max = {power:?}\n")
    };
    let options = ["--polish=false"];
    let (mass, power) = (0.5, 40.0);
    let output =
        optimize("feedback_masses", &text(mass, power), &[&["--feedback", path][..], &options].concat());
    assert!(output.status.success(), "{output:?}");
    let found: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    let parameters = found["derivatives"]["parameters"].as_array().unwrap();
    let by = |name: &str, joint: &str| {
        let own = parameters.iter().find(|row| row["name"] == name && row["joint"] == joint);
        own.unwrap_or_else(|| panic!("{name} of {joint}"))["cost"].as_f64().unwrap()
    };
    let cost = |mass: f64, power: f64| {
        let found =
            optimize("feedback_masses_again", &text(mass, power), &[&["--json"][..], &options].concat());
        json(&found)["cost"].as_f64().unwrap()
    };
    for (name, joint, [dm, dp]) in
        [("robot.payload.mass", "elbow", [0.01, 0.0]), ("limits.total_power_max", "all joints", [0.0, 0.2])]
    {
        let difference = (cost(mass + dm, power + dp) - cost(mass - dm, power - dp)) / (2.0 * (dm + dp));
        let derivative = by(name, joint);
        assert!((derivative / difference - 1.0).abs() < 0.01, "{name}: {derivative} {difference}");
    }
}
