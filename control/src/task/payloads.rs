//! The bodies of what the robot carries.
//!
//! Clearances are those of spheres and capsules. The corners of a box are the ends of four segments along its
//! longest edge, which is exact beside a half-space. For all else capsules contain it: its cross-section, a
//! by b with `a <= b`, is divided into cells of w_a by w_b, about squares of a / 2 in bulky boxes and of a in
//! flat ones. A capsule along the middle of a cell that ends e inside of the faces has the radius
//!
//! ```text
//! R = sqrt((w_a^2 + w_b^2) / 4 + e^2),    e = w_b / 2
//! ```
//!
//! so that its caps reach the corners of the cell, and protrudes by R - w_b / 2: 0.18 a in bulky boxes, 0.37
//! a in flat ones, 0.09 b at most in sheets.

use super::bodies::{Link, segment};
use super::clearance::Body;
use super::given::{finite, frame_of, length};
use super::placed::Carried;
use crate::problem::error::ProblemError;
use crate::problem::key::Key;
use crate::problem::obstacles::Shape;
use crate::problem::task_error::TaskError;
use crate::problem::{Payload, Problem, tools};
use costate::robot::Robot;
use nalgebra::{Matrix3, Vector3};

/// Most capsules across a box.
const MOST_CELLS: f64 = 8.0;

/// A box is flat if its second longest edge is longer than this many times the shortest one.
const FLAT: f64 = 2.0;

/// What a body counts with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Against {
    All,
    /// Half-spaces alone: the corners of a box.
    HalfSpaces,
    /// All but half-spaces: the capsules that contain a box.
    Others,
}

/// A payload with a body, and the phases in which it is carried: `None` for all.
#[derive(Clone, Debug)]
pub(super) struct Load<'a> {
    pub payload: &'a Payload,
    pub key: Key,
    pub phases: Option<Vec<bool>>,
}

/// The payloads with bodies of a problem. One that several vias name is one body.
pub(super) fn loads(problem: &Problem) -> Vec<Load<'_>> {
    let has_body = |payload: &Payload| payload.shape.is_some();
    let own = problem.task.payloads.iter().enumerate().filter(|(_, payload)| has_body(payload));
    let mut loads: Vec<Load<'_>> = own
        .map(|(entry, payload)| Load {
            payload,
            key: Key::entry("robot.payload", "shape", entry),
            phases: None,
        })
        .collect();
    let fixed = loads.len();
    let vias = &problem.vias;
    for (number, via) in vias.iter().enumerate() {
        let until = (number + 1..vias.len()).find(|&next| vias[next].payload.is_some()).unwrap_or(vias.len());
        for payload in via.payload.iter().flatten().filter(|payload| has_body(payload)) {
            let known = (fixed..loads.len()).find(|&k| loads[k].payload == payload);
            let at = known.unwrap_or_else(|| {
                let phases = Some(vec![false; vias.len() + 1]);
                loads.push(Load { payload, key: Key::via("payload", number), phases });
                loads.len() - 1
            });
            if let Some(phases) = &mut loads[at].phases {
                phases[number + 1..=until].fill(true);
            }
        }
    }
    loads
}

/// The spheres and capsules of a payload.
pub(super) fn bodies(robot: &Robot, load: &Load<'_>) -> Result<Vec<(Link, Against)>, ProblemError> {
    let (payload, key) = (load.payload, load.key);
    let frame = frame_of(robot, key, &payload.frame)?;
    let link = |from: Vector3<f64>, to: Option<Vector3<f64>>, radius: f64| Link {
        name: payload.name(),
        joint: robot.frames()[frame].joint,
        body: Body { carried: Some(Carried::new(robot, frame)), from, to: segment(&from, to), radius },
    };
    Ok(match &payload.shape {
        None => Vec::new(),
        Some(Shape::Sphere { centre, radius }) => {
            finite(key, centre)?;
            length(key, *radius)?;
            vec![(link(Vector3::from(*centre), None, *radius), Against::All)]
        }
        Some(Shape::Capsule { from, to, radius }) => {
            finite(key, from)?;
            finite(key, to)?;
            length(key, *radius)?;
            vec![(link(Vector3::from(*from), Some(Vector3::from(*to)), *radius), Against::All)]
        }
        Some(Shape::Box { placement, size }) => {
            finite(key, placement.translation.as_slice())?;
            size.iter().try_for_each(|&size| length(key, size))?;
            let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| placement.rotation[(i, j)]));
            let axes = tools::rotation(rows).ok_or_else(|| TaskError::NotARotation.at(key))?;
            let all = segments_of_box(placement.translation, axes.matrix(), *size);
            all.into_iter()
                .map(|(from, to, radius)| {
                    let against = if radius > 0.0 { Against::Others } else { Against::HalfSpaces };
                    (link(from, Some(to), radius), against)
                })
                .collect()
        }
        Some(Shape::HalfSpace { .. }) => return Err(TaskError::BodyWithoutEnd.at(key)),
    })
}

