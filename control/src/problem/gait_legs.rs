//! Whether both legs of a gait have the same limits, gains and weights.
//!
//! A step is solved with the limits and the cost of its own joints. In the next one the legs have changed
//! their roles, and it is the mirror image of the first: where joint i takes the place of joint j, with a
//! sign s, its limits are those of j times s,
//!
//! ```text
//! [q_min_i, q_max_i] = s [q_min_j, q_max_j],    r_i = r_j,    |b_i| = |b_j|
//! ```
//!
//! Otherwise the next step may be beyond limits that nothing compares it with, or cost something else.

use super::error::ProblemError;
use super::gait_error::GaitError;
use super::key::Key;
use super::limits::JointLimits;
use super::{Bounds, Penalty, Problem};
use crate::constants::checks::gait::SYMMETRIC;

/// A value of a joint with its key.
type Told = (Key, f64);

impl Problem {
    /// Whether all joints have the same limits, gains, bounds, weights and penalties as those whose places
    /// they take, with signs changed where joints are flipped. Limits of the robot count where they are
    /// [kept](Self::keeps_robot_limits).
    ///
    /// # Errors
    /// [`GaitError::LegsDiffer`] with the key, both joints and both values.
    pub(super) fn check_legs(&self, exchange: &[(usize, f64)]) -> Result<(), ProblemError> {
        // Bounds have keys of their own.
        let limits = Self { bounds: None, ..self.clone() }.joint_limits();
        for (joint, &(other, sign)) in exchange.iter().enumerate() {
            let own = self.told(joint, &limits[joint], false);
            let mirrored = self.told(other, &limits[other], sign < 0.0);
            let mut pairs = own.into_iter().zip(mirrored);
            if let Some(((key, value), (_, expected))) = pairs.find(|(a, b)| !is_same(a.1, b.1)) {
                let (joint, other) = (self.name(joint), self.name(other));
                return Err(GaitError::LegsDiffer { joint, value, other, expected }.at(key));
            }
        }
        Ok(())
    }

    /// What is compared of a joint, in its mirror image if it `flips`.
    fn told(&self, joint: usize, limits: &JointLimits, flips: bool) -> Vec<Told> {
        let range = |[low, high]: [f64; 2], flips| if flips { [-high, -low] } else { [low, high] };
        let entry = |list: &Option<Vec<f64>>, none: f64| list.as_ref().map_or(none, |list| list[joint]);
        let (infinite, gain) = (f64::INFINITY, self.gain[joint]);
        let [q_min, q_max] = range(limits.q, flips);
        let mut told = vec![
            (Key::GAIN, gain.abs()),
            (Key::EFFORT, self.cost.effort[joint]),
            (Key::ENERGY, entry(&self.cost.energy, 0.0)),
            (Key::LIMIT_Q_MIN, q_min),
            (Key::LIMIT_Q_MAX, q_max),
            (Key::LIMIT_V_MAX, limits.v),
            (Key::LIMIT_A_MAX, limits.a),
            // The same in both directions.
            (Key::LIMIT_TORQUE_MAX, limits.torque[1]),
            (Key::LIMIT_POWER_MAX, limits.power),
            (Key::LIMIT_CORNER_SPEED, limits.speeds[0]),
            (Key::LIMIT_NO_LOAD_SPEED, limits.speeds[1]),
        ];
        if let Some(Bounds { u_min, u_max }) = &self.bounds {
            // A motor may be mounted the other way round.
            let [low, high] = range([u_min[joint], u_max[joint]], flips != (gain < 0.0));
            told.extend([(Key::U_MIN, low), (Key::U_MAX, high)]);
        }
        if let Some(Penalty { q_min, q_max, v_max, .. }) = &self.penalty {
            let [low, high] = range([entry(q_min, -infinite), entry(q_max, infinite)], flips);
            told.extend([(Key::Q_MIN, low), (Key::Q_MAX, high), (Key::V_MAX, entry(v_max, infinite))]);
        }
        told
    }
}

