//! What is checked of a gait before it is prepared as a problem.

use super::error::ProblemError;
use super::gait::Gait;
use super::gait_error::GaitError;
use super::key::Key;
use super::standing::no_foot;
use super::{BoundaryState, Problem};
use crate::constants::checks::gait::{MOST_FRICTION, PLANAR};
use costate::constraints::Constraints;
use costate::robot::{ConstraintSpec, JointKind, RobotError};

/// Whether the numbers of a gait are in their ranges.
pub(super) fn check_numbers(gait: &Gait) -> Result<(), ProblemError> {
    let [length, friction, clearance] = [gait.length, gait.friction, gait.clearance];
    positive(Key::GAIT_LENGTH, length)?;
    positive(Key::GAIT_FRICTION, friction)?;
    if friction > MOST_FRICTION {
        let remedy =
            "must be at most 100, which holds a foot as well: edges of a wider cone are nearly one line";
        return Err(GaitError::OutOfRange { value: friction, remedy }.at(Key::GAIT_FRICTION));
    }
    if !(clearance >= 0.0 && clearance.is_finite()) {
        let remedy = "must be neither negative nor infinite (m)";
        return Err(GaitError::OutOfRange { value: clearance, remedy }.at(Key::GAIT_CLEARANCE));
    }
    let Some(value) = gait.sole.map(|[heel, toe]| toe - heel) else { return Ok(()) };
    let remedy = "the length from heel to toe (m) must be positive and finite";
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(GaitError::OutOfRange { value, remedy }.at(Key::GAIT_SOLE)),
    }
}

fn positive(key: Key, value: f64) -> Result<(), ProblemError> {
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(GaitError::OutOfRange { value, remedy: "must be positive and finite" }.at(key)),
    }
}

impl Problem {
    /// Whether gravity presses the feet on the ground, the plane z = 0 of the world: along -z.
    ///
    /// # Errors
    /// [`GaitError::NotLevel`].
    pub(super) fn check_gravity(&self) -> Result<(), ProblemError> {
        let [x, y, z] = self.robot.gravity().into();
        match z < 0.0 && f64::hypot(x, y) <= PLANAR * z.abs() {
            true => Ok(()),
            false => Err(GaitError::NotLevel { gravity: [x, y, z] }.at(Key::ROBOT_GRAVITY)),
        }
    }

    /// Whether the feet are frames, each named once, and paired.
    pub(super) fn check_names(&self, gait: &Gait) -> Result<(), ProblemError> {
        let (stance, swing) = (gait.stance.len(), gait.swing.len());
        if stance != swing || stance == 0 {
            return Err(GaitError::Unpaired { stance, swing }.at(Key::GAIT_SWING));
        }
        let mut known: Vec<&String> = Vec::new();
        for (key, feet) in [(Key::GAIT_STANCE, &gait.stance), (Key::GAIT_SWING, &gait.swing)] {
            for frame in feet {
                self.foot(key, frame)?;
                if known.contains(&frame) {
                    return Err(GaitError::OneFoot { frame: frame.clone() }.at(key));
                }
                known.push(frame);
            }
        }
        Ok(())
    }

    /// What gaits do not take, given accelerations among it.
    ///
    /// # Errors
    /// [`GaitError::Constrained`], [`GaitError::NotTaken`] with the key.
    pub(super) fn refuse_with_gait(&self) -> Result<(), ProblemError> {
        if self.gait.is_none() {
            return Ok(());
        }
        if let Some(one) = self.robot.constraints().first() {
            return Err(GaitError::Constrained { constraint: one.name.clone() }.at(Key::GAIT_STANCE));
        }
        let terms = (!self.terms.is_empty()).then_some(Key::TERMS);
        let first = self.task.first_key().or_else(|| self.first_of_rates());
        let via = self.vias.first().map(|_| Key::via("q", 0));
        let periodic = self.periodic.as_ref().map(|_| Key::PERIODIC_SHIFT);
        let first = first.or(via).or(periodic).or(terms);
        match first.or_else(|| self.first_of_given_ends()) {
            Some(with) => Err(GaitError::NotTaken { with }.at(Key::GAIT_STANCE)),
            None => Ok(()),
        }
    }

