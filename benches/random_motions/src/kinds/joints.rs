//! Motions that are posed by joints alone.

use crate::draw::Draw;
use crate::robots::{self, TREE, Tree, scaled};
use crate::text::{Case, RobotFile, list, lists, names};
use costate::robot::{LoadOptions, Robot};

/// Effort and a fixed time; sometimes an extra of another kind.
pub fn tree(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::tree(draw, TREE)?;
    extras(&mut case, draw)?;
    Ok(case)
}

pub fn mimic(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::tree(draw, Tree { joints: (3, 7), mimic: 0.5, dry: 0.1, ..TREE })?;
    extras(&mut case, draw)?;
    Ok(case)
}

/// Springs of 1 to 1e4 N m/rad.
pub fn spring(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::tree(draw, Tree { joints: (1, 5), spring: 0.8, ..TREE })?;
    extras(&mut case, draw)?;
    Ok(case)
}

/// Dry friction in most joints.
pub fn friction(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::any(draw, 0.8)?;
    case.part("dry");
    extras(&mut case, draw)?;
    Ok(case)
}

/// With a third of the motions each: limits of torques and rates, a short reference, neither.
fn extras(case: &mut Case, draw: &mut Draw) -> Result<(), String> {
    if draw.chance(0.3) {
        let peaks = case.peaks()?;
        scaled(case, draw, "torque_max", &peaks.torque, 0.8..1.8, 1.0);
        case.part("torque_max");
    }
    if draw.chance(0.2) {
        let peaks = case.peaks()?;
        scaled(case, draw, "v_max", &peaks.v, 0.65..1.5, 0.1);
        case.part("v_max");
    }
    if draw.chance(0.15) {
        event_of(case, draw, 1e0..1e4);
        case.part("event");
    }
    Ok(())
}

/// One joint with dry friction and a long way or a long time: it waits where that is cheaper. Inertia 0.01
/// to 2, coulomb 0.1 to 10, transition 1e-3 to 0.3 rad/s, way 0.5 to 100 rad, time 1 to 20 s.
pub fn spindle(draw: &mut Draw) -> Result<Case, String> {
    let joints = if draw.chance(0.7) { 1 } else { 2 };
    let mut text =
        String::from("name = \"spindle\"\ngravity = [0.0, 0.0, 0.0]\nconvention = \"placements\"\n");
    let mut first = None;
    for i in 0..joints {
        let inertia = draw.log(0.01..2.0);
        let viscous = if draw.chance(0.3) { draw.log(1e-3..0.1) } else { 0.0 };
        let (coulomb, width) = (draw.log(0.1..10.0), draw.log(1e-3..0.3));
        first.get_or_insert((inertia, viscous, coulomb));
        text.push_str(&format!(
            "\n[[joint]]\nname = \"s{i}\"\naxis = [0.0, 0.0, 1.0]\nplacement = {{ xyz = [0.3, 0.0, 0.0] }}\n\
             mass = 1.0\ninertia = {{ xx = {inertia:?}, yy = {inertia:?}, zz = {inertia:?} }}\n\
             friction = {{ viscous = {viscous:?}, coulomb = {coulomb:?}, coulomb_velocity = {width:?} }}\n",
        ));
    }
    let robot = Robot::from_toml_str(&text, LoadOptions::default()).map_err(|error| error.to_string())?;
    let from = vec![0.0; joints];
    let to = (0..joints).map(|_| draw.log(0.5..100.0)).collect();
    let time = draw.log(1.0..20.0);
    let mut case = Case::new(robot, RobotFile::Text(text), from, to, time);
    case.set("cost", "effort", list(&vec![1.0; joints]));
    let mut price = None;
    if draw.chance(0.2) {
        let of_second = draw.log(0.1..100.0);
        free(&mut case, time);
        case.set("cost", "time", format!("{of_second:?}"));
        case.part("free time");
        price = Some(of_second);
    }
    if let Some((inertia, 0.0, coulomb)) = first.filter(|_| joints == 1) {
        case.known = Some(sharp(inertia, coulomb, case.to[0], time, price));
        case.part("known");
    }
    Ok(case)
}

