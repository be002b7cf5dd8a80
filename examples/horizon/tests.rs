//! Short runs at a low rate.

use super::plant::Arm;
use super::{controller, follow};

#[test]
fn arms_follow_their_goals_and_keep_their_limits() {
    for arm in [Arm::ur5().unwrap(), Arm::panda().unwrap()] {
        let report = follow(arm, 200.0, 2.0, 3, None).unwrap();
        println!("{report}");
        // A plan may stop before all its limits are kept; what the arm does of it keeps them.
        assert!(report.exceeding <= 20 && report.planned <= 1e-2, "{report}");
        assert!(report.violations.iter().all(|&over| over <= 1e-6), "{report}");
        assert!(report.distance < 0.05, "{report}");
    }
}

/// Where there is no time left, a plan takes the one step that is always made, and the arm keeps its limits.
#[test]
fn plans_without_time_take_one_step() {
    let arm = Arm::panda().unwrap();
    let plans = 100;
    let [as_asked, without] =
        [None, Some(0.0)].map(|share| follow(arm.clone(), 200.0, plans as f64 / 200.0, 6, share).unwrap());
    assert!(as_asked.steps > plans && as_asked.in_time == plans, "{as_asked}");
    assert!(without.steps == plans && without.in_time < plans, "{without}");
    assert!(without.violations.iter().all(|&over| over <= 1e-6), "{without}");
}

#[test]
fn another_run_is_the_same() {
    let plan = || {
        let arm = Arm::ur5().unwrap();
        let mut controller = controller::Controller::new(&arm, 0.005, 3, None).unwrap();
        controller.plan(arm.time, &arm.q, &arm.v).unwrap();
        controller.last.cost
    };
    assert_eq!(plan(), plan());
    assert!(Arm::named("arm").unwrap_err().to_string().contains("ur5 and panda"));
}
