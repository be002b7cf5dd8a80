//! Clearances against distances that another program computed.

use super::*;
use crate::problem::obstacles::{Collision, LinkCapsule};
use crate::problem::{Problem, Task};
use crate::task::build::TaskRows;
use crate::task::functions::PathFunction;
use costate::robot::Placement;
use serde_json::Value;

/// The distance of surfaces that belongs to a clearance: `c = sqrt2 sqrt(D^2 + R^2) - 2 R` solved for D - R.
fn distance(c: f64, radius: f64) -> f64 {
    let root = 0.5 * (c + 2.0 * radius).powi(2) - radius * radius;
    root.max(0.0).sqrt() - radius
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

fn triple(value: &Value) -> [f64; 3] {
    numbers(value).try_into().unwrap()
}

/// The scene of the first line.
fn task(scene: &Value) -> Task {
    let mut capsules = Vec::new();
    for (k, body) in scene["bodies"].as_array().unwrap().iter().enumerate() {
        let ends = body[1].as_array().unwrap();
        let mut capsule =
            LinkCapsule::sphere(format!("joint:{}", body[0].as_str().unwrap()), number(&body[2]));
        capsule = capsule.with_name(format!("body {k}")).with_from(triple(&ends[0]));
        capsule.to = ends.get(1).map(triple);
        capsules.push(capsule);
    }
    let pair = |pair: &Value| [0, 1].map(|k| format!("body {}", pair[k].as_u64().unwrap()));
    let pairs = scene["pairs"].as_array().unwrap().iter().map(pair).collect();
    let [sphere, capsule, cube, plane] = ["sphere", "capsule", "box", "half_space"].map(|name| &scene[name]);
    let placement = Placement::from_xyz_rpy(triple(&cube["xyz"]), triple(&cube["rpy"]));
    let shapes = [
        Shape::Sphere { centre: triple(&sphere["xyz"]), radius: number(&sphere["radius"]) },
        Shape::Capsule {
            from: triple(&capsule["from"]),
            to: triple(&capsule["to"]),
            radius: number(&capsule["radius"]),
        },
        Shape::Box { placement, size: triple(&cube["size"]) },
        Shape::HalfSpace { through: triple(&plane["xyz"]), normal: triple(&plane["normal"]) },
    ];
    let mut task =
        Task::default().with_collision(Collision::of(capsules).with_pairs(BodyPairs::These(pairs)));
    for (k, shape) in shapes.into_iter().enumerate() {
        task = task.with_obstacle(Obstacle::new(format!("{k}"), shape));
    }
    task
}

#[test]
fn clearances_are_the_distances_of_another_program() {
    let text = include_str!("../../../tests/fixtures/ur5.clearances.jsonl");
    let mut lines = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let arm = Robot::from_file("../robots/ur5.urdf").unwrap();
    let problem =
        Problem::rest_to_rest(arm, &[0.0; 6], &[1.0; 6], 1.0).with_task(task(&lines.next().unwrap()));
    let mut along = TaskRows::new(&problem).unwrap().along;
    let mut g = vec![0.0; along.rows()];
    let mut compared = 0;
    for line in lines {
        along.values(&numbers(&line["q"]), &[0.0; 6], &mut g).unwrap();
        let obstacles = line["obstacles"].as_array().unwrap().iter().flat_map(numbers);
        let mut rows = along.bounds().iter().zip(&g).peekable();
        for expected in obstacles.chain(numbers(&line["pairs"])) {
            let (row, &c) = rows.next().unwrap();
            if row.name.ends_with("from '3'") {
                // Both ends of a capsule: the nearer one counts.
                let other = rows.next_if(|(next, _)| next.name == row.name).map_or(c, |(_, &c)| c);
                assert!((c.min(other) - expected).abs() < 1e-12, "{}: {c} {other} {expected}", row.name);
                compared += 1;
                continue;
            }
            // Where cores meet, the other program tells how far they would have to move.
            if expected > 0.01 - row.range {
                let found = distance(c, row.range);
                let lower = expected - 1e-3 * row.range - 1e-9;
                assert!((lower..expected + 1e-9).contains(&found), "{}: {found} {expected}", row.name);
                compared += 1;
            }
        }
        assert!(rows.next().is_none());
    }
    assert!(compared > 40 * 17, "{compared}");
}

#[test]
fn a_body_does_not_pass_through_a_plate_unseen() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    // A plate of a millimetre across the way of the second rod, and one beside the way.
    for (height, is_hit) in [(0.0, true), (0.3, false)] {
        let placement = Placement::from_xyz_rpy([0.0, 1.5, height], [0.0; 3]);
        let size = [0.001, 1.0, 0.2];
        let task = Task::default()
            .with_obstacle(Obstacle::new("plate", Shape::Box { placement, size }))
            .with_collision(Collision::of(vec![LinkCapsule::new(
                "joint:elbow",
                [0.0; 3],
                [1.0, 0.0, 0.0],
                0.01,
            )]));
        let problem = Problem::rest_to_rest(robot.clone(), &[0.0; 2], &[3.0, 0.0], 1.0).with_task(task);
        let mut along = TaskRows::new(&problem).unwrap().along;
        let mut g = vec![0.0; along.rows()];
        for q in [[0.0, 0.0], [3.0, 0.0]] {
            along.values(&q, &[0.0; 2], &mut g).unwrap();
            assert!(g.iter().all(|g| *g > 0.1), "the ends are free");
        }
        let mut looks = 0;
        let state = |x: f64, q: &mut [f64]| {
            looks += 1;
            q.copy_from_slice(&[3.0 * x, 0.0]);
        };
        let found = along.sweep([&[3.0, 0.0], &[3.0, 0.0]], &mut [0.0; 2], state).unwrap();
        let worst = found.part;
        // Cores that meet are at -0.59 R, and deeper inside of the plate.
        assert_eq!(worst > 0.1, is_hit, "{worst}");
        assert!(is_hit || worst == 0.0);
        // At x the rod has turned by 3 x, and reaches the plate at a quarter of a turn, or a little before.
        assert!(!is_hit || (0.4..0.53).contains(&found.place), "{found:?}");
        assert!(found.row < along.rows());
        assert!((2..2000).contains(&looks), "{looks}");
    }
}
