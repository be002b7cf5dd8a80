//! Scales of a problem: where along a motion something narrow happens, and how wide it is.
//!
//! Rules of quadrature and error estimates see only what happens at their points. Dry friction changes its
//! sign within a few transition velocities, a reference may move between two knots that are close together, a
//! motor has a corner, energy is recovered or not by the sign of a power. A mesh whose points all lie beside
//! such a place computes a wrong cost, and every comparison that looks at the same points confirms it. So
//! these places are listed here once: they seed meshes, split quadratures, and name the culprit where a mesh
//! cannot resolve them.
//!
//! A place is a level of a quantity that is a polynomial on an interval of a motion: a rate, the time, a
//! power. So its crossings are found as roots ([`roots`]), not by sampling.

use super::{Problem, Shape};
use crate::numerics::roots::{MOST_COEFFICIENTS, roots};
use costate::lagrangian::Lagrangian;

/// Transition velocities to either side of rest between which smooth Coulomb friction changes: tanh(3) =
/// 0.995.
pub(crate) const TRANSITION: f64 = 3.0;
/// Smoothings of the energy to either side of no power between which its cost bends: the slope is 0.987
/// there.
const BEND: f64 = 3.0;
/// Below this part of the transition velocity friction is linear: tanh(x) is x up to a thousandth.
const LINEAR: f64 = 0.05;
/// Places closer than this, relative to the interval, are one, and one this close to an end of the interval
/// is that end.
const SAME: f64 = 1e-9;

/// Something narrow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Feature {
    pub kind: Kind,
    /// Where it is, in the quantity of its kind: a rate (rad/s, m/s), a time (s), a power (W). Zero for those
    /// that are everywhere.
    pub place: f64,
    /// Half of its width, in the same unit; zero for a corner. Of springs the time constant (s), of obstacles
    /// a length (m).
    pub width: f64,
}

/// The kinds of what is narrow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Coulomb friction of a joint changes its sign within transition velocities around rest.
    Friction { joint: usize },
    /// A knot of a reference, at a time; the width is the shorter way to a neighbour.
    Knot { reference: usize },
    /// The largest torque of the motor of a joint bends at its corner speed, or vanishes at its no-load
    /// speed.
    Motor { joint: usize },
    /// The cost of the energy of a joint bends where its power changes its sign.
    Energy { joint: usize },
    /// A joint swings on its spring with the time constant `sqrt(m/k)`, all along.
    Spring { joint: usize },
    /// An obstacle that is this thin, wherever a body passes it.
    Obstacle { obstacle: usize },
}

/// All that is narrow in a problem.
#[derive(Clone, Debug, Default)]
pub(crate) struct Narrow {
    pub features: Vec<Feature>,
}

/// A motion on one interval: polynomials in the part x of the interval, from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece<'a> {
    /// The time since the start of the motion at which the interval begins (s), with that of references
    /// added.
    pub start: f64,
    /// How long it takes (s).
    pub length: f64,
    /// Coefficients of q, lowest power first, all of one joint after those of another one.
    pub q: &'a [f64],
    /// Number of coefficients of a joint.
    pub count: usize,
    /// Coefficients of polynomials near the torques, three for each joint, lowest power first; empty if not
    /// known: then powers count as zero where rates are.
    pub tau: &'a [f64],
}