/// The least effort with sharp dry friction C of one inertia I over a way D: it moves for the time t at the
/// cost `6 I^2 D^2/t^3 + C^2 t/2` and waits for the rest, t = sqrt(6 I D/C) at most. With a price c of a
/// second it does not wait, and `t^4 = 18 I^2 D^2/(c + C^2/2)`. A transition costs no more, since |F| <= C.
fn sharp(inertia: f64, coulomb: f64, way: f64, time: f64, price: Option<f64>) -> f64 {
    let rate = price.unwrap_or(0.0) + 0.5 * coulomb * coulomb;
    let best = (18.0 * (inertia * way).powi(2) / rate).powf(0.25);
    let moving = if price.is_some() { best } else { best.min(time) };
    6.0 * (inertia * way).powi(2) / moving.powi(3) + rate * moving
}

/// References of 2 to 60 knots, with and without velocities, of weights 1 to 1e5 per joint; or of the place
/// of an arm's last joint.
pub fn reference(draw: &mut Draw) -> Result<Case, String> {
    if draw.chance(0.25) {
        return super::tools::followed(draw);
    }
    let mut case = robots::any(draw, 0.2)?;
    let (n, time) = (case.dof(), case.time);
    let count = if draw.chance(0.5) { draw.whole(2..6) } else { draw.whole(20..61) };
    let mut times: Vec<f64> = (0..count).map(|_| draw.even(0.0..time)).collect();
    times.sort_by(f64::total_cmp);
    times.dedup_by(|b, a| *b - *a < 1e-3 * time / count as f64);
    let size = draw.log(0.02..0.5);
    let positions: Vec<Vec<f64>> = times
        .iter()
        .map(|t| case.position(t / time).iter().map(|q| q + draw.even(-size..size)).collect())
        .collect();
    let weights: Vec<f64> = (0..n).map(|_| if draw.chance(0.7) { draw.log(1.0..1e5) } else { 0.0 }).collect();
    let mut table = format!(
        "\n[[cost.reference]]\ntimes = {}\npositions = {}\nweights = {}\n",
        list(&times),
        lists(&positions),
        list(&weights)
    );
    if draw.chance(0.5) {
        let rest = vec![vec![0.0; n]; times.len()];
        table.push_str(&format!("velocities = {}\n", lists(&rest)));
    }
    case.tail.push_str(&table);
    case.part(format!("{} knots", times.len()));
    Ok(case)
}

/// A rest with one or two short events of a reference: 0.02 to 0.5 s in 2 to 60 s, weights 1 to 1e7.
pub fn event(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::tree(draw, Tree { joints: (1, 3), ..TREE })?;
    case.to = case.from.clone();
    case.time = draw.log(2.0..60.0);
    let (to, time) = (list(&case.to), case.time);
    case.set("end", "q", to);
    case.set("time", "final", format!("{time:?}"));
    case.set("cost", "effort", list(&vec![1.0; case.dof()]));
    event_of(&mut case, draw, 1.0..1e7);
    if draw.chance(0.3) {
        event_of(&mut case, draw, 1.0..1e7);
    }
    Ok(case)
}

/// A reference that leaves the quintic for a moment.
fn event_of(case: &mut Case, draw: &mut Draw, weights: std::ops::Range<f64>) {
    let (n, time) = (case.dof(), case.time);
    let half = 0.5 * draw.log(0.02..0.5_f64.min(0.4 * time));
    let middle = draw.even(half..time - half);
    let times = [middle - half, middle, middle + half];
    let mut positions: Vec<Vec<f64>> = times.iter().map(|t| case.position(t / time)).collect();
    let joint = draw.whole(0..n);
    positions[1][joint] += draw.log(0.01..1.0) * if draw.chance(0.5) { 1.0 } else { -1.0 };
    let mut own = vec![0.0; n];
    own[joint] = draw.log(weights);
    case.tail.push_str(&format!(
        "\n[[cost.reference]]\ntimes = {}\npositions = {}\nvelocities = {}\nweights = {}\n",
        list(&times),
        lists(&positions),
        lists(&vec![vec![0.0; n]; 3]),
        list(&own)
    ));
}

