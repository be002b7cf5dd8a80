//! How far a walking robot is from its mirror image.
//!
//! A gait takes the robot of the next step for the mirror image of that of this step. Robots of files are so
//! up to what was measured or rounded. With the torques tau of a motion and those tau* of the mirrored one,
//! S exchanging the legs,
//!
//! $$ \max_i |S \tau - \tau^\ast|_i \le c\\, m g l $$
//!
//! is taken: m is the mass of the robot, l the length of a leg, so that m g l is the torque that carries the
//! weight at the end of a leg, and c a part of it ([`UNEVEN`]). Every second step needs torques that differ
//! by so much, which is reported. Places of feet must agree up to rounding: otherwise no motion ends where
//! the next step begins. [`Problem::with_symmetric_robot`] makes both exact.

use super::Problem;
use super::error::ProblemError;
use super::gait::Gait;
use super::gait_error::GaitError;
use super::key::Key;
use super::loop_rows::exchanged;
use super::standing::no_foot;
use crate::constants::checks::gait::{SYMMETRIC, UNEVEN, UNEVEN_AXES};
use costate::EvalError;
use costate::constraints::Constraints;
use costate::lagrangian::Lagrangian;
use costate::robot::{
    ConstraintSpec, Robot, RobotError, SymmetryChange, printable, printable_number as number,
};
use std::sync::Arc;

/// The largest difference of the torques of mirrored motions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asymmetry {
    /// The joint.
    pub joint: usize,
    /// The difference (N m, N).
    pub by: f64,
    /// m g l (N m).
    pub scale: f64,
    /// Whether it is more than rounding.
    pub is_real: bool,
}

impl Problem {
    /// With a gait whose robot is the mean of the robot with its mirror image: masses, centres of mass,
    /// inertias, axes and feet of mirrored pairs ([`Robot::symmetrised`]). [`Gait::symmetrised`] has the
    /// largest changes. Without a gait nothing changes.
    ///
    /// # Errors
    /// [`ProblemError::Gait`], [`ProblemError::UnknownJoint`], [`ProblemError::GivenTwice`]: pairs that are
    /// none.
    pub fn with_symmetric_robot(mut self) -> Result<Self, ProblemError> {
        let Some(mut gait) = self.gait.take() else { return Ok(self) };
        let exchange = self.exchange(&gait)?;
        self.check_names(&gait)?;
        let found = self.robot.symmetrised(&exchange, &pairs_of_feet(&gait));
        let (robot, change) = found.map_err(not_mirrored)?;
        gait.symmetrised = Some(change);
        Ok(Self { robot, gait: Some(gait), ..self })
    }

    /// The difference of the torques of some mirrored motions at q.
    pub(super) fn asymmetry(
        &self,
        gait: &Gait,
        exchange: &[(usize, f64)],
        q: &[f64],
    ) -> Result<Asymmetry, EvalError> {
        let some = |first: f64| (0..q.len()).map(|i| (first + 1.7 * i as f64).sin()).collect::<Vec<f64>>();
        let exchanged = |list: &[f64]| exchanged(exchange, list);
        let (v, a) = (some(0.3), some(2.0));
        let mut model = Lagrangian::<f64>::new(&self.robot);
        let tau = exchanged(model.inverse_dynamics(q, &v, &a)?);
        let other = model.inverse_dynamics(&exchanged(q), &exchanged(&v), &exchanged(&a))?;
        let size = tau.iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
        let misses = tau.iter().zip(other).map(|(a, b)| (a - b).abs()).enumerate();
        let (joint, by) = misses.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        let scale = self.weight() * leg_length(&self.robot, gait);
        Ok(Asymmetry { joint, by, scale, is_real: by > SYMMETRIC * size })
    }

    /// m g (N).
    fn weight(&self) -> f64 {
        let mass: f64 = self.robot.joints().iter().map(|joint| joint.inertia.mass).sum();
        mass * self.robot.gravity().norm()
    }

    /// A first guess of the time of a step (s): half a period of a leg that swings as a rod,
    /// `pi sqrt(2 l / (3 g))`.
    pub(super) fn time_of_gait(&self) -> Option<f64> {
        let length = leg_length(&self.robot, self.gait.as_ref()?);
        Some(std::f64::consts::PI * (2.0 * length / (3.0 * self.robot.gravity().norm())).sqrt())
    }

