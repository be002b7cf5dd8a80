//! Robots with fewer motors than joints, loops, quaternions, gaits.

use crate::draw::Draw;
use crate::text::{Case, RobotFile, list};
use costate::robot::{LoadOptions, Robot};
use std::f64::consts::PI;
use std::path::Path;

fn file(path: &'static str) -> Result<Robot, String> {
    Robot::from_file(Path::new(crate::folder::FOLDER).join("../..").join(path))
        .map_err(|error| error.to_string())
}

/// A cart with a pole, or an acrobot of random masses: swings and swing-ups of 1 to 4 s.
pub fn underactuated(draw: &mut Draw) -> Result<Case, String> {
    if draw.chance(0.5) {
        let hangs = draw.chance(0.5);
        let from = vec![draw.even(-0.5..0.5), if hangs { PI } else { 0.0 }];
        let up = !hangs || draw.chance(0.6);
        let to = vec![draw.even(-1.0..1.0), if up { 0.0 } else { PI }];
        let time = draw.log(1.2..4.0);
        let robot = file("robots/cart_pole.toml")?;
        let mut case = Case::new(robot, RobotFile::Real("robots/cart_pole.toml"), from, to, time);
        case.set("cost", "effort", "[1.0, 0.0]");
        case.set("limits", "torque_max", list(&[draw.log(15.0..100.0), 0.0]));
        case.set("limits", "from_robot", "false");
        case.part("cart pole");
        if draw.chance(0.2) {
            case.unset("time", "final");
            case.set("time", "free", "true");
            case.set("time", "guess", format!("{time:?}"));
            case.set("cost", "time", format!("{:?}", draw.log(1.0..100.0)));
            case.part("free time");
        }
        return Ok(case);
    }
    let mut text =
        String::from("name = \"acrobot\"\ngravity = [0.0, 0.0, -9.81]\nconvention = \"placements\"\n");
    let length = draw.even(0.5..1.2);
    for (name, place) in [("shoulder", 0.0), ("elbow", -length)] {
        let (mass, com) = (draw.log(0.5..2.0), draw.even(0.3..1.0));
        let inertia = mass * draw.even(0.02..0.3);
        text.push_str(&format!(
            "\n[[joint]]\nname = \"{name}\"\naxis = [0.0, 1.0, 0.0]\nplacement = {{ xyz = [0.0, 0.0, {place:?}] }}\n\
             mass = {mass:?}\ncom = [0.0, 0.0, {:?}]\ninertia = {{ xx = {inertia:?}, yy = {inertia:?} }}\n\
             friction = {{ viscous = {:?} }}\n",
            -com,
            if draw.chance(0.5) { 0.1 } else { 0.0 }
        ));
    }
    let robot = Robot::from_toml_str(&text, LoadOptions::default()).map_err(|error| error.to_string())?;
    let to = if draw.chance(0.5) { vec![PI, 0.0] } else { vec![draw.even(-0.8..0.8), draw.even(-1.0..1.0)] };
    let time = draw.log(1.5..4.0);
    let mut case = Case::new(robot, RobotFile::Text(text), vec![0.0, 0.0], to, time);
    case.set("cost", "effort", "[0.0, 1.0]");
    case.set("limits", "torque_max", list(&[0.0, draw.log(15.0..100.0)]));
    case.set("limits", "from_robot", "false");
    case.part("acrobot");
    if draw.chance(0.5) {
        case.set("end", "v_free", "[0, 1]");
        case.part("v_free");
    }
    Ok(case)
}

/// Angles of coupler and rocker of a four-bar with this crank angle: lengths a, b, c, ground d.
fn close([a, b, c, d]: [f64; 4], crank: f64) -> Option<[f64; 3]> {
    let (x, y) = (d - a * crank.cos(), -a * crank.sin());
    let distance = x.hypot(y);
    let cosine = (b * b + distance * distance - c * c) / (2.0 * b * distance);
    if !(-0.999..=0.999).contains(&cosine) {
        return None;
    }
    // The coupler above the line from the tip of the crank to the pivot.
    let coupler = y.atan2(x) + cosine.acos();
    let rocker = (y - b * coupler.sin()).atan2(x - b * coupler.cos());
    let turn = |angle: f64| angle - 2.0 * PI * ((angle + PI) / (2.0 * PI)).floor();
    Some([crank, turn(coupler - crank), turn(rocker - coupler)])
}

