//! Vias, payloads, tools and obstacles.

use crate::cost::point;
use crate::draw::Draw;
use crate::robots::{self, TREE, Tree};
use crate::text::{Case, RobotFile, list};
use costate::kinematics::Kinematics;
use costate::robot::{LoadOptions, Robot};

/// One or two vias: passed or stopped at, at given or free times, some joints free, with payloads of 0.2 to
/// 3 kg.
pub fn via(draw: &mut Draw) -> Result<Case, String> {
    let mut case = match draw.chance(0.5) {
        true => robots::tree(draw, Tree { joints: (2, 5), dry: 0.25, ..TREE })?,
        false => robots::real(draw, 0.2, false)?,
    };
    let joints = case.joints();
    let count = 1 + usize::from(draw.chance(0.4));
    for k in 0..count {
        let part = (k + 1) as f64 / (count + 1) as f64;
        let q: Vec<f64> = case.position(part).iter().map(|q| q + draw.even(-0.3..0.3)).collect();
        case.tail.push_str(&format!("\n[[via]]\nq = {}\n", list(&q)));
        if draw.chance(0.3) && joints.len() > 1 {
            case.tail.push_str(&format!("q_free = [\"{}\"]\n", draw.one(&joints)));
            case.part("q_free");
        }
        if draw.chance(0.4) {
            case.tail.push_str("stop = true\n");
            case.part("stop");
        }
        if draw.chance(0.4) {
            let time = case.time * (part + draw.even(-0.1..0.1));
            case.tail.push_str(&format!("time = {time:?}\n"));
            case.part("time");
        }
        if draw.chance(0.4) {
            let last = &joints[joints.len() - 1];
            case.tail.push_str(&format!(
                "[[via.payload]]\nframe = \"{last}\"\nmass = {:?}\ncom = [0.0, 0.0, 0.05]\n",
                draw.log(0.2..3.0)
            ));
            case.part("payload");
        }
    }
    Ok(case)
}

/// Where the last joint is, and a direction of its frame (its third axis) in the world.
fn pose(robot: &Robot, q: &[f64], frame: &str, offset: [f64; 3]) -> Result<([f64; 3], [f64; 3]), String> {
    let mut kinematics = Kinematics::<f64>::new(robot);
    kinematics.set_position(q).map_err(|error| error.to_string())?;
    let index = robot.frame_index(frame).map_err(|error| error.to_string())?;
    let rotation = kinematics.pose(index).map_err(|error| error.to_string())?.rotation;
    let place = point(&kinematics, index, offset).ok_or("no pose")?;
    Ok((place, std::array::from_fn(|k| rotation[k][2])))
}

/// An arm whose tool reaches a place that a random position has, with an axis at times; at times it keeps
/// the axis within 0.1 to 0.5 rad, or a limit of rates.
pub fn tool(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::real(draw, 0.1, true)?;
    let joints = case.joints();
    let frame = joints[joints.len() - 1].clone();
    let offset = [0.0, 0.0, 0.1];
    let (place, axis) = pose(&case.robot, &case.to, &frame, offset)?;
    let (_, before) = pose(&case.robot, &case.from, &frame, offset)?;
    case.unset("end", "q");
    let keeps = draw.chance(0.25);
    let mut table =
        format!("\n[end.tool]\nframe = \"{frame}\"\noffset = {}\nxyz = {}\n", list(&offset), list(&place));
    if keeps {
        table.push_str(&format!("along = {}\n", list(&before)));
        table.push_str(&format!(
            "\n[[keep]]\nkind = \"axis\"\nframe = \"{frame}\"\nalong = {}\nangle = {:?}\n",
            list(&before),
            draw.even(0.1..0.5)
        ));
        case.part("keep axis");
    } else if draw.chance(0.6) {
        table.push_str(&format!("along = {}\n", list(&axis)));
        case.part("axis");
    }
    case.tail.push_str(&table);
    let peaks = case.peaks()?;
    if draw.chance(0.5) {
        let limits: Vec<f64> = peaks.torque.iter().map(|tau| draw.even(1.2..2.5) * tau.max(5.0)).collect();
        case.set("limits", "torque_max", list(&limits));
        case.part("torque_max");
    }
    if draw.chance(0.3) {
        let limits: Vec<f64> = peaks.v.iter().map(|v| draw.even(0.8..2.0) * v.max(0.5)).collect();
        case.set("limits", "v_max", list(&limits));
        case.part("v_max");
    }
    Ok(case)
}

