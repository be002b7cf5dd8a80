//! What is refused before anything is solved, and what is printed all the same where something fails later.

use super::missing::{IMPOSSIBLE, Missing, WRONG, and, arm, with};
use super::{empty_folder, folder, json, optimize, two_link};
use crate::child::{command, stderr, stdout};

/// The arm with a limit on the rate of its elbow, which a motion of 1 s exceeds.
fn limited(more: &str) -> String {
    let text = two_link().replacen("robot = ", "[robot]\nfile = ", 1);
    text.replacen("[start]", "limits = { elbow = { velocity = 0.1 } }\n[start]", 1) + more
}

#[test]
fn limits_of_the_robot_are_kept_refused_or_told() {
    let range = ["--continue", "final_time=1:1.05"];
    let asked = "[limits]\nfrom_robot = true\n";
    let output = optimize("refused_limits", &limited(asked), &range);
    assert_eq!(output.status.code(), Some(WRONG));
    assert!(stderr(&output).contains("a continuation keeps no hard limits"), "{}", stderr(&output));
    for method in ["collocation", "shooting"] {
        let text = limited(&format!("{asked}[solver]\nmethod = \"{method}\"\n"));
        let output = optimize("refused_limits", &text, &[]);
        let message = stderr(&output);
        assert!(
            output.status.code() == Some(WRONG) && message.contains("by method = \"direct\" only"),
            "{message}"
        );
    }
    for more in [&[][..], &range] {
        let output = optimize("refused_limits", &limited(""), more);
        let message = stderr(&output);
        // Remarks about a motion stand below its table.
        let table = stdout(&output);
        assert!(table.contains("velocity of joint 'elbow' runs from"), "{more:?}: {table}{message}");
        assert!(!message.contains("limits of the robot are kept"), "{message}");
    }
    let costly = limited("").replace("effort", "energy = 0.1\neffort");
    let output = optimize("refused_limits", &costly, &["--time-limit", "0.2"]);
    let message = stderr(&output);
    assert!(
        message.contains("note: the limits of the robot are kept, since cost.energy is given"),
        "{message}"
    );
}

#[test]
fn problems_without_a_solution_are_refused_before_solving() {
    let mut missing = Missing::new("refused_problems");
    let folder = folder("refused_problems");
    let inertial = "<inertial><mass value=\"0\"/><inertia ixx=\"0\" iyy=\"0\" izz=\"0\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
    let urdf = format!(
        "<robot name=\"light\"><link name=\"base\"/><link name=\"arm\">{inertial}</link><joint name=\"hinge\" \
         type=\"continuous\"><parent link=\"base\"/><child link=\"arm\"/><axis xyz=\"0 0 1\"/></joint></robot>"
    );
    std::fs::write(folder.join("light.urdf"), urdf).unwrap();
    let light =
        "robot = \"light.urdf\"\n[start]\nq = [0]\n[end]\nq = [1]\n[time]\nfinal = 1\n[cost]\neffort = [1]\n";
    missing.check(
        light,
        WRONG,
        Some(1),
        &["robot: joint 'hinge' moves neither mass nor inertia", "robot.armature"],
    );
    let a = with("[end]", "a = [0.0, 0.0]\n[end]");
    missing.check(&a, WRONG, Some(4), &["start.a: ", "'shoulder'", "limits.jerk_max", "cost.torque_rate"]);
    let via = with("", "[[via]]\nq = [0.0, 0.0]\nstop = true");
    missing.check(&via, WRONG, Some(11), &["via 1, q: the start is the same place", "give it a time"]);
    let out = with("[end]", "v = [-1.0, 0.0]\n[end]") + "[limits]\nq_min = [0.0, -3.0]\n";
    missing.check(
        &out,
        WRONG,
        Some(4),
        &["start.v: the position of joint 'shoulder' is at its limit 0", "-1"],
    );
    let floor =
        arm("[end.tool]\nframe = \"tool0\"\nxyz = [0.4, 0.3, -0.3]\n[[obstacle]]\nname = \"floor\"\n\
                     kind = \"half_space\"\nxyz = [0, 0, -0.1]\nnormal = [0, 0, 1]\n[collision]\n\
                     capsules = \"auto\"\nradius = 0.05\n");
    missing.check(&floor, WRONG, Some(12), &["end.tool.xyz: ", "from 'floor' is violated by 0.25 m or more"]);
}

