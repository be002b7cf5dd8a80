//! Where tools stay: planes, lines and boxes of the problem.

use super::values::{number, placement, shown, vector};
use costate::robot::Placement;
use costate_control::{Kept, Problem};
use serde_json::{Value, json};

/// Radius of a line that is kept exactly (m).
const THIN: f64 = 0.004;

/// Half the length of a line that has no end (m).
const FAR: f64 = 1.5;

/// The regions that can be drawn: boxes only with all their sides.
pub fn regions(problem: &Problem) -> Vec<Value> {
    let region = |name: &str, at: &Placement, shape: Value| json!({ "name": shown(name), "at": placement(at), "shape": shape });
    let world = Placement::identity();
    let all = problem.task.keep.iter().filter_map(|keep| {
        let name = &keep.tool.frame;
        Some(match &keep.kept {
            Kept::Plane { through, normal, .. } => {
                let shape =
                    json!({ "kind": "plane", "through": vector(*through), "normal": vector(*normal) });
                region(name, &world, shape)
            }
            Kept::Line { through, along, distance } => {
                let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
                let end = |side: f64| [0, 1, 2].map(|k| through[k] + side * FAR * along[k] / length);
                let radius = number(distance.max(THIN));
                let (from, to) = (vector(end(-1.0)), vector(end(1.0)));
                region(name, &world, json!({ "kind": "capsule", "from": from, "to": to, "radius": radius }))
            }
            Kept::Box { min, max } if min.iter().chain(max).all(|x| x.is_finite()) => {
                let centre = [0, 1, 2].map(|k| 0.5 * (min[k] + max[k]));
                let size = [0, 1, 2].map(|k| max[k] - min[k]);
                let at = Placement::from_xyz_rpy(centre, [0.0; 3]);
                region(name, &at, json!({ "kind": "box", "size": vector(size) }))
            }
            _ => return None,
        })
    });
    all.collect()
}
