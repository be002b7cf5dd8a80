//! Robots with floating joints: what is written about their motions, and what is refused.

use super::missing::WRONG;
use super::{empty_folder, json, optimize};
use crate::child::{stderr, stdout};

/// A body with a wheel about its axis z; the wheel alone has a motor.
const ROBOT: &str = "name = \"wheel\"\ngravity = [0, 0, 0]\nconvention = \"placements\"\n\
    [[joint]]\nname = \"base\"\ntype = \"floating\"\nmass = 10\ninertia = { xx = 2, yy = 3, zz = 4 }\n\
    [[joint]]\nname = \"wheel\"\nparent = \"base\"\nmass = 1\ninertia = { xx = 0.1, yy = 0.1, zz = 0.2 }\n";
const PROBLEM: &str = "robot = \"wheel.toml\"\n[start]\nq = [0, 0, 0, 0, 0, 0, 1, 0]\n[end]\n\
    q = [0, 0, 0, 0, 0, 0.6, 0.8, 0]\nq_free = [\"base_x\", \"base_y\", \"base_z\", \"wheel\"]\n\
    [time]\nfinal = 2.0\n[cost]\neffort = [1, 1, 1, 1, 1, 1, 1]\n";

#[test]
fn motions_of_a_satellite_are_written_and_not_drawn() {
    let folder = empty_folder("flying");
    std::fs::write(folder.join("wheel.toml"), ROBOT).unwrap();
    let [csv, page, saved] =
        ["samples.csv", "page.html", "saved.json"].map(|name| folder.join(name).to_str().unwrap().to_owned());
    let output =
        optimize("flying", PROBLEM, &["--json", "--sample", "10", "--sample-to", &csv, "--save", &saved]);
    assert!(output.status.success(), "{}", stderr(&output));
    let solution = json(&output);
    // 6 I^2 angle^2/T^3 with I = 4 and the angle 2 asin 0.6.
    let cost = 6.0 * 16.0 * (2.0 * 0.6_f64.asin()).powi(2) / 8.0;
    assert!((solution["cost"].as_f64().unwrap() / cost - 1.0).abs() < 1e-6, "{}", solution["cost"]);
    assert_eq!(solution["free_joints"][0]["name"], "base");
    let row = |key: &str| solution["trajectory"][key][0].as_array().unwrap().len();
    assert_eq!(["q", "v", "p", "u", "y"].map(row), [8, 7, 7, 7, 14]);
    assert_eq!(solution["samples"]["positions"][6], "base_qw");
    let csv = std::fs::read_to_string(&csv).unwrap();
    assert!(csv.starts_with("t,q_base_x,q_base_y,q_base_z,q_base_qx,"), "{csv}");
    assert!(csv.lines().count() == 22 && csv.lines().all(|line| line.split(',').count() == 37));
    let again = format!("{PROBLEM}[start_from]\nfile = \"saved.json\"\n");
    let again = optimize("flying", &again, &[]);
    let table = stdout(&again);
    assert!(again.status.success() && table.contains("converged") && table.contains("end defect"), "{table}");
    for (more, reason) in [
        (&["-o", &page][..], "-o: joint 'base' is floating, and reports do not draw"),
        (&["--svg", folder.to_str().unwrap()], "--svg: joint 'base' is floating"),
        (&["--continue", "final_time=2:3"], "joint 'base' is floating, its orientation a quaternion"),
        (&["--sample", "10", "--feedback", &page], "joint 'base' is floating"),
        (&["--sensitivities"], "joint 'base' is floating"),
    ] {
        let output = optimize("flying", PROBLEM, more);
        assert!(stderr(&output).contains(reason), "{more:?}: {}", stderr(&output));
    }
    let long = PROBLEM.replace("0.6, 0.8", "0.6, 0.9");
    let output = optimize("flying", &long, &[]);
    assert_eq!(output.status.code(), Some(WRONG));
    let message = stderr(&output);
    assert!(message.contains("end.q") && message.contains("has length 1.08"), "{message}");
}
