//! Laws of physics that a motion does not keep, in words.

use crate::numbers::short;
use costate_control::{LimitViolation, Problem};

/// That a joint without a motor would need a torque, or that a constraint is not kept; `None` for a limit,
/// which could be widened.
pub(crate) fn not_kept(problem: &Problem, kind: &str, worst: &LimitViolation) -> Option<String> {
    if kind != "torque" || worst.limit != 0.0 {
        return None;
    }
    let LimitViolation { name, unit, .. } = worst;
    let (value, time) = (short(worst.value, 4), short(worst.time, 4));
    Some(match problem.robot.joints().iter().any(|joint| joint.name == *name) {
        true => format!("joint '{name}', which has no motor, would need {value} {unit} at t = {time} s"),
        false => format!("the constraint '{name}' is not kept at t = {time} s"),
    })
}

#[cfg(test)]
mod tests {
    use super::not_kept;
    use costate::robot::LoadOptions;
    use costate_control::{LimitViolation, ProblemFile};
    use serde_json::json;

    #[test]
    fn laws_are_told_apart_from_limits() {
        let file = "../../examples/problems/four_bar.toml";
        let problem = ProblemFile::read(file, LoadOptions::default()).unwrap().problem;
        let told = |joint: &str, kind: &str, limit: f64| {
            let worst = json!({
                "joint": joint, "time": 0.5, "excess": 3.0, "unit": "N m", "value": 3.0 + limit, "limit": limit,
            });
            let worst: LimitViolation = serde_json::from_value(worst).unwrap();
            not_kept(&problem, kind, &worst)
        };
        let constraint = told("rocker_pivot", "torque", 0.0);
        assert_eq!(constraint.unwrap(), "the constraint 'rocker_pivot' is not kept at t = 0.5 s");
        let joint = told("coupler", "torque", 0.0);
        assert_eq!(joint.unwrap(), "joint 'coupler', which has no motor, would need 3 N m at t = 0.5 s");
        assert!(told("crank", "torque", 8.0).is_none() && told("crank", "rate", 0.0).is_none());
    }
}