impl Narrow {
    /// That of a problem.
    pub fn of(problem: &Problem) -> Self {
        let mut features = Vec::new();
        let joints = problem.robot.joints();
        for (index, joint) in joints.iter().enumerate().filter(|(_, joint)| joint.friction.coulomb > 0.0) {
            // A joint that mimics another one is at rest with it.
            let (leader, ratio) = joint.mimic.map_or((index, 1.0), |mimic| (mimic.joint, mimic.ratio));
            let row = problem.robot.independent_indices().iter().position(|&own| own == leader);
            if let Some(joint_row) = row.filter(|_| ratio != 0.0) {
                let width = joint.friction.coulomb_velocity / ratio.abs();
                features.push(Feature { kind: Kind::Friction { joint: joint_row }, place: 0.0, width });
            }
        }
        for (reference, found) in
            problem.task.references.iter().enumerate().filter(|(_, found)| found.costs())
        {
            let times = found.times();
            for (k, &place) in times.iter().enumerate() {
                let before = k.checked_sub(1).map(|before| place - times[before]);
                let after = times.get(k + 1).map(|after| after - place);
                let width = before.into_iter().chain(after).fold(f64::INFINITY, f64::min);
                features.push(Feature { kind: Kind::Knot { reference }, place, width });
            }
        }
        for (joint, limits) in problem.joint_limits().iter().enumerate() {
            let speeds = limits.speeds.into_iter().filter(|_| limits.speeds[1].is_finite());
            let sides = speeds.flat_map(|speed| [speed, -speed]);
            let kind = Kind::Motor { joint };
            features.extend(sides.map(|place| Feature { kind, place, width: 0.0 }));
        }
        let weights = problem.cost.energy.iter().flatten().enumerate().filter(|(_, weight)| **weight != 0.0);
        features.extend(weights.map(|(joint, _)| Feature {
            kind: Kind::Energy { joint },
            place: 0.0,
            width: problem.cost.energy_smoothing,
        }));
        features.extend(springs(problem));
        features.extend(problem.task.obstacles.iter().enumerate().filter_map(|(obstacle, found)| {
            let width = match &found.shape {
                Shape::Sphere { radius, .. } | Shape::Capsule { radius, .. } => *radius,
                Shape::Box { size, .. } => 0.5 * size.iter().copied().fold(f64::INFINITY, f64::min),
                Shape::HalfSpace { .. } => return None,
            };
            Some(Feature { kind: Kind::Obstacle { obstacle }, place: 0.0, width })
        }));
        Self { features }
    }

    /// The same without knots, and their times (s), rising, each once.
    pub fn without_knots(mut self) -> (Self, Vec<f64>) {
        let times = self.times();
        self.features.retain(|feature| !matches!(feature.kind, Kind::Knot { .. }));
        (self, times)
    }

    /// Dry friction alone.
    pub fn friction(&self) -> Self {
        let is_friction = |feature: &&Feature| matches!(feature.kind, Kind::Friction { .. });
        Self { features: self.features.iter().filter(is_friction).copied().collect() }
    }

    /// What rates cross: dry friction, and speeds of motors.
    pub fn of_rates(&self) -> Self {
        let is_of_rates =
            |feature: &&Feature| matches!(feature.kind, Kind::Friction { .. } | Kind::Motor { .. });
        Self { features: self.features.iter().filter(is_of_rates).copied().collect() }
    }

    /// Whether anything has places along a motion.
    pub fn has_places(&self) -> bool {
        let has = |feature: &Feature| !matches!(feature.kind, Kind::Spring { .. } | Kind::Obstacle { .. });
        self.features.iter().any(has)
    }