/// Positions, rates, accelerations and torques: 0.7 to 1.6 of the peaks of the quintic.
pub fn limits(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::any(draw, 0.25)?;
    let peaks = case.peaks()?;
    let mut any = false;
    while !any {
        if draw.chance(0.5) {
            scaled(&mut case, draw, "v_max", &peaks.v, 0.65..1.5, 0.05);
            case.part("v_max");
            any = true;
        }
        if draw.chance(0.4) {
            scaled(&mut case, draw, "a_max", &peaks.a, 0.8..1.6, 0.2);
            case.part("a_max");
            any = true;
        }
        if draw.chance(0.5) {
            scaled(&mut case, draw, "torque_max", &peaks.torque, 0.8..1.6, 1.0);
            case.part("torque_max");
            any = true;
        }
        if draw.chance(0.3) {
            let margin = draw.log(1e-3..0.3);
            let ends = || case.from.iter().zip(&case.to);
            let lower: Vec<f64> = ends().map(|(a, b)| a.min(*b) - margin).collect();
            let upper: Vec<f64> = ends().map(|(a, b)| a.max(*b) + margin).collect();
            case.set("limits", "q_min", list(&lower));
            case.set("limits", "q_max", list(&upper));
            if !case.has("limits", "from_robot") {
                case.set("limits", "from_robot", "false");
            }
            case.part("q");
            any = true;
        }
    }
    Ok(case)
}

/// Jerks and rates of torques, limited or at a cost; sometimes least time.
pub fn rates(draw: &mut Draw) -> Result<Case, String> {
    let mut case = match draw.chance(0.6) {
        true => robots::tree(draw, Tree { joints: (1, 5), ..TREE })?,
        false => robots::real(draw, 0.0, false)?,
    };
    let (n, peaks) = (case.dof(), case.peaks()?);
    let rest = list(&vec![0.0; n]);
    if draw.chance(0.7) {
        case.set("start", "a", rest.clone());
        case.set("end", "a", rest);
        case.part("a");
    }
    match draw.whole(0..4) {
        0 | 3 => {
            scaled(&mut case, draw, "jerk_max", &peaks.jerk, 0.7..2.0, 1.0);
            case.part("jerk_max");
        }
        1 => {
            scaled(&mut case, draw, "torque_rate_max", &peaks.torque_rate, 0.9..2.5, 5.0);
            case.part("torque_rate_max");
        }
        _ => {
            let weights: Vec<f64> =
                peaks.jerk.iter().map(|jerk| draw.log(0.01..1.0) * jerk.max(1.0).powi(-2)).collect();
            case.set("cost", "jerk", list(&weights));
            case.part("jerk cost");
        }
    }
    if draw.chance(0.3) {
        scaled(&mut case, draw, "v_max", &peaks.v, 0.8..1.5, 0.1);
        case.part("v_max");
    }
    if draw.chance(0.3) && case.has("limits", "jerk_max") {
        let guess = case.time;
        free(&mut case, guess);
        case.set("cost", "time", "1.0");
        case.unset("cost", "effort");
        scaled(&mut case, draw, "torque_max", &peaks.torque, 1.1..2.5, 1.0);
        case.part("least time");
    }
    Ok(case)
}

fn free(case: &mut Case, guess: f64) {
    case.unset("time", "final");
    case.set("time", "free", "true");
    case.set("time", "guess", format!("{guess:?}"));
}

/// Powers of joints and of all, motors: 0.6 to 1.5 of the peaks.
pub fn power(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::any(draw, 0.15)?;
    let peaks = case.peaks()?;
    match draw.whole(0..3) {
        0 => {
            scaled(&mut case, draw, "power_max", &peaks.power, 0.6..1.5, 1.0);
            case.part("power_max");
        }
        1 => {
            let most = (draw.even(0.6..1.5) * peaks.total_power).max(1.0);
            case.set("limits", "total_power_max", format!("{most:?}"));
            if !case.has("limits", "from_robot") {
                case.set("limits", "from_robot", "false");
            }
            case.part("total_power_max");
        }
        _ => {
            scaled(&mut case, draw, "torque_max", &peaks.torque, 1.2..2.5, 1.0);
            let corner = draw.even(0.4..1.0);
            let none = corner + draw.log(0.02..1.5);
            let of = |factor: f64| list(&peaks.v.iter().map(|v| factor * v.max(0.3)).collect::<Vec<_>>());
            case.set("limits", "corner_speed", of(corner));
            case.set("limits", "no_load_speed", of(none));
            case.part("motors");
        }
    }
    Ok(case)
}

