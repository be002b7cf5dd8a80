//! Short runs at a low rate.

use super::plant::Arm;
use super::{controller, follow};

#[test]
fn arms_follow_their_goals_and_keep_their_limits() {
    for arm in [Arm::ur5().unwrap(), Arm::panda().unwrap()] {
        let report = follow(arm, 200.0, 2.0, 3).unwrap();
        println!("{report}");
        // A plan may stop before all its limits are kept; what the arm does of it keeps them.
        assert!(report.exceeding <= 20 && report.planned <= 1e-2, "{report}");
        assert!(report.violations.iter().all(|&over| over <= 1e-6), "{report}");
        assert!(report.distance < 0.05, "{report}");
    }
}

#[test]
fn another_run_is_the_same() {
    let plan = || {
        let arm = Arm::ur5().unwrap();
        let mut controller = controller::Controller::new(&arm, 0.005, 3).unwrap();
        controller.plan(arm.time, &arm.q, &arm.v).unwrap();
        controller.last.cost
    };
    assert_eq!(plan(), plan());
    assert!(Arm::named("arm").unwrap_err().to_string().contains("ur5 and panda"));
}
