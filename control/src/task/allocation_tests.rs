//! Evaluations of tasks do not allocate.

use super::build::TaskRows;
use super::costs::ToolCosts;
use super::functions::PathFunction;
use crate::problem::obstacles::{BodyPairs, Collision, Obstacle, Shape};
use crate::problem::tools::{Keep, Kept, ToolCost, ToolPose};
use crate::problem::{Problem, Task};
use costate::robot::{Placement, Robot};
use costate_test_support::allocations::allocations;
use nalgebra::Rotation3;

#[test]
fn functions_of_every_kind_allocate_nothing() {
    let arm = Robot::from_file("../robots/ur5.urdf").unwrap();
    let (through, along) = ([0.1, 0.2, 0.3], [0.0, 0.6, 0.8]);
    let rotation = Rotation3::identity();
    let pose = ToolPose::of("tool0").with_position(through).with_rotation(rotation);
    let mut task = Task::default()
        .with_tool_cost(ToolCost::new(pose, 1.0, 2.0))
        .with_collision(Collision::along_links(0.05).with_pairs(BodyPairs::All));
    for kept in [
        Kept::Plane { through, normal: along, distance: 0.0 },
        Kept::Line { through, along, distance: 0.1 },
        Kept::Axis { axis: along, along, angle: 0.0 },
        Kept::Axis { axis: along, along, angle: 0.1 },
        Kept::Orientation { rotation, angle: 0.0 },
        Kept::Orientation { rotation, angle: 0.1 },
        Kept::Speed { max: 1.0 },
    ] {
        task = task.with_keep(Keep::new("tool0", kept));
    }
    // The box is around the arm: depths count.
    for (k, shape) in [
        Shape::Sphere { centre: through, radius: 0.2 },
        Shape::Capsule { from: through, to: along, radius: 0.2 },
        Shape::Box { placement: Placement::identity(), size: [1.0, 2.0, 3.0] },
        Shape::HalfSpace { through, normal: along },
    ]
    .into_iter()
    .enumerate()
    {
        task = task.with_obstacle(Obstacle::new(k.to_string(), shape));
    }
    let problem = Problem::rest_to_rest(arm, &[0.0; 6], &[1.0; 6], 1.0).with_task(task);
    let mut rows = TaskRows::new(&problem).unwrap();
    let mut costs = ToolCosts::new(rows.costs, rows.weights, 6);
    let count = rows.along.rows();
    let (q, v) = ([0.3, -1.2, 0.8, 0.1, 0.5, 0.2], [0.1; 6]);
    let (w, mut g, mut jacobian) = (vec![1.0; count], vec![0.0; count], vec![0.0; 12 * count]);
    let mut hessian = vec![0.0; 144];
    let found = allocations(|| {
        rows.along.values(&q, &v, &mut g).unwrap();
        rows.along.contract(&q, &v, &w, &mut g, &mut jacobian, &mut hessian).unwrap();
        costs.contract(&q, &v).unwrap();
    });
    assert_eq!(found, 0);
    assert_eq!(count, 40);
}