/// Whether two values are one, up to rounding.
fn is_same(a: f64, b: f64) -> bool {
    let miss = (a - b).abs();
    a == b || (miss.is_finite() && miss <= SYMMETRIC * a.abs().max(b.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Gait, MotionLimits, Objective};
    use costate::robot::Limits;
    use costate_test_support::robots::file;

    /// A joint of RABBIT and its counterpart.
    const LEFT_HIP: usize = 3;
    const RIGHT_HIP: usize = 5;

    fn step() -> Problem {
        let q = [-0.25, 0.72, 0.1, 0.1, 0.3, -0.6, 0.3];
        let gait = Gait::new(&["right_foot"], &["left_foot"], "base_x", 0.5)
            .with_mirror(&[["left_hip", "right_hip"], ["left_knee", "right_knee"]]);
        Problem::rest_to_rest(file("rabbit.toml"), &q, &q, 0.7)
            .with_cost(Objective::new(0.0, of_motors(1.0)))
            .with_limits(MotionLimits::none().with_torque_max(of_motors(150.0)))
            .with_gait(gait)
    }

    /// A list with zeros for the torso.
    fn of_motors(value: f64) -> Vec<f64> {
        [[0.0; 3].as_slice(), &[value; 4]].concat()
    }

    fn check(problem: &Problem, flipped: &[&str]) -> Result<(), (String, GaitError)> {
        let gait = problem.gait.clone().unwrap().in_space(flipped, 0.0);
        let exchange = problem.exchange(&gait).unwrap();
        problem.check_legs(&exchange).map_err(|error| match error {
            ProblemError::Gait { key, cause } => (format!("{}.{}", key.table(), key.name()), *cause),
            other => panic!("{other}"),
        })
    }

    /// What one leg has and the other has not is refused with its key and both values; what both have is not.
    #[test]
    fn what_differs_is_named() {
        type List = fn(&mut Problem) -> &mut Vec<f64>;
        let changes: [(&str, List); 15] = [
            ("actuation.gain", |problem| &mut problem.gain),
            ("cost.effort", |problem| &mut problem.cost.effort),
            ("cost.energy", |problem| problem.cost.energy.get_or_insert(vec![1.0; 7])),
            ("limits.q_min", |problem| problem.limits.q_min.get_or_insert(vec![1.0; 7])),
            ("limits.q_max", |problem| problem.limits.q_max.get_or_insert(vec![1.0; 7])),
            ("limits.v_max", |problem| problem.limits.v_max.get_or_insert(vec![1.0; 7])),
            ("limits.a_max", |problem| problem.limits.a_max.get_or_insert(vec![1.0; 7])),
            ("limits.torque_max", |problem| problem.limits.torque_max.get_or_insert(vec![1.0; 7])),
            ("limits.power_max", |problem| problem.limits.power_max.get_or_insert(vec![1.0; 7])),
            ("limits.corner_speed", |problem| problem.limits.corner_speed.get_or_insert(vec![1.0; 7])),
            ("limits.no_load_speed", |problem| problem.limits.no_load_speed.get_or_insert(vec![1.0; 7])),
            ("bounds.u_max", |problem| {
                &mut problem.bounds.get_or_insert(Bounds::symmetric(vec![1.0; 7])).u_max
            }),
            ("bounds.u_min", |problem| {
                &mut problem.bounds.get_or_insert(Bounds::symmetric(vec![1.0; 7])).u_min
            }),
            ("penalty.q_min", |problem| {
                problem.penalty.get_or_insert(Penalty::new(1.0)).q_min.get_or_insert(vec![1.0; 7])
            }),
            ("penalty.v_max", |problem| {
                problem.penalty.get_or_insert(Penalty::new(1.0)).v_max.get_or_insert(vec![1.0; 7])
            }),
        ];
        assert_eq!(check(&step(), &[]), Ok(()));
        for (name, list) in changes {
            let mut problem = step();
            list(&mut problem)[LEFT_HIP] = 25.0;
            let expected = list(&mut problem)[RIGHT_HIP];
            let (key, found) = check(&problem, &[]).unwrap_err();
            let (joint, other) = ("left_hip".to_owned(), "right_hip".to_owned());
            assert_eq!((&*key, found), (name, GaitError::LegsDiffer { joint, value: 25.0, other, expected }));
            list(&mut problem)[RIGHT_HIP] = 25.0 * (1.0 + 1e-12);
            assert_eq!(check(&problem, &[]), Ok(()), "{name}");
        }
    }

    /// A limit of one leg alone is one that the other leg does not have.
    #[test]
    fn no_limit_is_not_a_limit() {
        let mut problem = step();
        problem.limits.q_min = Some(vec![f64::NEG_INFINITY; 7]);
        assert_eq!(check(&problem, &[]), Ok(()));
        problem.limits.q_min.as_mut().unwrap()[RIGHT_HIP] = -2.0;
        let (key, found) = check(&problem, &[]).unwrap_err();
        let message = found.to_string();
        assert!(key == "limits.q_min" && message.contains("'left_hip' has -inf"), "{key}: {message}");
        assert!(message.contains("'right_hip' -2"), "{message}");
    }

    /// Limits of the robot count where they are kept.
    #[test]
    fn limits_of_the_robot_count() {
        let mut problem = step();
        let weaker = Limits { effort: 25.0, ..Limits::default() };
        problem.robot = problem.robot.with_limits("right_knee", weaker).unwrap();
        assert_eq!(check(&problem, &[]), Ok(()));
        problem.limits.from_robot = Some(true);
        let (key, found) = check(&problem, &[]).unwrap_err();
        assert!(key == "limits.torque_max" && found.to_string().contains("'left_knee' has 150"), "{found}");
    }

    /// Joints that are flipped have the limits of the mirror image, and those in the middle the same ones in
    /// both directions.
    #[test]
    fn flipped_limits_change_their_signs() {
        let hips = ["left_hip", "right_hip"];
        let mut problem = step();
        problem.limits.q_min = Some(vec![-1.0, -1.0, -1.0, -0.4, -1.0, -0.7, -1.0]);
        problem.limits.q_max = Some(vec![1.0, 1.0, 1.0, 0.7, 1.0, 0.4, 1.0]);
        problem.bounds = Some(Bounds::new(
            vec![-1.0, -1.0, -1.0, -5.0, -1.0, -9.0, -1.0],
            vec![1.0, 1.0, 1.0, 9.0, 1.0, 5.0, 1.0],
        ));
        assert_eq!(check(&problem, &hips), Ok(()));
        assert_eq!(check(&problem, &[]).unwrap_err().0, "limits.q_min");
        // A motor that is mounted the other way round.
        problem.gain[RIGHT_HIP] = -1.0;
        assert_eq!(check(&problem, &hips).unwrap_err().0, "bounds.u_min");
        let Bounds { u_min, u_max } = problem.bounds.as_mut().unwrap();
        (u_min[RIGHT_HIP], u_max[RIGHT_HIP]) = (-5.0, 9.0);
        assert_eq!(check(&problem, &hips), Ok(()));
        let trunk = [&hips[..], &["torso"]].concat();
        assert_eq!(check(&problem, &trunk), Ok(()));
        problem.limits.q_max.as_mut().unwrap()[2] = 0.5;
        let (key, found) = check(&problem, &trunk).unwrap_err();
        let message = found.to_string();
        assert!(key == "limits.q_min" && message.contains("'torso' has -1"), "{key}: {message}");
        assert!(message.contains("-0.5 in the mirror"), "{message}");
    }
}