#[test]
fn messages_name_the_key_that_is_wrong() {
    let mut missing = Missing::new("refused_keys");
    let tools = "[end.tool]\nframe = \"tool0\"\n[[end.tool]]\nframe = \"tool0\"\n";
    missing.check(&arm(tools), WRONG, Some(12), &["end.tool: duplicate key"]);
    let penalty = and("penalty", "weight = 1.0\nv_max = [-inf, 1.0]");
    missing.check(&penalty, WRONG, Some(12), &["penalty.v_max: ", "must not be negative", "inf is no limit"]);
    let bounds = and("bounds", "u_min = [-1.0, -1.0]\nu_max = [1.0, -inf]");
    missing.check(&bounds, WRONG, Some(12), &["bounds.u_max: the upper bound -inf of joint 'elbow'"]);
    let turns =
        "[[cost.reference]]\nframe = \"tool0\"\ntimes = [0, 1]\norientations = [[0, 0, 0], [0, 0, 3.2]]\n";
    missing.check(&arm(turns), WRONG, Some(13), &["cost.reference.orientations: ", "half a turn or more"]);
    let many = "[[obstacle]]\nkind = \"sphere\"\nxyz = [9, 9, 9]\nradius = 0.1\n".repeat(1001);
    let bodies = "[collision]\ncapsules = \"auto\"\nradius = 0.05\n";
    missing.check(&arm(&(many + bodies)), WRONG, None, &["obstacle.kind: the task has 1001 of these"]);
    let starts = and("solver", "starts = 9223372036854775807");
    missing.check(&starts, WRONG, Some(11), &["solver.starts: must be between 1 and 1000000"]);
}

#[test]
fn nothing_is_lost_where_a_motion_cannot_be_fed_back_to_or_sampled() {
    let file = empty_folder("refused_feedback").join("feedback.json");
    let path = file.to_str().unwrap();
    let slow = and("limits", "torque_max = [1.0, 1.0]\nfrom_robot = false");
    let output = optimize("refused_feedback", &slow, &["--feedback", path]);
    assert_eq!(output.status.code(), Some(IMPOSSIBLE));
    assert!(
        stdout(&output).contains("locally infeasible") && stdout(&output).contains("beyond its limit 1 N m"),
        "{output:?}"
    );
    assert!(stderr(&output).contains("--feedback: nothing is written") && !file.exists(), "{output:?}");
    // Before the solve where the time is fixed, after it where it is free.
    let output = optimize("refused_feedback", &two_link(), &["--json", "--sample", "2e6"]);
    assert!(output.status.code() == Some(WRONG) && stdout(&output).is_empty(), "{output:?}");
    assert!(stderr(&output).contains("--sample: 2000001 samples"), "{}", stderr(&output));
    let free =
        two_link().replace("final = 1.0", "free = true\nguess = 1.0").replace("effort", "time = 1.0\neffort");
    let output = optimize("refused_feedback", &free, &["--json", "--sample", "1e8"]);
    assert_eq!(output.status.code(), Some(WRONG));
    assert!(json(&output)["status"] == "converged" && stderr(&output).contains("--sample: "), "{output:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_named() {
    let file = folder("refused_full").join("problem.toml");
    std::fs::write(&file, two_link()).unwrap();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut child = command(&["optimize", file.to_str().unwrap(), "--json"]);
    let output = child.stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(WRONG));
    assert!(stderr(&output).contains("standard output cannot be written"), "{}", stderr(&output));
}