/// An arm with a ball or a post near the middle of the way of its last joint, radius 0.02 to 0.12 m.
pub fn obstacle(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::real(draw, 0.1, true)?;
    let joints = case.joints();
    let frame = joints[joints.len() - 1].clone();
    let offset = [0.0, 0.0, 0.1];
    let (from, _) = pose(&case.robot, &case.from, &frame, offset)?;
    let (to, _) = pose(&case.robot, &case.to, &frame, offset)?;
    let (middle, _) = pose(&case.robot, &case.position(0.5), &frame, offset)?;
    let radius = draw.log(0.02..0.12);
    let centre: [f64; 3] = std::array::from_fn(|k| middle[k] + draw.even(-0.06..0.06));
    let near = |x: [f64; 3]| (0..3).map(|k| (x[k] - centre[k]).powi(2)).sum::<f64>().sqrt();
    // Not around an end: a body there may not touch it.
    let body = draw.log(0.02..0.06);
    let free = near(from).min(near(to)) - body - 0.01;
    let radius = radius.min(free);
    if radius > 0.005 {
        case.tail.push_str(&match draw.chance(0.5) {
            true => {
                format!("\n[[obstacle]]\nkind = \"sphere\"\nxyz = {}\nradius = {radius:?}\n", list(&centre))
            }
            false => {
                // A short post along z stays within a ball of the free distance.
                let half = 0.5 * (free - radius).max(0.0);
                let end = |sign: f64| list(&[centre[0], centre[1], centre[2] + sign * half]);
                format!(
                    "\n[[obstacle]]\nkind = \"capsule\"\nfrom = {}\nto = {}\nradius = {radius:?}\n",
                    end(-1.0),
                    end(1.0)
                )
            }
        });
        case.tail.push_str(&format!(
            "\n[collision]\n[[collision.capsule]]\nframe = \"{frame}\"\nfrom = {}\nradius = {body:?}\n",
            list(&offset)
        ));
    }
    Ok(case)
}

/// A point on two axes goes round walls (thickness 0.002 to 0.2 m, radius of the point 0 to 0.1 m), at times
/// with dry friction or limits.
pub fn wall(draw: &mut Draw) -> Result<Case, String> {
    let mut text = String::from("name = \"point\"\ngravity = [0.0, 0.0, 0.0]\nconvention = \"placements\"\n");
    for (name, axis) in [("x", "[1.0, 0.0, 0.0]"), ("y", "[0.0, 1.0, 0.0]")] {
        let dry = match draw.chance(0.25) {
            true => format!(
                "friction = {{ coulomb = {:?}, coulomb_velocity = {:?} }}\n",
                draw.log(0.1..10.0),
                draw.log(1e-3..0.3)
            ),
            false => String::new(),
        };
        let mass = if name == "x" { 0.0 } else { draw.log(0.3..3.0) };
        text.push_str(&format!(
            "\n[[joint]]\nname = \"{name}\"\ntype = \"prismatic\"\naxis = {axis}\nmass = {mass:?}\n{dry}"
        ));
    }
    let robot = Robot::from_toml_str(&text, LoadOptions::default()).map_err(|error| error.to_string())?;
    let from = vec![-1.0, draw.even(-0.3..0.3)];
    let to = vec![1.0, draw.even(-0.3..0.3)];
    let mut case = Case::new(robot, RobotFile::Text(text), from, to, draw.log(0.5..3.0));
    case.set("cost", "effort", "[1.0, 1.0]");
    for _ in 0..1 + usize::from(draw.chance(0.3)) {
        let x = draw.even(-0.6..0.6);
        let slant = draw.even(-0.1..0.1);
        let top = draw.even(0.05..0.6);
        let (low, high) = if draw.chance(0.5) { (-0.8, top) } else { (-top, 0.8) };
        case.tail.push_str(&format!(
            "\n[[obstacle]]\nkind = \"capsule\"\nfrom = [{:?}, {low:?}, 0.0]\nto = [{:?}, {high:?}, 0.0]\nradius = {:?}\n",
            x - slant,
            x + slant,
            draw.log(0.001..0.1)
        ));
    }
    let body = if draw.chance(0.2) { 0.0 } else { draw.log(0.005..0.1) };
    case.tail.push_str(&format!(
        "\n[collision]\n[[collision.capsule]]\nframe = \"y\"\nradius = {body:?}\nname = \"p\"\n"
    ));
    if draw.chance(0.2) {
        robots::limit_rates(&mut case, draw)?;
    }
    Ok(case)
}

/// An arm whose last joint follows places near those of the quintic, 3 to 30 knots, weights 10 to 1e6; at
/// times one of them is an event of 0.02 to 0.2 s.
pub fn followed(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::real(draw, 0.1, true)?;
    let joints = case.joints();
    let frame = joints[joints.len() - 1].clone();
    let offset = [0.0, 0.0, 0.1];
    let event = draw.chance(0.4);
    let times: Vec<f64> = if event {
        let half = 0.5 * draw.log(0.02..0.2);
        let middle = draw.even(half..case.time - half);
        vec![middle - half, middle, middle + half]
    } else {
        let count = draw.whole(3..31);
        (0..count).map(|k| case.time * (k as f64 + draw.even(0.1..0.9)) / count as f64).collect()
    };
    let size = draw.log(0.005..0.1);
    let mut rows = Vec::new();
    for (k, t) in times.iter().enumerate() {
        let (place, _) = pose(&case.robot, &case.position(t / case.time), &frame, offset)?;
        let moved = !event || k == 1;
        rows.push(place.map(|x| if moved { x + draw.even(-size..size) } else { x }).to_vec());
    }
    case.tail.push_str(&format!(
        "\n[[cost.reference]]\nframe = \"{frame}\"\noffset = {}\ntimes = {}\npositions = {}\n\
         position_weight = {:?}\n",
        list(&offset),
        list(&times),
        crate::text::lists(&rows),
        draw.log(10.0..1e6)
    ));
    if event || draw.chance(0.3) {
        case.tail
            .push_str(&format!("velocities = {}\n", crate::text::lists(&vec![vec![0.0; 3]; rows.len()])));
    }
    case.part(if event { "tool event".into() } else { format!("tool, {} knots", times.len()) });
    Ok(case)
}