    /// The times that references name (s), rising, each once.
    pub fn times(&self) -> Vec<f64> {
        let knots = self.features.iter().filter(|feature| matches!(feature.kind, Kind::Knot { .. }));
        let mut times: Vec<f64> = knots.map(|knot| knot.place).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Whether a piece begins or ends within the transition of a friction, or at an end of it, and is not at
    /// rest.
    pub fn touches(&self, piece: &Piece<'_>) -> bool {
        self.features.iter().any(|feature| {
            let Kind::Friction { joint } = feature.kind else { return false };
            let (rate, count) = piece.rate(joint);
            let ends = [rate[0], rate[..count].iter().sum::<f64>()].map(|rate| rate.abs() / piece.length);
            let (least, most) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            least <= TRANSITION * feature.width * (1.0 + SAME) && most > LINEAR * feature.width
        })
    }

    /// Replaces `places` by those of a piece of a motion, rising, in (0, 1), where something narrow starts,
    /// ends or has its centre: where a rate crosses rest and [`TRANSITION`] transition velocities to either
    /// side, or a speed of a motor; at knots; where a power changes its sign.
    ///
    /// A rate that stays within its transition velocity crosses nothing: friction is linear there.
    pub fn places(&self, piece: &Piece<'_>, places: &mut Vec<f64>) {
        places.clear();
        for feature in &self.features {
            feature.add_places(piece, places);
        }
        places.sort_by(f64::total_cmp);
        places.retain(|x| (SAME..=1.0 - SAME).contains(x));
        places.dedup_by(|next, before| *next - *before < SAME);
    }
}

impl Feature {
    /// Adds its places in a piece of a motion, as [`Narrow::places`].
    pub fn add_places(&self, piece: &Piece<'_>, places: &mut Vec<f64>) {
        let Self { kind, place, width } = *self;
        match kind {
            Kind::Friction { joint } => {
                let (rate, count) = piece.rate(joint);
                let ends = [TRANSITION, -TRANSITION].map(|factor| factor * width);
                let before = places.len();
                ends.iter().for_each(|level| roots(&rate[..count], level * piece.length, places));
                // Without these: beyond the transition all along, or within it.
                if places.len() > before || piece.exceeds(&rate[..count], width) {
                    roots(&rate[..count], 0.0, places);
                }
            }
            Kind::Motor { joint } => {
                let (rate, count) = piece.rate(joint);
                roots(&rate[..count], place * piece.length, places);
            }
            Kind::Knot { .. } => places.push((place - piece.start) / piece.length),
            Kind::Energy { joint } => {
                let (power, count) = piece.power(joint);
                roots(&power[..count], 0.0, places);
                let ends = [-BEND, BEND].map(|factor| factor * width * piece.length);
                let is_known = !piece.tau.is_empty();
                ends.iter().filter(|_| is_known).for_each(|level| roots(&power[..count], *level, places));
            }
            Kind::Spring { .. } | Kind::Obstacle { .. } => {}
        }
    }
}

impl Piece<'_> {
    /// Coefficients of dq/dx of a joint.
    fn rate(&self, joint: usize) -> ([f64; MOST_COEFFICIENTS], usize) {
        let mut rate = [0.0; MOST_COEFFICIENTS];
        let own = self.q.get(self.count * joint..self.count * (joint + 1)).unwrap_or_default();
        let count = own.len().clamp(1, MOST_COEFFICIENTS) - 1;
        for (k, (to, from)) in rate.iter_mut().zip(own.iter().skip(1)).enumerate() {
            *to = (k + 1) as f64 * from;
        }
        (rate, count)
    }

    /// Coefficients of the product of dq/dx and the torque of a joint.
    fn power(&self, joint: usize) -> ([f64; MOST_COEFFICIENTS], usize) {
        let (rate, count) = self.rate(joint);
        let Some(tau) = self.tau.get(3 * joint..3 * (joint + 1)) else { return (rate, count) };
        let mut power = [0.0; MOST_COEFFICIENTS];
        for (i, rate) in rate[..count].iter().enumerate() {
            for (j, tau) in tau.iter().enumerate().filter(|(j, _)| i + j < MOST_COEFFICIENTS) {
                power[i + j] += rate * tau;
            }
        }
        (power, (count + 2).min(MOST_COEFFICIENTS))
    }

    /// Whether the magnitude of a rate exceeds `least` (rad/s, m/s) at an end.
    fn exceeds(&self, rate: &[f64], least: f64) -> bool {
        let ends = [rate.first().copied().unwrap_or(0.0), rate.iter().sum::<f64>()];
        ends.iter().any(|end| end.abs() > least * self.length)
    }
}

/// Time constants `sqrt(M_ii/k)` of the springs of joints, with the inertias at the start; none where the
/// dynamics cannot be evaluated there.
fn springs(problem: &Problem) -> Vec<Feature> {
    let robot = &problem.robot;
    let all: Vec<(usize, f64)> = robot
        .independent_joints()
        .enumerate()
        .map(|(joint, found)| (joint, found.spring.stiffness))
        .filter(|(_, stiffness)| *stiffness > 0.0)
        .collect();
    if all.is_empty() || !robot.free_joints().is_empty() || problem.start.q.len() != robot.dof() {
        return Vec::new();
    }
    let (mut model, zeros) = (Lagrangian::<f64>::new(robot), vec![0.0; robot.dof()]);
    let Ok(torque) = model.linearise_inverse_dynamics(&problem.start.q, &zeros, &zeros) else {
        return Vec::new();
    };
    let of = |&(joint, stiffness): &(usize, f64)| Feature {
        kind: Kind::Spring { joint },
        place: 0.0,
        width: (torque.tau_a[(joint, joint)] / stiffness).sqrt(),
    };
    all.iter().map(of).collect()
}

#[cfg(test)]
#[path = "narrow_tests.rs"]
mod tests;
