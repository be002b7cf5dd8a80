//! Flags that change the robot after it is read.

use clap::Args;
use costate::robot::{
    FrameSpec, Friction, LimitChange, LinkInertia, Placement, RobotEdit, Wrench, WrenchAxes,
};

/// Changes of the robot, in this order.
#[derive(Args)]
pub struct EditArguments {
    /// Gravity in the world frame (m/s^2)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = gravity)]
    gravity: Option<[f64; 3]>,
    /// Set the armature of a joint (kg m^2, kg); may be given several times
    #[arg(long, value_name = "JOINT=VALUE", value_parser = named)]
    armature: Vec<(String, f64)>,
    /// Set the friction of a joint: viscous (N m s/rad, N s/m), Coulomb (N m, N) and the velocity at which
    /// the latter is developed (rad/s, m/s); may be given several times
    #[arg(long, value_name = "JOINT=VISCOUS[,COULOMB[,VELOCITY]]", value_parser = friction)]
    joint_friction: Vec<(String, Friction)>,
    /// Set limits of a joint: positions (rad, m), velocity and effort; an empty entry, as in elbow=,,2, keeps
    /// the limit that the joint has; may be given several times
    #[arg(long, value_name = "JOINT=LOWER,UPPER[,VELOCITY[,EFFORT]]", value_parser = limits)]
    joint_limits: Vec<(String, LimitChange)>,
    /// Add a frame, fixed to a link, a joint or a frame added before, at a position (m) and roll, pitch, yaw
    /// (rad) in it: 3 or 6 numbers; may be given several times
    #[arg(long, value_name = "NAME=FRAME:X,Y,Z[,R,P,Y]", value_parser = frame)]
    frame: Vec<FrameSpec>,
    /// Attach a rigid body to a frame: mass (kg), centre of mass (m) and inertia about it (kg m^2) in the
    /// frame: 1, 4, 7 or 10 numbers; may be given several times
    #[arg(long, value_name = "FRAME=MASS[,X,Y,Z[,XX,YY,ZZ[,XY,XZ,YZ]]]", value_parser = payload)]
    payload: Vec<(String, LinkInertia)>,
    /// Apply a force (N) at the origin of a frame, and a moment (N m), from outside: 3 or 6 numbers; they
    /// turn with the frame (local, the default) or keep their direction in the world (aligned); may be given
    /// several times
    #[arg(long, value_name = "FRAME=FX,FY,FZ[,MX,MY,MZ][,AXES]", value_parser = wrench)]
    wrench: Vec<(String, Wrench)>,
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
        edits.extend(self.joint_friction.iter().map(|(joint, law)| RobotEdit::Friction(joint.clone(), *law)));
        edits.extend(self.joint_limits.iter().map(|(joint, new)| RobotEdit::Limits(joint.clone(), *new)));
        edits.extend(self.frame.iter().cloned().map(RobotEdit::Frame));
        edits.extend(self.payload.iter().map(|(frame, load)| RobotEdit::Payload(frame.clone(), *load)));
        edits.extend(self.wrench.iter().map(|(frame, wrench)| RobotEdit::Wrench(frame.clone(), *wrench)));
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

fn friction(text: &str) -> Result<(String, Friction), String> {
    let (joint, values) = split(text)?;
    let mut values = numbers(values)?;
    let count = values.len();
    values.extend([0.0, Friction::DEFAULT_COULOMB_VELOCITY].into_iter().skip(count.saturating_sub(1)));
    match values[..] {
        [viscous, coulomb, coulomb_velocity] if count <= 3 => {
            Ok((joint.into(), Friction { viscous, coulomb, coulomb_velocity }))
        }
        _ => Err(format!("must have 1, 2 or 3 numbers, not {count}")),
    }
}

fn limits(text: &str) -> Result<(String, LimitChange), String> {
    let (joint, values) = split(text)?;
    let entry = |text: &str| if text.trim().is_empty() { Ok(None) } else { number(text).map(Some) };
    let mut values = values.split(',').map(entry).collect::<Result<Vec<_>, _>>()?;
    let count = values.len();
    values.resize(4, None);
    if values.iter().all(Option::is_none) {
        return Err("changes no limit; give at least one of its entries a number".into());
    }
    match values[..] {
        [lower, upper, velocity, effort] if (2..=4).contains(&count) => {
            Ok((joint.into(), LimitChange { lower, upper, velocity, effort }))
        }
        _ => Err(format!("must have 2, 3 or 4 entries, not {count}")),
    }
}

fn frame(text: &str) -> Result<FrameSpec, String> {
    let parts = text.split_once('=').filter(|(name, _)| !name.is_empty());
    let parts = parts.and_then(|(name, place)| Some((name, place.rsplit_once(':')?)));
    let (name, (base, values)) = parts.ok_or("must be a name, =, a frame, :, and 3 or 6 numbers")?;
    let mut values = numbers(values)?;
    let count = values.len();
    values.resize(6, 0.0);
    match (count, &values[..]) {
        (3 | 6, &[x, y, z, roll, pitch, yaw]) => {
            let placement = Placement::from_xyz_rpy([x, y, z], [roll, pitch, yaw]);
            Ok(FrameSpec::new(name).on(base).placed(placement))
        }
        _ => Err(format!("must have 3 or 6 numbers, not {count}")),
    }
}

/// The axes of wrenches by their names.
const AXES: [(&str, WrenchAxes); 2] = [("local", WrenchAxes::Local), ("aligned", WrenchAxes::Aligned)];

fn wrench(text: &str) -> Result<(String, Wrench), String> {
    let (frame, values) = split(text)?;
    let word = values.rsplit_once(',').and_then(|(values, word)| {
        let (_, axes) = AXES.into_iter().find(|(name, _)| *name == word.trim())?;
        Some((values, axes))
    });
    let (values, axes) = word.unwrap_or((values, WrenchAxes::default()));
    let mut values = numbers(values).map_err(|reason| format!("{reason}; the axes are local or aligned"))?;
    let count = values.len();
    values.resize(6, 0.0);
    match (count, &values[..]) {
        (3 | 6, &[fx, fy, fz, mx, my, mz]) => {
            Ok((frame.into(), Wrench { force: [fx, fy, fz], moment: [mx, my, mz], axes }))
        }
        _ => Err(format!("must have 3 or 6 numbers, not {count}")),
    }
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

    #[test]
    fn friction_has_up_to_three_numbers() {
        let (viscous, coulomb, coulomb_velocity) = (0.3, 0.2, 0.05);
        let law = Friction { viscous, ..Friction::none() };
        assert_eq!(friction("elbow=0.3"), Ok(("elbow".into(), law)));
        assert_eq!(friction("elbow=0.3,0.2"), Ok(("elbow".into(), Friction { coulomb, ..law })));
        let all = Friction { viscous, coulomb, coulomb_velocity };
        assert_eq!(friction("elbow=0.3,0.2,0.05"), Ok(("elbow".into(), all)));
        assert!(friction("elbow=1,2,3,4").is_err_and(|reason| reason.contains("not 4")));
        assert!(friction("elbow=").is_err());
    }

    #[test]
    fn limits_that_are_not_given_stay() {
        let range = LimitChange { lower: Some(-1.0), upper: Some(2.5), ..LimitChange::default() };
        assert_eq!(limits("elbow=-1,2.5"), Ok(("elbow".into(), range)));
        let change = LimitChange { velocity: Some(2.0), effort: Some(9.0), ..LimitChange::default() };
        assert_eq!(limits("elbow=,,2,9"), Ok(("elbow".into(), change)));
        assert_eq!(limits("elbow=,,2").unwrap().1, LimitChange { effort: None, ..change });
        for (text, reason) in [("elbow=1", "not 1"), ("elbow=1,2,3,4,5", "not 5"), ("elbow=a,2", "'a'")] {
            assert!(limits(text).is_err_and(|found| found.contains(reason)), "{text}");
        }
    }

    #[test]
    fn frames_have_a_base_and_a_placement() {
        let place = Placement::from_xyz_rpy([0.1, 0.0, -0.2], [0.3, 0.0, 1.0]);
        let expected = FrameSpec::new("tip").on("joint:a=b:c").placed(place);
        assert_eq!(frame("tip=joint:a=b:c:0.1,0,-0.2,0.3,0,1"), Ok(expected));
        let place = Placement::from_xyz_rpy([0.0, 0.0, 1.0], [0.0; 3]);
        assert_eq!(frame("tip=tool0:0,0,1"), Ok(FrameSpec::new("tip").on("tool0").placed(place)));
        for text in
            ["tip", "tip=tool0", "=tool0:0,0,1", "tip=tool0:0,0", "tip=tool0:0,0,1,2", "tip=tool0:a,0,0"]
        {
            assert!(frame(text).is_err(), "{text}");
        }
    }

    #[test]
    fn wrenches_have_a_force_a_moment_and_axes() {
        let force = [1.0, -2.0, 0.5];
        let expected = Wrench { force, ..Wrench::default() };
        assert_eq!(wrench("tool0=1,-2,0.5"), Ok(("tool0".into(), expected)));
        assert_eq!(wrench("tool0=1,-2,0.5,local"), Ok(("tool0".into(), expected)));
        let expected = Wrench { force, moment: [3.0, 4.0, 5.0], axes: WrenchAxes::Aligned };
        assert_eq!(wrench("tool0=1,-2,0.5,3,4,5,aligned"), Ok(("tool0".into(), expected)));
        for (text, reason) in
            [("tool0=1,2", "not 2"), ("tool0=1,2,3,world", "'world' is not a number"), ("tool0", "=")]
        {
            assert!(wrench(text).is_err_and(|found| found.contains(reason)), "{text}");
        }
    }
}