    /// The first key of the ends of a step, of which all rates and positions are found, that is given but
    /// for positions: those of the start are a guess, and those of the end are always there.
    fn first_of_given_ends(&self) -> Option<Key> {
        let Self { start, end, .. } = self;
        let moves = |end: &BoundaryState| end.v.iter().any(|&v| v != 0.0);
        let given = [
            (moves(start), Key::START_V),
            (!start.q_free.is_empty(), Key::START_Q_FREE),
            (!start.v_free.is_empty(), Key::START_V_FREE),
            (moves(end), Key::END_V),
            (!end.q_free.is_empty(), Key::END_Q_FREE),
            (!end.v_free.is_empty(), Key::END_V_FREE),
        ];
        given.into_iter().find(|(is_given, _)| *is_given).map(|(_, key)| key)
    }

    /// A foot by its name.
    fn foot(&self, key: Key, name: &str) -> Result<(), ProblemError> {
        self.robot.frame(name).map(drop).map_err(|error| {
            let nearest = match error {
                RobotError::UnknownFrame { nearest, .. } => nearest,
                _ => Vec::new(),
            };
            GaitError::UnknownFrame { frame: name.into(), nearest }.at(key)
        })
    }

    /// A joint by its name.
    pub(super) fn joint(&self, key: Key, name: &str) -> Result<usize, ProblemError> {
        let found = self.robot.independent_joints().position(|joint| joint.name == name);
        found.ok_or_else(|| self.unknown_joint(key, format!("'{name}'")))
    }

    /// For each joint the one whose place it takes when the legs change their roles.
    pub(super) fn exchange(&self, gait: &Gait) -> Result<Vec<(usize, f64)>, ProblemError> {
        let mut exchange: Vec<(usize, f64)> = (0..self.robot.dof()).map(|joint| (joint, 1.0)).collect();
        for name in &gait.flipped {
            let joint = self.joint(Key::GAIT_FLIPPED, name)?;
            if exchange[joint].1 < 0.0 {
                return Err(ProblemError::GivenTwice { key: Key::GAIT_FLIPPED, joint: self.name(joint) });
            }
            exchange[joint].1 = -1.0;
        }
        for pair in &gait.mirror {
            let [a, b] = [self.joint(Key::GAIT_MIRROR, &pair[0])?, self.joint(Key::GAIT_MIRROR, &pair[1])?];
            let twice = [a, b].into_iter().find(|&i| exchange[i].0 != i).or((a == b).then_some(a));
            if let Some(joint) = twice {
                return Err(ProblemError::GivenTwice { key: Key::GAIT_MIRROR, joint: self.name(joint) });
            }
            exchange.swap(a, b);
        }
        Ok(exchange)
    }

    /// Whether both feet move in the plane, and with the joint along which the robot moves as a whole.
    pub(super) fn check_feet(&self, gait: &Gait, along: usize) -> Result<(), ProblemError> {
        let mut carries = self.has_no_motor(along) || self.joint_limits()[along].torque == [0.0; 2];
        carries &= self.robot.independent_joints().nth(along).is_some_and(|j| j.kind == JointKind::Prismatic);
        let feet = [(Key::GAIT_STANCE, &gait.stance), (Key::GAIT_SWING, &gait.swing)];
        let feet = feet.into_iter().flat_map(|(key, feet)| feet.iter().map(move |frame| (key, frame)));
        for (key, frame) in feet {
            let robot = self.robot.with_constraint(ConstraintSpec::rigid(frame.as_str(), frame, "world"));
            let mut foot = Constraints::<f64>::new(&robot.map_err(no_foot)?);
            if let Err(error) = foot.set_position(&self.start.q) {
                return Err(GaitError::CannotStand { cause: error.into() }.at(Key::START_Q));
            }
            let [x, y, z] = [0, 1, 2].map(|row| foot.jacobian().row(row));
            let tilts = [3, 5].map(|row| foot.values()[row].abs());
            if gait.is_in_space() {
                carries &= (x[along] - 1.0).abs() < PLANAR && y[along].abs().max(z[along].abs()) < PLANAR;
                continue;
            }
            if gait.sole.is_some() && tilts.iter().any(|tilt| *tilt > PLANAR) {
                return Err(GaitError::Tilted { frame: frame.clone() }.at(key));
            }
            if y.iter().any(|entry| entry.abs() > PLANAR) {
                return Err(GaitError::NotPlanar { frame: frame.clone() }.at(key));
            }
            carries &= (x[along] - 1.0).abs() < PLANAR && z[along].abs() < PLANAR;
        }
        match carries {
            true => Ok(()),
            false => Err(GaitError::NotAlong { joint: gait.along.clone() }.at(Key::GAIT_ALONG)),
        }
    }
}
