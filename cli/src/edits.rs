//! Flags that change the robot after it is read.

use clap::Args;
use costate::robot::{LinkInertia, RobotEdit};

/// Changes of the robot, in this order.
#[derive(Args)]
pub struct EditArguments {
    /// Gravity in the world frame (m/s^2)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = gravity)]
    gravity: Option<[f64; 3]>,
    /// Set the armature of a joint (kg m^2, kg); may be given several times
    #[arg(long, value_name = "JOINT=VALUE", value_parser = named)]
    armature: Vec<(String, f64)>,
    /// Attach a rigid body to a frame: mass (kg), centre of mass (m) and inertia about it (kg m^2) in the
    /// frame: 1, 4, 7 or 10 numbers; may be given several times
    #[arg(long, value_name = "FRAME=MASS[,X,Y,Z[,XX,YY,ZZ[,XY,XZ,YZ]]]", value_parser = payload)]
    payload: Vec<(String, LinkInertia)>,
    /// Hold a joint at a position (rad, m), with all that mimics it; may be given several times
    #[arg(long, value_name = "JOINT=POSITION", value_parser = named)]
    lock: Vec<(String, f64)>,
    /// Keep these joints, and those that mimic them; the others are held at 0, or where --lock holds them
    #[arg(long, value_name = "JOINT,...", value_delimiter = ',')]
    reduced_to: Vec<String>,
}

impl EditArguments {
    /// The changes.
    pub fn edits(&self) -> Vec<RobotEdit> {
        let mut edits: Vec<RobotEdit> = self.gravity.map(RobotEdit::Gravity).into_iter().collect();
        edits.extend(self.armature.iter().map(|(joint, value)| RobotEdit::Armature(joint.clone(), *value)));
        edits.extend(self.payload.iter().map(|(frame, load)| RobotEdit::Payload(frame.clone(), *load)));
        edits.extend((!self.lock.is_empty()).then(|| RobotEdit::Lock(self.lock.clone())));
        edits.extend((!self.reduced_to.is_empty()).then(|| RobotEdit::ReducedTo(self.reduced_to.clone())));
        edits
    }
}

/// A name and what follows its last `=`.
fn split(text: &str) -> Result<(&str, &str), String> {
    let parts = text.rsplit_once('=').filter(|(name, _)| !name.is_empty());
    parts.ok_or_else(|| "must be a name, =, and a value".into())
}

fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("'{}' is not a number", costate::robot::printable(text)))
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split(',').map(number).collect()
}

fn named(text: &str) -> Result<(String, f64), String> {
    let (name, value) = split(text)?;
    Ok((name.into(), number(value)?))
}

fn gravity(text: &str) -> Result<[f64; 3], String> {
    let found = numbers(text)?;
    <[f64; 3]>::try_from(found).map_err(|found| format!("must be 3 numbers, not {}", found.len()))
}

fn payload(text: &str) -> Result<(String, LinkInertia), String> {
    let (frame, values) = split(text)?;
    let mut values = numbers(values)?;
    let count = values.len();
    if ![1, 4, 7, 10].contains(&count) {
        return Err(format!("must have 1, 4, 7 or 10 numbers, not {count}"));
    }
    values.resize(10, 0.0);
    let [mass, x, y, z, ref entries @ ..] = values[..] else { return Err("must have 10 numbers".into()) };
    let entries = <[f64; 6]>::try_from(entries).unwrap_or_default();
    Ok((frame.into(), LinkInertia::from_entries(mass, [x, y, z], entries)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_follow_the_last_equals_sign() {
        assert_eq!(named("a=b=-0.5"), Ok(("a=b".into(), -0.5)));
        for text in ["a", "=1", "a=", "a=1,2", "a=x"] {
            assert!(named(text).is_err(), "{text}");
        }
        assert_eq!(gravity("0, 0,-1.62"), Ok([0.0, 0.0, -1.62]));
        assert!(gravity("0,0").is_err_and(|reason| reason.contains("not 2")));
    }

    #[test]
    fn payloads_have_mass_centre_and_inertia() {
        let (frame, load) = payload("tool0=2,0.1,0,0.3,1,2,3,0.4,0.5,0.6").unwrap();
        let expected = LinkInertia::from_entries(2.0, [0.1, 0.0, 0.3], [1.0, 2.0, 3.0, 0.4, 0.5, 0.6]);
        assert_eq!((frame.as_str(), load), ("tool0", expected));
        assert_eq!(payload("tool0=2").unwrap().1, LinkInertia::point(2.0, [0.0; 3]));
        assert!(payload("tool0=1,2").is_err_and(|reason| reason.contains("not 2")));
    }
}
