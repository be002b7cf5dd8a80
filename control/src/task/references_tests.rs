use super::*;
use crate::problem::{JointReference, Problem, Task};
use crate::task::build::TaskRows;
use costate::robot::Robot;
use nalgebra::Rotation3;

const STEP: f64 = 1e-5;
const Q: [f64; 6] = [0.3, -1.2, 0.8, 0.1, 0.5, 0.2];

/// References of all kinds of a UR5.
fn task() -> Task {
    let free = f64::INFINITY;
    let times = || vec![0.1, 0.5, 1.2];
    let turn = |r, p, y| Rotation3::from_euler_angles(r, p, y);
    let rows = |k: f64| (0..3).map(|i| (0..6).map(|j| (k + f64::from(i * j)).sin()).collect()).collect();
    let tool = Tool::new("tool0").with_offset([0.1, 0.0, 0.2]);
    let position = vec![[0.3, free, 0.5], [0.2, free, 0.7], [0.6, free, 0.1]];
    let turns = vec![turn(0.3, -0.8, 1.0), turn(1.0, 0.2, -0.5), turn(0.9, 0.2, -0.7)];
    Task::default()
        .with_reference(JointReference::new(times(), rows(0.3), vec![1.0, 0.0, 2.0, 0.5, 0.1, 3.0]))
        .with_reference(JointReference::new(times(), rows(1.3), vec![0.4; 6]).with_velocities(rows(2.0)))
        .with_reference(
            ToolReference::of(tool, times())
                .with_positions(position, 3.0)
                .with_orientations(turns.clone(), 2.0),
        )
        .with_reference(ToolReference::of("wrist_1_link", times()).with_orientations(turns, 1.3))
}

fn references(task: Task) -> References {
    let robot = Robot::from_file("../robots/ur5.urdf").unwrap();
    let listed = task.references.clone();
    let problem = Problem::rest_to_rest(robot, &[0.0; 6], &[1.0; 6], 1.0).with_task(task);
    References::new(&listed, TaskRows::new(&problem).unwrap().references, 6)
}

/// l, then its gradient in q and t, then the Hessian of these, row by row.
fn all(references: &mut References, t: f64, q: &[f64]) -> (f64, Vec<f64>, Vec<f64>) {
    let found = references.contract(t, q).unwrap();
    let mut gradient = found.gradient[..6].to_vec();
    gradient.push(found.by_time[0]);
    let mut hessian = Vec::new();
    for i in 0..6 {
        hessian.extend_from_slice(&found.hessian[12 * i..12 * i + 6]);
        hessian.push(found.mixed[i]);
    }
    hessian.extend_from_slice(&found.mixed[..6]);
    hessian.push(found.by_time[1]);
    (found.value, gradient, hessian)
}

#[test]
fn derivatives_are_those_by_differences() {
    let mut references = references(task());
    assert!(references.any() && references.count() == 4);
    references.start = 0.2;
    for t in [0.0, 0.1, 0.45, 0.8] {
        let (value, gradient, hessian) = all(&mut references, t, &Q);
        assert_eq!(references.evaluate(t, &Q).unwrap(), value);
        for j in 0..7 {
            let mut moved = |step: f64| {
                let (mut q, mut t) = (Q, t);
                if j < 6 {
                    q[j] += step
                } else {
                    t += step
                }
                all(&mut references, t, &q)
            };
            let ((up, above, _), (down, below, _)) = (moved(STEP), moved(-STEP));
            let slope = (up - down) / (2.0 * STEP);
            assert!((gradient[j] - slope).abs() < 1e-7, "{t} {j}: {} {slope}", gradient[j]);
            for i in 0..7 {
                let slope = (above[i] - below[i]) / (2.0 * STEP);
                let found = hessian[7 * i + j];
                assert!((found - slope).abs() < 1e-6, "{t} {i} {j}: {found} {slope}");
            }
        }
    }
    // Beyond the knots nothing changes with the time.
    let (_, gradient, hessian) = all(&mut references, 1.5, &Q);
    assert!(gradient[6] == 0.0 && hessian[48] == 0.0);
}

#[test]
fn what_follows_exactly_costs_nothing() {
    let mut references = references(task());
    let held = |value: [f64; 3]| vec![value; 2];
    let (_, mut placed) = (0, references.functions.clone());
    let mut g = vec![0.0; placed.rows()];
    placed.values_at_rest(&Q, &mut g).unwrap();
    let tool = Tool::new("tool0").with_offset([0.1, 0.0, 0.2]);
    // The rotation from the error of another one.
    let other = Rotation3::from_euler_angles(0.3, -0.8, 1.0);
    let turns = vec![other * Rotation3::from_scaled_axis(Vector3::new(g[2], g[3], g[4])); 2];
    let here = ToolReference::of(tool, vec![0.0, 1.0])
        .with_positions(held([g[0], f64::INFINITY, g[1]]), 3.0)
        .with_orientations(turns.clone(), 2.0);
    let joints = JointReference::new(vec![2.0], vec![Q.to_vec()], vec![1.0; 6]);
    let last = ToolReference::of("wrist_1_link", vec![0.0]).with_orientations(turns[..1].to_vec(), 0.0);
    for (k, reference) in
        [joints.clone().into(), joints.into(), here.clone().into(), last.into()].iter().enumerate()
    {
        references.set(k, reference).unwrap();
    }
    assert!(references.evaluate(0.4, &Q).unwrap() < 1e-24);
    // Another tool, other coordinates, another kind.
    let all = ToolReference::of(here.tool.clone(), vec![0.0]).with_positions(vec![[0.0; 3]], 1.0);
    for other in [all.into(), ToolReference::of("tool0", vec![0.0]).into(), task().references[0].clone()] {
        assert_eq!(references.set(2, &other), Err(OtherKind));
    }
}