/// The edges of a box along its longest ones, with radius 0, and the capsules that contain it.
fn segments_of_box(
    centre: Vector3<f64>,
    axes: &Matrix3<f64>,
    size: [f64; 3],
) -> Vec<(Vector3<f64>, Vector3<f64>, f64)> {
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| size[i].total_cmp(&size[j]));
    let [a, b, c] = order.map(|i| size[i]);
    let [x, y, z] = order.map(|i| axes.column(i).into_owned());
    let across = if b > FLAT * a { 1.0 } else { 2.0 };
    let along = (b * across / a).ceil().min(MOST_CELLS);
    let [cell_a, cell_b] = [a / across, b / along];
    let inside = 0.5 * cell_b.min(c);
    let radius = (0.25 * (cell_a * cell_a + cell_b * cell_b) + inside * inside).sqrt();
    let segment = |at: [f64; 2], half: f64, radius: f64| {
        let middle = centre + x * at[0] + y * at[1];
        (middle - z * half, middle + z * half, radius)
    };
    let corners = [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]];
    let mut all: Vec<_> = corners.iter().map(|[i, j]| segment([i * a, j * b], 0.5 * c, 0.0)).collect();
    for i in 0..across as usize {
        for j in 0..along as usize {
            let at = [(i as f64 + 0.5) * cell_a - 0.5 * a, (j as f64 + 0.5) * cell_b - 0.5 * b];
            all.push(segment(at, 0.5 * c - inside, radius));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    /// Each point of a box is in one of its capsules, and these protrude no farther than they are said to.
    #[test]
    fn capsules_contain_the_box_and_protrude_as_stated() {
        let (centre, turn) = (Vector3::new(0.3, -0.2, 0.1), Rotation3::from_euler_angles(0.3, -1.0, 2.0));
        let mut random = fastrand::Rng::with_seed(5);
        for size in
            [[1.0; 3], [0.3, 0.2, 0.4], [0.2, 0.5, 0.2], [0.02, 0.4, 0.3], [0.5, 0.001, 0.5], [0.1, 0.1, 2.0]]
        {
            let all = segments_of_box(centre, turn.matrix(), size);
            let (edges, capsules) = all.split_at(4);
            let distance = |x: &Vector3<f64>, (from, to, radius): &(Vector3<f64>, Vector3<f64>, f64)| {
                let way = to - from;
                let part = if way.norm() > 0.0 { (x - from).dot(&way) / way.norm_squared() } else { 0.0 };
                (x - from - way * part.clamp(0.0, 1.0)).norm() - radius
            };
            let nearest =
                |x: &Vector3<f64>| capsules.iter().map(|one| distance(x, one)).fold(f64::MAX, f64::min);
            let mut sorted = size;
            sorted.sort_by(f64::total_cmp);
            let most = (0.37 * sorted[0]).max(0.09 * sorted[1]);
            for _ in 0..3000 {
                let mut part = |_: usize| random.f64() - 0.5;
                let own = Vector3::from([0, 1, 2].map(&mut part));
                // On a face, an edge or a corner.
                let own = Vector3::from_fn(|k, _| match (own[k] * 1e6) as i64 % 3 {
                    0 => 0.5_f64.copysign(own[k]),
                    _ => own[k],
                });
                let x = centre + turn * own.component_mul(&Vector3::from(size));
                assert!(nearest(&x) < 1e-12, "{size:?} {own} {}", nearest(&x));
                let far = own * (1.0 + 1e-9);
                let outward =
                    Vector3::from_fn(|k, _| if far[k].abs() >= 0.5 { far[k].signum() } else { 0.0 });
                if outward.norm() > 0.0 {
                    let outside = x + turn * (outward * (most * 1.001));
                    assert!(nearest(&outside) > 0.0, "{size:?} {own} {}", nearest(&outside));
                }
            }
            let ends: Vec<Vector3<f64>> = edges.iter().flat_map(|(from, to, _)| [*from, *to]).collect();
            for corner in 0..8 {
                let sign = |bit: i32| if corner >> bit & 1 == 0 { -0.5 } else { 0.5 };
                let own = Vector3::new(sign(0) * size[0], sign(1) * size[1], sign(2) * size[2]);
                assert!(ends.iter().any(|end| (end - centre - turn * own).norm() < 1e-12));
            }
        }
    }
}