/// A crank-rocker of random lengths by Grashof's condition, its crank driven, or the gripper.
pub fn four_bar(draw: &mut Draw) -> Result<Case, String> {
    if draw.chance(0.2) {
        let end = draw.even(0.2..0.75);
        let time = draw.log(0.2..1.5);
        let to = vec![end, -end, end, -end, end];
        let robot = file("robots/gripper.toml")?;
        let mut case = Case::new(robot, RobotFile::Real("robots/gripper.toml"), vec![0.0; 5], to, time);
        let passive = "[\"left_finger\", \"left_inner\", \"right_finger\", \"right_inner\"]";
        case.set("end", "q_free", passive);
        case.set("end", "v_free", passive);
        case.set("cost", "effort", "[1.0, 0.0, 0.0, 0.0, 0.0]");
        case.set("limits", "torque_max", list(&[draw.log(0.3..3.0), 0.0, 0.0, 0.0, 0.0]));
        case.part("gripper");
        return Ok(case);
    }
    loop {
        let lengths = [draw.even(0.3..0.6), draw.even(0.8..1.4), draw.even(0.7..1.2), draw.even(0.9..1.4)];
        let [a, b, c, d] = lengths;
        let most = b.max(c).max(d);
        if a + most > 0.95 * (b + c + d - most) {
            continue;
        }
        let start = draw.even(-PI..PI);
        let end = start + draw.even(-2.5..2.5);
        let (Some(from), Some(mut to)) = (close(lengths, start), close(lengths, end)) else { continue };
        to[0] = end;
        let gravity = if draw.chance(0.7) { -9.81 } else { 0.0 };
        let mut text =
            format!("name = \"four_bar\"\ngravity = [0.0, {gravity:?}, 0.0]\nconvention = \"modified-dh\"\n");
        let friction = draw.chance(0.3).then(|| (draw.log(0.1..5.0), draw.log(1e-3..0.3)));
        for (name, before, length) in [("crank", 0.0, a), ("coupler", a, b), ("rocker", b, c)] {
            let mass = draw.log(0.3..3.0);
            let inertia = mass * length * length / 12.0;
            text.push_str(&format!(
                "\n[[joint]]\nname = \"{name}\"\ndh = {{ a = {before:?} }}\nmass = {mass:?}\ncom = [{:?}, 0.0, 0.0]\n\
                 inertia = {{ yy = {inertia:?}, zz = {inertia:?} }}\n",
                length / 2.0
            ));
            if let Some((coulomb, width)) = friction.filter(|_| name == "crank") {
                text.push_str(&format!(
                    "friction = {{ coulomb = {coulomb:?}, coulomb_velocity = {width:?} }}\n"
                ));
            }
        }
        text.push_str(&format!(
            "\n[[frame]]\nname = \"rocker_tip\"\nparent = \"rocker\"\nplacement = {{ xyz = [{c:?}, 0.0, 0.0] }}\n\
             \n[[frame]]\nname = \"pivot\"\nplacement = {{ xyz = [{d:?}, 0.0, 0.0] }}\n\
             \n[[constraint]]\nname = \"rocker_pivot\"\nframe = \"rocker_tip\"\nto = \"pivot\"\nrows = [\"x\", \"y\"]\n"
        ));
        let robot = Robot::from_toml_str(&text, LoadOptions::default()).map_err(|error| error.to_string())?;
        let time = draw.log(0.5..3.0);
        let mut case = Case::new(robot, RobotFile::Text(text), from.to_vec(), to.to_vec(), time);
        case.set("end", "q_free", "[\"coupler\", \"rocker\"]");
        case.set("end", "v_free", "[\"coupler\", \"rocker\"]");
        case.set("cost", "effort", "[1.0, 0.0, 0.0]");
        case.set("limits", "torque_max", list(&[draw.log(20.0..300.0), 0.0, 0.0]));
        case.part("four-bar");
        if friction.is_some() {
            case.part("dry");
        }
        return Ok(case);
    }
}

