//! The problems of the study, drawn from the number of the pair.

use costate::robot::{LoadOptions, Robot, RobotError, file};
use costate_control::{Penalty, Problem};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Pairs of start and end for each robot.
pub const PAIRS: usize = 40;
/// How many of them have a variant with penalties, which takes longest.
const PAIRS_WITH_PENALTIES: usize = 12;

/// A robot of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RobotName {
    VerticalArm,
    ManutecR3,
    Puma560,
    Puma560WithoutArmature,
    Panda,
}

/// What makes a problem harder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Variant {
    Plain,
    Penalties,
    LongTime,
}

impl Variant {
    pub const ALL: [Self; 3] = [Self::Plain, Self::Penalties, Self::LongTime];

    /// Those of a pair.
    pub fn of(pair: usize) -> impl Iterator<Item = Self> {
        let kept = move |variant: &Self| *variant != Self::Penalties || pair < PAIRS_WITH_PENALTIES;
        Self::ALL.into_iter().filter(kept)
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Penalties => "stiff penalties",
            Self::LongTime => "long T",
        }
    }
}

impl RobotName {
    pub const ALL: [Self; 5] =
        [Self::VerticalArm, Self::ManutecR3, Self::Puma560, Self::Puma560WithoutArmature, Self::Panda];

    pub fn name(self) -> &'static str {
        match self {
            Self::VerticalArm => "vertical two-link arm",
            Self::ManutecR3 => "Manutec r3",
            Self::Puma560 => "PUMA 560",
            Self::Puma560WithoutArmature => "PUMA 560 without armature",
            Self::Panda => "Panda",
        }
    }

    pub fn load(self) -> Result<Robot, RobotError> {
        let options = LoadOptions::default();
        let from = |text: &str| file::parse(text, options);
        match self {
            Self::VerticalArm => from(
                &include_str!("../../../robots/two_link.toml")
                    .replace("gravity = [0.0, 0.0, 0.0]", "gravity = [0.0, -9.81, 0.0]"),
            ),
            Self::ManutecR3 => from(include_str!("../../../robots/manutec_r3.toml")),
            Self::Puma560 => from(include_str!("../../../robots/puma560.toml")),
            Self::Puma560WithoutArmature => {
                let text = include_str!("../../../robots/puma560.toml");
                let kept = text.lines().filter(|line| !line.starts_with("armature"));
                from(&kept.collect::<Vec<_>>().join("\n"))
            }
            Self::Panda => Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/panda.urdf")),
        }
    }

    /// Time of a motion (s) for which the search from the cubic leads to the end often, but not always.
    fn time(self) -> f64 {
        match self {
            Self::VerticalArm | Self::Puma560 => 1.0,
            Self::ManutecR3 => 0.7,
            Self::Puma560WithoutArmature | Self::Panda => 0.35,
        }
    }

    /// Largest torques (N m), for the weights of the effort: those of the robot, for the vertical arm its
    /// weight at full stretch.
    fn torques(self, robot: &Robot) -> Vec<f64> {
        match self {
            Self::VerticalArm => vec![4.0 * 9.81, 1.5 * 9.81],
            _ => robot.independent_joints().map(|joint| joint.limits.effort).collect(),
        }
    }
}

/// The problem of a pair: from rest to rest, effort weighted by 1 over the squares of the largest torques.
///
/// The start lies within the limits of the robot and (-pi, pi), the end up to a reach from it in each joint
/// and within the same limits; the reach is drawn between 0.2 and 1.5 rad. The time is 0.7 to 1.3 of that of
/// the robot, a long one 1.5 to 4 times as long. Penalties hold positions to 0.1 rad beyond both ends and
/// rates to 1.2 times the mean rate of the joint, or 0.3 times that of the fastest; their weight is 1e2 to
/// 1e6 times the smallest weight of the effort.
pub fn problem(name: RobotName, variant: Variant, pair: usize) -> Result<Problem, RobotError> {
    let robot = name.load()?;
    let n = robot.dof();
    let mut random = fastrand::Rng::with_seed(1000 * name as u64 + pair as u64);
    let mut between = |low: f64, high: f64| low + (high - low) * random.f64();
    let reach = between(0.2, 1.5);
    let (mut from, mut to) = (Vec::new(), Vec::new());
    for joint in robot.independent_joints() {
        let (low, high) = (joint.limits.lower.max(-PI), joint.limits.upper.min(PI));
        let q = between(low, high);
        from.push(q);
        to.push(between((q - reach).max(low), (q + reach).min(high)));
    }
    let mut time = name.time() * between(0.7, 1.3);
    let longer = between(1.5, 4.0);
    let effort: Vec<f64> = name.torques(&robot).iter().map(|torque| torque.powi(-2)).collect();
    let weight = 10.0_f64.powf(between(2.0, 6.0)) * effort.iter().copied().fold(f64::INFINITY, f64::min);
    if variant == Variant::LongTime {
        time *= longer;
    }
    let mut problem = Problem::rest_to_rest(robot, &from, &to, time);
    problem.cost.effort = effort;
    if variant == Variant::Penalties {
        let rates: Vec<f64> = from.iter().zip(&to).map(|(from, to)| (to - from).abs() / time).collect();
        let fastest = rates.iter().fold(0.0_f64, |most, rate| most.max(*rate));
        problem.penalty = Some(
            Penalty::new(weight)
                .with_q_min((0..n).map(|j| from[j].min(to[j]) - 0.1).collect())
                .with_q_max((0..n).map(|j| from[j].max(to[j]) + 0.1).collect())
                .with_v_max(rates.iter().map(|rate| 1.2 * rate.max(0.3 * fastest)).collect()),
        );
    }
    Ok(problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_problems_can_be_posed_and_variants_share_their_ends() {
        for robot in RobotName::ALL {
            let plain = problem(robot, Variant::Plain, 3).unwrap();
            for variant in Variant::ALL {
                let problem = problem(robot, variant, 3).unwrap();
                problem.check().unwrap();
                assert_eq!((&problem.start, &problem.end), (&plain.start, &plain.end));
            }
            assert_ne!(plain.end.q, problem(robot, Variant::Plain, 4).unwrap().end.q);
        }
    }

    #[test]
    fn robots_that_were_changed_are_changed() {
        let vertical = costate::hamiltonian::Hamiltonian::<f64>::new(&RobotName::VerticalArm.load().unwrap())
            .evaluate(&[0.0; 2], &[0.0; 2], &[0.0; 2])
            .unwrap()
            .to_vec();
        assert!((vertical[2] + 4.0 * 9.81).abs() < 1e-12 && (vertical[3] + 1.5 * 9.81).abs() < 1e-12);
        let mass = |name: RobotName| {
            let mut hamiltonian = costate::hamiltonian::Hamiltonian::<f64>::new(&name.load().unwrap());
            hamiltonian.mass_matrix(&[0.3; 6]).unwrap()[(5, 5)]
        };
        assert!((mass(RobotName::Puma560) - mass(RobotName::Puma560WithoutArmature) - 0.193).abs() < 1e-12);
    }
}
