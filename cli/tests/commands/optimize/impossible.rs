//! Tasks that cannot be done: exit status 3, and a proof, or the limit that is exceeded, and by how much.

use super::missing::{IMPOSSIBLE, Missing, and, arm, with};

#[test]
fn tasks_that_cannot_be_done_end_with_a_proof_or_with_what_is_exceeded() {
    let mut missing = Missing::new("input_impossible");
    let limits = |lines: &str| and("limits", &format!("from_robot = false\n{lines}"));
    for (text, parts) in [
        // Half a radian in a second.
        (
            limits("v_max = [inf, 0.4]"),
            &["no motion keeps all limits: joint 'elbow' needs 1.25 s", "its rate limit is 0.4 rad/s"][..],
        ),
        // From bound to bound a radian in a second takes 4 rad/s^2.
        (
            limits("a_max = [3.0, inf]"),
            &["joint 'shoulder' needs 1.155 s", "its acceleration limit is 3 rad/s^2"],
        ),
        (
            limits("torque_max = [1.0, 1.0]"),
            &[
                "no motion that keeps all limits was found",
                "the violation has a local minimum",
                "the torque of joint 'shoulder' is",
                "N m beyond its limit 1 N m (at t = ",
                "with a final time of",
                "another guess (solver.starts)",
            ],
        ),
        (
            limits("total_power_max = 0.5"),
            &["the power of all joints is", "W beyond its limit 0.5 W (at t = "],
        ),
        (
            limits("v_max = [1.01, 9.0]\na_max = [4.1, 9.0]"),
            &["joint 'shoulder' needs 1.236 s", "and has 1 s"],
        ),
    ] {
        missing.check(&text, IMPOSSIBLE, None, parts);
    }
    let slow = arm("[[keep]]\nkind = \"speed\"\nframe = \"tool0\"\nspeed = 0.5\n");
    missing.check(&slow, IMPOSSIBLE, None, &["the speed of the tool 'tool0' is off by", "m/s (at t = "]);
    // Too fast to stop before its limit.
    let fast = with("q = [0.0, 0.0]", "q = [0.0, 0.0]\nv = [0.0, 1.0]").replace("[1.0, 0.5]", "[0.0, 0.1]");
    let narrow = "[limits]\nfrom_robot = false\nq_min = [-0.001, -9.0]\nq_max = [0.001, 0.101]\n\
                  torque_max = [4.0, 2.0]\n";
    missing.check(
        &(fast + narrow),
        IMPOSSIBLE,
        None,
        &["the position of joint 'elbow' is", "beyond its limit 0.101 rad"],
    );
    // Between a ball and the edge of the strip in which the tip stays there is no room for it.
    let strip = with(
        "",
        "[[keep]]\nkind = \"plane\"\nframe = \"joint:elbow\"\noffset = [1, 0, 0]\n\
         through = [1.2, 0, 0]\nnormal = [1, 0, 0]\ndistance = 0.05\n\
         [[obstacle]]\nname = \"ball\"\nkind = \"sphere\"\nxyz = [1.32, 0, 0]\nradius = 0.1\n\
         [[collision.capsule]]\nname = \"tip\"\nframe = \"joint:elbow\"\nfrom = [1, 0, 0]\nradius = 0.1\n\
         [limits]\nfrom_robot = false\ntorque_max = [30.0, 30.0]\nv_max = [9.0, 9.0]",
    )
    .replace("q = [0.0, 0.0]", "q = [-1.299129, 1.670964]")
    .replace("q = [1.0, 0.5]", "q = [-0.371834, 1.670964]");
    let parts = ["the clearance of 'tip' from 'ball' is off by 0.018", " m (at t = 0."];
    missing.check(&strip, IMPOSSIBLE, None, &parts);
    // A radian in a second, without accelerations at the ends.
    let at_rest = |lines: &str| {
        let text = with("q = [0.0, 0.0]", "q = [0.0, 0.0]\na = [0.0, 0.0]");
        text.replace("q = [1.0, 0.5]", "q = [1.0, 0.5]\na = [0.0, 0.0]")
            + &format!("[limits]\nfrom_robot = false\n{lines}\n")
    };
    for (lines, parts) in [
        ("jerk_max = [5.0, 1e4]", &["jerk", "5 rad/s^3", "'shoulder'"][..]),
        ("torque_rate_max = [5.0, 5.0]", &["the rate of the torque of", "5 N m/s", "'shoulder'"]),
    ] {
        missing.check(&at_rest(lines), IMPOSSIBLE, None, parts);
    }
    // Motors that are too slow: nobody set a torque there.
    let motors = "torque_max = [20.0, 20.0]\ncorner_speed = [0.1, 0.1]\nno_load_speed = [0.2, 0.2]";
    let parts = ["the motor of joint 'shoulder'", "limits.no_load_speed 0.2 rad/s", "the motion needs "];
    missing.check(&limits(motors), IMPOSSIBLE, None, &parts);
}