    /// Whether the exchanged robot is the same one up to what a gait takes, with the feet exchanged.
    pub(super) fn check_mirror(
        &self,
        gait: &Gait,
        exchange: &[(usize, f64)],
        q: &[f64],
        shift: &[f64],
    ) -> Result<(), ProblemError> {
        let failed = |error: EvalError| GaitError::CannotStand { cause: error.into() }.at(Key::START_Q);
        let found = self.asymmetry(gait, exchange, q).map_err(failed)?;
        if found.is_real {
            // What is no pair is refused, however light it is.
            let mean = self.robot.symmetrised(exchange, &pairs_of_feet(gait));
            let (_, change) = mean.map_err(not_mirrored)?;
            if found.by > UNEVEN * found.scale {
                let [place, direction] = [change.place.amount, change.direction.amount];
                let length = found.scale / self.weight();
                let fits = place <= UNEVEN_AXES * length && direction <= UNEVEN_AXES;
                let (joint, by, share) = (self.name(found.joint), found.by, found.by / found.scale);
                let changes = fits.then(|| in_words(&change));
                return Err(GaitError::NotSymmetric { joint, by, share, changes }.at(Key::GAIT_MIRROR));
            }
        }
        let moved = |list: &[f64]| {
            exchanged(exchange, list).iter().zip(shift).map(|(q, shift)| q + shift).collect::<Vec<f64>>()
        };
        let place = |frame: &str, q: &[f64]| -> Result<Vec<f64>, ProblemError> {
            let robot = self.robot.with_constraint(ConstraintSpec::rigid(frame, frame, "world"));
            let mut foot = Constraints::<f64>::new(&robot.map_err(no_foot)?);
            foot.set_position(q).map_err(failed)?;
            Ok(foot.values().to_vec())
        };
        for (swings, stands) in gait.swing.iter().zip(&gait.stance) {
            let (here, there) = (place(swings, q)?, place(stands, &moved(q))?);
            let across = if gait.is_in_space() { here[1] + there[1] } else { 0.0 };
            let miss = (here[0] - gait.length - there[0]).hypot(here[2] - there[2]).hypot(across);
            if miss > SYMMETRIC * gait.length.max(1.0) {
                let is_slight = miss <= UNEVEN_AXES * leg_length(&self.robot, gait);
                return Err(GaitError::FeetStay { miss, is_slight }.at(Key::GAIT_MIRROR));
            }
            // The sole that swings is flat here.
            if gait.sole.is_some() && there[3..].iter().any(|angle| angle.abs() > SYMMETRIC) {
                return Err(GaitError::SolesDiffer { frame: stands.clone() }.at(Key::GAIT_MIRROR));
            }
        }
        Ok(())
    }
}

/// The largest changes as text.
pub(super) fn in_words(change: &SymmetryChange) -> String {
    let kinds = [
        (&change.mass, "masses", "kg"),
        (&change.com, "centres of mass", "m"),
        (&change.inertia, "inertias", "kg m^2"),
        (&change.place, "places of axes and feet", "m"),
        (&change.direction, "their directions", "rad"),
    ];
    let parts = kinds.iter().filter(|(change, ..)| change.amount > 0.0).map(|(change, what, unit)| {
        format!("{what} by up to {} {unit} ('{}')", rounded(change.amount), printable(&change.name))
    });
    match parts.collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => "nothing".into(),
        parts => parts,
    }
}

/// Two digits.
fn rounded(value: f64) -> String {
    number(format!("{value:.1e}").parse().unwrap_or(value))
}

/// A pair of joints that is none.
fn not_mirrored(error: RobotError) -> ProblemError {
    GaitError::NotMirrored { cause: Arc::new(error) }.at(Key::GAIT_MIRROR)
}

/// Each foot with the one that lands in its place.
fn pairs_of_feet(gait: &Gait) -> Vec<[String; 2]> {
    gait.stance.iter().zip(&gait.swing).map(|(stands, swings)| [stands.clone(), swings.clone()]).collect()
}

/// The length of the links from the first joint that moves a foot alone to the foot (m), the longest one of
/// all feet; 1 m if there is none.
fn leg_length(robot: &Robot, gait: &Gait) -> f64 {
    let joints = robot.joints();
    let path = |name: &String| -> Option<(Vec<usize>, f64)> {
        let frame = robot.frame(name).ok()?;
        let mut path = Vec::new();
        let mut next = frame.joint;
        while let Some(joint) = next {
            path.push(joint);
            next = joints[joint].parent;
        }
        Some((path, frame.placement.translation.norm()))
    };
    let feet: Vec<(Vec<usize>, f64)> = gait.stance.iter().chain(&gait.swing).filter_map(path).collect();
    let alone = |joint: &usize| feet.iter().filter(|(path, _)| path.contains(joint)).count() == 1;
    let length = |(path, own): &(Vec<usize>, f64)| {
        let of_leg: Vec<usize> = path.iter().copied().filter(alone).collect();
        // The last one is where the leg begins.
        let links = of_leg.iter().rev().skip(1).map(|&joint| joints[joint].placement.translation.norm());
        if of_leg.is_empty() { 0.0 } else { own + links.sum::<f64>() }
    };
    let longest = feet.iter().map(length).fold(0.0, f64::max);
    if longest > 0.0 && longest.is_finite() { longest } else { 1.0 }
}
