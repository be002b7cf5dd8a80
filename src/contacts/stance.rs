//! A robot with some of its contacts on the ground.

use super::contact::Contact;
use super::margin::Margin;
use crate::constraints::Constraints;
use crate::error::EvalError;
use crate::robot::{Robot, RobotError};
use crate::scalar::Scalar;
use std::ops::Range;

/// Angle (rad) up to which a foot stands with the axes of its ground: moments differ by this part.
const ALIGNED: f64 = 1e-6;

/// A robot with some of its contacts on the ground.
///
/// [`robot`](Self::robot) has one constraint for each contact, after those that close its loops; they hold
/// the contacts where they are at the start of a motion. A phase of a gait is a stance; from one to the next
/// lead an [`Impact`](crate::constraints::Impact), or a release.
///
/// ```
/// use costate::constraints::ConstrainedHamiltonian;
/// use costate::contacts::{Contact, Stance};
/// use costate::robot::{Placement, Robot};
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let arm = Robot::from_file("robots/two_link.toml")?;
/// let tip = Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.0; 3]);
/// // The tip leans on a wall whose normal is -x.
/// let lean = Contact::point("tip", "elbow").placed(tip).up([-1.0, 0.0, 0.0]).friction(0.6);
/// let stance = Stance::new(&arm, &[lean])?;
/// let mut hamiltonian = ConstrainedHamiltonian::<f64>::new(stance.robot());
/// let at_rest = hamiltonian.linearise(&[0.3, -0.8], &[0.0; 2], &[5.0, -2.0])?;
/// let (force, _moment) = stance.wrench(0, at_rest.lambda());
/// println!("normal force {} N", force[2]);
/// for margin in stance.margins() {
///     println!("{} is {}", margin.name(), margin.value(at_rest.lambda()));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stance {
    robot: Robot,
    contacts: Vec<Contact>,
    rows: Vec<Range<usize>>,
    margins: Vec<Margin>,
    count: usize,
}

impl Stance {
    /// The robot on these contacts.
    ///
    /// # Errors
    /// [`RobotError::BadConstraint`] for a contact with numbers that cannot be used, and all errors of
    /// [`Robot::with_constraint`].
    pub fn new(robot: &Robot, contacts: &[Contact]) -> Result<Self, RobotError> {
        let mut standing = robot.clone();
        let mut count: usize = robot.constraints().iter().map(|one| one.kind.rows()).sum();
        let (mut rows, mut margins) = (Vec::new(), Vec::new());
        for (index, contact) in contacts.iter().enumerate() {
            contact.check()?;
            standing = standing.with_constraint(contact.constraint())?;
            let own = count..count + contact.rows().len();
            count = own.end;
            margins.extend(Margin::of(index, contact, &own));
            rows.push(own);
        }
        Ok(Self { robot: standing, contacts: contacts.to_vec(), rows, margins, count })
    }

    /// The robot with the constraints of the contacts.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The contacts.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Number of multipliers, k: those of the robot's own constraints first.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Which of them belong to contact `index`, in the order of [`Contact::rows`].
    pub fn rows(&self, index: usize) -> Range<usize> {
        self.rows.get(index).cloned().unwrap_or_default()
    }

    /// Whether all feet stand with the axes of their ground at q (nq entries), up to 1e-6 rad: multipliers of
    /// a foot that is turned against them, in its heading too, are not moments about these axes, and margins
    /// of its sole and torsion are not what they say.
    ///
    /// # Errors
    /// [`RobotError::BadConstraint`] with the name of the first foot that does not; the outer error is that
    /// of [`Constraints::set_position`].
    pub fn check_feet(&self, q: &[f64]) -> Result<Result<(), RobotError>, EvalError> {
        let mut rows = Constraints::<f64>::new(&self.robot);
        rows.set_position(q)?;
        let angles = |index: usize, contact: &Contact| {
            let rows_of = self.rows(index).zip(contact.rows());
            let turns = rows_of.filter(|(_, row)| row.component().1).map(|(at, _)| rows.values()[at]);
            turns.fold(0.0_f64, |most, angle| most.max(angle.abs()))
        };
        let turned =
            self.contacts.iter().enumerate().find(|(index, contact)| angles(*index, contact) > ALIGNED);
        Ok(match turned {
            None => Ok(()),
            Some((_, contact)) => Err(RobotError::BadConstraint {
                constraint: contact.name().to_owned(),
                problem: "is turned against the axes of its ground where it stands, so that its multipliers are \
                          not moments about these: turn the contact (placed) or the ground (on), its heading \
                          included",
            }),
        })
    }

    /// Force (N) and moment (N m) of the ground on contact `index`, at its origin, in the axes of the ground,
    /// from all multipliers lambda; the same for impulses (N s, N m s). Components that the contact does not
    /// hold are zero, and so are all for a contact that does not exist. Moments are those of feet that stand
    /// with the axes of the ground ([`check_feet`](Self::check_feet)); for any other,
    /// [`Constraints::wrench`] at the position of the foot has them.
    pub fn wrench<S: Scalar>(&self, index: usize, lambda: &[S]) -> (/* force */ [S; 3], /* moment */ [S; 3]) {
        let mut both = [[S::zero(); 3]; 2];
        let contact = self.contacts.get(index);
        let held = contact.into_iter().flat_map(|contact| contact.rows()).zip(self.rows(index));
        for (row, at) in held {
            let (axis, turns) = row.component();
            if let Some(&multiplier) = lambda.get(at) {
                both[usize::from(turns)][axis] = multiplier;
            }
        }
        let [force, moment] = both;
        (force, moment)
    }

    /// The centre of pressure of contact `index`, `(-m_y / f_z, m_x / f_z)`, in the axes of the ground, from
    /// the origin of the contact (m); `None` where the normal force is not positive.
    pub fn centre_of_pressure(&self, index: usize, lambda: &[f64]) -> Option<[f64; 2]> {
        let (force, moment) = self.wrench(index, lambda);
        (force[2] > 0.0).then(|| [-moment[1] / force[2], moment[0] / force[2]])
    }

    /// The limits of all contacts as functions of the multipliers.
    pub fn margins(&self) -> &[Margin] {
        &self.margins
    }
}