/// A price of time of 0.01 to 100 times the effort of the quintic, guesses wrong by up to a factor of four.
pub fn free_time(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::any(draw, 0.25)?;
    let peaks = case.peaks()?;
    let price = draw.log(0.01..100.0) * case.dof() as f64;
    let guess = case.time * draw.log(0.25..4.0);
    free(&mut case, guess);
    let weights: Vec<f64> = peaks.torque.iter().map(|tau| tau.max(0.1).powi(-2)).collect();
    case.set("cost", "effort", list(&weights));
    case.set("cost", "time", format!("{price:?}"));
    if draw.chance(0.4) {
        scaled(&mut case, draw, "torque_max", &peaks.torque, 1.0..2.5, 1.0);
        case.part("torque_max");
    }
    Ok(case)
}

/// Least time within limits of torques, with rates and accelerations at times.
pub fn least_time(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::any(draw, 0.15)?;
    let peaks = case.peaks()?;
    let guess = case.time;
    free(&mut case, guess);
    case.set("cost", "time", "1.0");
    case.unset("cost", "effort");
    if draw.chance(0.3) {
        let small = 10_f64.powf(draw.even(-4.0..-1.0));
        let weights: Vec<f64> = peaks.torque.iter().map(|tau| small * tau.max(0.1).powi(-2)).collect();
        case.set("cost", "effort", list(&weights));
        case.part("little effort");
    }
    scaled(&mut case, draw, "torque_max", &peaks.torque, 1.1..3.0, 2.0);
    if draw.chance(0.4) {
        scaled(&mut case, draw, "v_max", &peaks.v, 0.7..2.0, 0.3);
        case.part("v_max");
    }
    if draw.chance(0.3) {
        scaled(&mut case, draw, "a_max", &peaks.a, 0.7..3.0, 1.0);
        case.part("a_max");
    }
    Ok(case)
}

/// Energy at 0.01 to 1 per joule, smoothed over 0.01 to 10 W, with a little effort.
pub fn energy(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::any(draw, 0.2)?;
    let (n, peaks) = (case.dof(), case.peaks()?);
    let price = draw.log(0.01..1.0);
    case.set("cost", "energy", list(&vec![price; n]));
    case.set("cost", "energy_smoothing", format!("{:?}", draw.log(0.01..10.0)));
    let small = draw.log(1e-3..1.0);
    let weights: Vec<f64> = peaks.torque.iter().map(|tau| small * tau.max(0.1).powi(-2)).collect();
    case.set("cost", "effort", list(&weights));
    scaled(&mut case, draw, "torque_max", &peaks.torque, 1.1..3.0, 1.0);
    Ok(case)
}

/// Free positions and rates at the end, and at times at the start.
pub fn free_end(draw: &mut Draw) -> Result<Case, String> {
    let mut case = robots::any(draw, 0.3)?;
    let joints = case.joints();
    let some = |draw: &mut Draw, share: f64| {
        let list: Vec<String> = joints.iter().filter(|_| draw.chance(share)).cloned().collect();
        names(&list)
    };
    let (q, v) = (some(draw, 0.3), some(draw, 0.5));
    case.set("end", "q_free", q);
    case.set("end", "v_free", v);
    if draw.chance(0.2) {
        let v = some(draw, 0.3);
        case.set("start", "v_free", v);
        case.part("free start");
    }
    if draw.chance(0.3) {
        let n = case.dof();
        let rates = draw.list(n, -0.5..0.5);
        case.set("start", "v", list(&rates));
        case.part("moving start");
    }
    Ok(case)
}