/// The satellite with its arm, turned by up to 90 degrees in 5 to 15 s, or a link on a spherical joint.
pub fn quaternion(draw: &mut Draw) -> Result<Case, String> {
    let turn = |draw: &mut Draw| {
        let axis = draw.list(3, -1.0..1.0);
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-3);
        let half = 0.5 * draw.even(0.2..1.5);
        let mut q: Vec<f64> = axis.iter().map(|x| x / length * half.sin()).collect();
        q.push(half.cos());
        q
    };
    if draw.chance(0.5) {
        let path = "examples/problems/robots/satellite.toml";
        let robot = file(path)?;
        let mut from = vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let mut to = vec![0.0; 3];
        to.extend(turn(draw));
        from.extend([draw.even(-1.5..1.5), draw.even(-1.5..1.5)]);
        to.extend([draw.even(-1.5..1.5), draw.even(-1.5..1.5)]);
        let mut case = Case::new(robot, RobotFile::Real(path), from, to, draw.log(5.0..15.0));
        case.set("end", "q_free", "[\"base_x\", \"base_y\", \"base_z\"]");
        case.set("cost", "effort", "[0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0]");
        case.set("limits", "torque_max", "[0.0, 0.0, 0.0, 5.0, 5.0, 5.0, 20.0, 20.0]");
        case.part("satellite");
        return Ok(case);
    }
    let text = format!(
        "name = \"ball\"\ngravity = [0.0, 0.0, -9.81]\nconvention = \"placements\"\n\n[[joint]]\nname = \"ball\"\n\
         type = \"spherical\"\nmass = {:?}\ncom = [0.0, 0.0, -0.3]\ninertia = {{ xx = 0.05, yy = 0.06, zz = 0.02 }}\n\
         \n[[joint]]\nname = \"elbow\"\nparent = \"ball\"\naxis = [0.0, 1.0, 0.0]\nplacement = {{ xyz = [0.0, 0.0, -0.6] }}\n\
         mass = {:?}\ncom = [0.0, 0.0, -0.2]\ninertia = {{ xx = 0.02, yy = 0.02, zz = 0.01 }}\n",
        draw.log(0.5..3.0),
        draw.log(0.5..2.0)
    );
    let robot = Robot::from_toml_str(&text, LoadOptions::default()).map_err(|error| error.to_string())?;
    let (mut from, mut to) = (vec![0.0, 0.0, 0.0, 1.0], turn(draw));
    from.push(draw.even(-1.0..1.0));
    to.push(draw.even(-1.0..1.0));
    let mut case = Case::new(robot, RobotFile::Text(text), from, to, draw.log(0.7..3.0));
    case.set("cost", "effort", "[1.0, 1.0, 1.0, 1.0]");
    case.set("limits", "torque_max", "[60.0, 60.0, 60.0, 40.0]");
    case.part("spherical");
    Ok(case)
}

/// RABBIT, steps of 0.3 to 0.55 m in 0.5 to 0.9 s.
pub fn gait(draw: &mut Draw) -> Result<Case, String> {
    let path = "robots/rabbit.toml";
    let robot = file(path)?;
    let guess = vec![-0.25, 0.72, 0.1, 0.1, 0.3, -0.6, 0.3];
    let mut case = Case::new(robot, RobotFile::Real(path), guess.clone(), guess, draw.even(0.5..0.9));
    case.unset("end", "q");
    case.set("cost", "effort", "[0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]");
    case.set("limits", "q_min", "[-inf, -inf, -inf, -inf, 0.0, -inf, 0.0]");
    case.set("limits", "torque_max", "[0.0, 0.0, 0.0, 150.0, 150.0, 150.0, 150.0]");
    case.set("gait", "stance", "\"right_foot\"");
    case.set("gait", "swing", "\"left_foot\"");
    case.set("gait", "along", "\"base_x\"");
    case.set("gait", "length", format!("{:?}", draw.even(0.3..0.55)));
    case.set("gait", "friction", "0.6");
    case.set("gait", "clearance", "0.02");
    case.set("gait", "mirror", "[[\"left_hip\", \"right_hip\"], [\"left_knee\", \"right_knee\"]]");
    Ok(case)
}
