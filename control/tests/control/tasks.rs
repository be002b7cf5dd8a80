//! Motions with tools and obstacles, by the direct method.

use costate::kinematics::Kinematics;
use costate::robot::{Placement, Robot};
use costate_control::{
    Collision, FinalTime, Keep, Kept, LinkCapsule, MotionLimits, Objective, Obstacle, Penalty, Polish,
    Problem, ProblemError, Shape, Solution, Solver, SolverOptions, Status, Task, Tool, ToolCost, ToolPose,
    TrajectoryPoint,
};
use nalgebra::Vector3;

const FREE: f64 = f64::INFINITY;

fn two_link() -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let quarter = std::f64::consts::FRAC_PI_2;
    Problem::rest_to_rest(robot, &[0.0, 0.0], &[quarter, quarter], 1.0).with_limits(MotionLimits::none())
}

fn panda() -> Robot {
    Robot::from_file("../robots/panda.urdf").unwrap()
}

const PANDA: [f64; 7] = [0.0, -0.5, 0.0, -2.2, 0.0, 1.7, 0.8];

fn options() -> SolverOptions {
    SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never)
}

fn solve(problem: &Problem) -> Solution {
    solve_to(problem, 1e-6)
}

fn solve_to(problem: &Problem, tolerance: f64) -> Solution {
    let solution = Solver::new(problem, options().with_tolerance(tolerance)).unwrap().solve();
    assert_eq!(solution.motion.status, Status::Converged, "{:?}", solution.limits);
    solution
}

/// The motion at many times.
fn samples(solution: &Solution, count: usize) -> impl Iterator<Item = TrajectoryPoint> {
    let (trajectory, time) = (solution.trajectory.clone(), solution.motion.final_time);
    (0..=count).map(move |k| trajectory.at(time * k as f64 / count as f64).unwrap())
}

/// Where a frame is.
struct Frame {
    kinematics: Kinematics<f64>,
    number: usize,
}

impl Frame {
    fn new(robot: &Robot, name: &str) -> Self {
        Self { kinematics: Kinematics::new(robot), number: robot.frame_index(name).unwrap() }
    }

    /// Its position and third axis.
    fn at(&mut self, q: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        self.kinematics.set_state(q, &vec![0.0; q.len()]).unwrap();
        let pose = self.kinematics.pose(self.number).unwrap();
        (pose.position.into(), Vector3::from(pose.rotation.map(|row| row[2])))
    }
}

/// The tip of the two-link arm.
fn tip() -> Tool {
    Tool::new("joint:elbow").with_offset([1.0, 0.0, 0.0])
}

#[test]
fn the_tip_ends_on_a_line() {
    // Collocation with CasADi and IPOPT has the value to 5e-8: `bash benches/ocp/run --values values`.
    let mut problem = two_link();
    problem.end.q_free = vec![0, 1];
    problem.end.q = vec![0.2, 1.0];
    let problem = problem
        .with_task(Task::default().with_end_tool(ToolPose::of(tip()).with_position([FREE, 1.2, FREE])));
    let solution = solve(&problem);
    assert!((solution.motion.cost / 68.527_088_5 - 1.0).abs() < 3e-7, "{}", solution.motion.cost);
    let end = samples(&solution, 1).last().unwrap();
    assert!((end.q[0] - 0.228_385).abs() < 1e-4 && (end.q[1] - 1.112_102).abs() < 1e-4, "{:?}", end.q);
    let height = end.q[0].sin() + (end.q[0] + end.q[1]).sin();
    assert!((height - 1.2).abs() < 1e-8, "{height}");
    assert!(solution.end_defect < 1e-6);
}

/// Centre and radius of a disc in the way of the tip.
const DISC: ([f64; 2], f64) = ([0.34, 0.59], 0.25);

/// With the tip outside of a disc; it costs 170.506985.
pub fn around_a_disc() -> Problem {
    let (centre, radius) = DISC;
    let along = |z: f64| [centre[0], centre[1], z];
    let disc = Obstacle::new("disc", Shape::Capsule { from: along(-1.0), to: along(1.0), radius });
    let body = LinkCapsule::sphere("joint:elbow", 0.0).with_from([1.0, 0.0, 0.0]).with_name("tip");
    two_link().with_task(Task::default().with_obstacle(disc).with_collision(Collision::of(vec![body])))
}

#[test]
fn the_tip_stays_outside_of_a_disc() {
    // Collocation with CasADi and IPOPT has the value to 2e-5: `bash benches/ocp/run --values values`.
    let (centre, radius) = DISC;
    let problem = around_a_disc();
    // The straight way in the joints leads to 227.23, on the other side; the motion without the disc does
    // not.
    let solution = solve(&problem);
    assert_eq!(solution.motion.status, Status::Converged);
    assert!((solution.motion.cost / 170.506_985 - 1.0).abs() < 1e-6, "{}", solution.motion.cost);
    let distance = |q: &[f64]| {
        let (a, b) = (q[0], q[0] + q[1]);
        (a.cos() + b.cos() - centre[0]).hypot(a.sin() + b.sin() - centre[1]) - radius
    };
    let least = samples(&solution, 2000).map(|point| distance(&point.q)).fold(f64::INFINITY, f64::min);
    assert!(least > -2.5e-5 && least < 1e-5, "it touches the disc: {least}");
    let usage = solution.limits.task.unwrap();
    assert!(usage.at_points < 1e-8 && usage.active.iter().all(|span| span.name.contains("disc")));
    assert!(!usage.active.is_empty());
}

#[test]
fn a_cup_stays_upright_on_a_plane() {
    let robot = panda();
    let mut end = PANDA;
    end[0] = 1.2;
    let kept = |kept| Keep::new("panda_link8", kept);
    let mut hand = Frame::new(&robot, "panda_link8");
    let (start, _) = hand.at(&PANDA);
    let plane = Kept::Plane { through: start.into(), normal: [0.0, 0.0, 1.0], distance: 0.0 };
    let upright = Kept::Axis { axis: [0.0, 0.0, 1.0], along: [0.0, 0.0, -1.0], angle: 0.0 };
    let task = Task::default().with_keep(kept(plane)).with_keep(kept(upright));
    let problem = Problem::rest_to_rest(robot, &PANDA, &end, 1.5).with_task(task);
    let solution = solve_to(&problem, 1e-4);
    for point in samples(&solution, 300) {
        let (x, axis) = hand.at(&point.q);
        assert!((x.z - start.z).abs() < 1e-4 && axis.z < -1.0 + 1e-7, "{} {axis}", x.z - start.z);
    }
    assert!(solution.limits.task.unwrap().at_points < 1e-7);
}

#[test]
fn a_tool_reaches_a_pose_within_all_limits_and_speed_is_kept() {
    let robot = panda();
    let (position, down) = ([0.45, 0.3, 0.35], [0.0, 0.0, -1.0]);
    let pose_there = ToolPose::of("panda_link8").with_position(position).with_axis([0.0, 0.0, 1.0], down);
    let mut problem = Problem::rest_to_rest(robot.clone(), &PANDA, &PANDA, 1.5);
    problem.end.q_free = (0..7).collect();
    let free = solve_to(&problem.clone().with_task(Task::default().with_end_tool(pose_there.clone())), 1e-4);
    let task = Task::default()
        .with_end_tool(pose_there)
        .with_keep(Keep::new("panda_link8", Kept::Speed { max: 0.5 }));
    let slow = solve_to(&problem.with_task(task), 1e-4);
    assert!(slow.motion.cost > free.motion.cost * (1.0 + 1e-6));
    let mut hand = Frame::new(&robot, "panda_link8");
    let mut fastest = [0.0_f64; 2];
    for (solution, fastest) in [&free, &slow].into_iter().zip(&mut fastest) {
        let points: Vec<_> = samples(solution, 400).collect();
        for pair in points.windows(2) {
            let [a, b] = [0, 1].map(|k| hand.at(&pair[k].q).0);
            *fastest = fastest.max((b - a).norm() / (pair[1].t - pair[0].t));
        }
        let (x, axis) = hand.at(&points[400].q);
        assert!((x - Vector3::from(position)).norm() < 1e-7 && (axis.z + 1.0).abs() < 1e-12);
    }
    assert!(fastest[0] > 0.51 && fastest[1] < 0.5001, "{fastest:?}");
}

#[test]
fn costs_of_tools_pull_them_to_their_place() {
    let mut problem = two_link();
    let place = [1.2, 1.2, FREE];
    let far = |solution: &Solution| -> f64 {
        let distance = |q: &[f64]| {
            let (a, b) = (q[0], q[0] + q[1]);
            (a.cos() + b.cos() - place[0]).powi(2) + (a.sin() + b.sin() - place[1]).powi(2)
        };
        samples(solution, 400).map(|point| distance(&point.q)).sum::<f64>() / 400.0
    };
    let free = solve(&problem);
    let pose = ToolPose::of(tip()).with_position(place);
    problem = problem.with_task(Task::default().with_tool_cost(ToolCost::new(pose, 2000.0, 0.0)));
    let pulled = solve(&problem);
    assert!(far(&pulled) < 0.9 * far(&free), "{} {}", far(&pulled), far(&free));
    // What the cost contains, by samples: the effort of the other motion is no lower.
    assert!(pulled.motion.cost < free.motion.cost + 1000.0 * far(&free));
    assert!(pulled.motion.cost > free.motion.cost);
    assert!(pulled.motion.hamiltonian_drift < 1e-3);
}

#[test]
fn costs_of_tools_and_penalties_are_costs() {
    let limits = MotionLimits::none().with_torque_max(vec![50.0; 2]);
    let bare = two_link().with_limits(limits).with_cost(Objective::new(0.0, vec![0.0; 2]));
    let free = |problem: &Problem| {
        let mut problem = problem.clone();
        problem.time = FinalTime::Free { guess: 1.0 };
        problem
    };
    let error = |problem: &Problem| Solver::new(problem, options()).unwrap_err();
    assert_eq!(error(&bare), ProblemError::NothingToMinimise);
    assert_eq!(error(&free(&bare)), ProblemError::FreeTimeWithoutCost);
    let with_tool = |weight: f64| {
        let pose = ToolPose::of(tip()).with_position([1.2, 1.2, FREE]);
        bare.clone().with_task(Task::default().with_tool_cost(ToolCost::new(pose, weight, 0.0)))
    };
    assert_eq!(error(&with_tool(0.0)), ProblemError::NothingToMinimise);
    for problem in [with_tool(1.0), free(&with_tool(1.0))] {
        assert!(Solver::new(&problem, options()).is_ok());
    }
    let mut penalised = bare.clone();
    penalised.penalty = Some(Penalty::new(10.0).with_v_max(vec![1.0; 2]));
    assert!(Solver::new(&penalised, options()).is_ok());
    // A slow motion avoids penalties.
    assert_eq!(error(&free(&penalised)), ProblemError::FreeTimeWithoutCost);
}

#[test]
fn no_link_passes_through_a_thin_plate() {
    // The straight way leads through a plate that is thinner than the steps between points.
    let mut end = PANDA;
    end[0] = 1.4;
    let size = [0.6, 0.002, 0.5];
    let angle = 0.7_f64;
    let placement = Placement::from_xyz_rpy([0.5 * angle.cos(), 0.5 * angle.sin(), 0.3], [0.0, 0.0, angle]);
    let task = Task::default()
        .with_obstacle(Obstacle::new("plate", Shape::Box { placement, size }))
        .with_collision(Collision::along_links(0.02));
    let problem = Problem::rest_to_rest(panda(), &PANDA, &end, 1.0).with_task(task);
    let solution = solve_to(&problem, 1e-3);
    // The hand: whether it is at the plate, within its edges.
    let mut hand = Frame::new(&problem.robot, "panda_link7");
    let mut through = false;
    let mut before: Option<f64> = None;
    for point in samples(&solution, 4000) {
        let (x, _) = hand.at(&point.q);
        let [across, along] = [angle.cos() * x.y - angle.sin() * x.x, angle.cos() * x.x + angle.sin() * x.y];
        let inside = (along - 0.5).abs() < 0.3 && (x.z - 0.3).abs() < 0.25;
        through |= inside && before.is_some_and(|before| before * across < 0.0);
        before = Some(across);
    }
    assert!(!through, "the hand went through the plate");
}

/// The same where accelerations are continuous.
#[test]
fn no_link_passes_through_a_thin_post_with_limited_jerks() {
    let mut problem = two_link();
    problem.end.q = vec![1.4, 0.0];
    let (angle, size) = (0.7_f64, [0.5, 0.004, 1.0]);
    let placement = Placement::from_xyz_rpy([1.95 * angle.cos(), 1.95 * angle.sin(), 0.0], [0.0, 0.0, angle]);
    let task = Task::default()
        .with_obstacle(Obstacle::new("post", Shape::Box { placement, size }))
        .with_collision(Collision::along_links(0.02));
    let limits = MotionLimits::none().with_jerk_max(vec![400.0, 400.0]);
    let problem = problem.with_limits(limits).with_task(task);
    let solution = solve_to(&problem, 1e-3);
    // The tip goes by within the inner edge.
    for point in samples(&solution, 4000) {
        let (a, b) = (point.q[0], point.q[0] + point.q[1]);
        let (x, y) = (a.cos() + b.cos(), a.sin() + b.sin());
        let [across, along] = [angle.cos() * y - angle.sin() * x, angle.cos() * x + angle.sin() * y];
        assert!(across.abs() > 0.002 || along < 1.7, "{} {along} {across}", point.t);
    }
}

/// A redundant arm between two places of its hand, all positions free at both ends: nothing but the cost
/// tells where it stands.
#[test]
fn a_redundant_arm_chooses_both_ends() {
    let robot = panda();
    let mut hand = Frame::new(&robot, "panda_link8");
    let (from, _) = hand.at(&PANDA);
    let to = [from.x - 0.1, from.y + 0.5, from.z + 0.1];
    let pose = |position: [f64; 3]| ToolPose::of("panda_link8").with_position(position);
    let task = Task::default().with_end_tool(pose(to));
    let mut problem = Problem::rest_to_rest(robot, &PANDA, &PANDA, 1.0).with_task(task.clone());
    problem.end.q_free = (0..7).collect();
    let one = solve_to(&problem, 1e-4).motion.cost;
    problem.task = task.with_start_tool(pose(from.into()));
    problem.start.q_free = (0..7).collect();
    let solution = solve_to(&problem, 1e-4);
    assert!(solution.motion.cost < one, "{} {one}", solution.motion.cost);
    let points: Vec<_> = samples(&solution, 1).collect();
    for (point, place) in points.iter().zip([from, to.into()]) {
        assert!((hand.at(&point.q).0 - place).norm() < 1e-6);
    }
}

#[test]
fn what_is_kept_holds_at_an_end_that_gives_something_else() {
    // The tip of two unit links goes from y = -0.6 to 0.6 at x = 1.2: the height is given at the end, the
    // plane is kept along the way. So the end is that of the inverse kinematics.
    let elbow = |y: f64| {
        let square = 1.2_f64 * 1.2 + y * y;
        let bend = ((square - 2.0) / 2.0).acos();
        [y.atan2(1.2) - bend.sin().atan2(1.0 + bend.cos()), bend]
    };
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let tip = || Tool::new("joint:elbow").with_offset([1.0, 0.0, 0.0]);
    let plane = Kept::Plane { through: [1.2, 0.0, 0.0], normal: [1.0, 0.0, 0.0], distance: 0.0 };
    let task = Task::default().with_keep(Keep::new(tip(), plane));
    let given = Problem::rest_to_rest(robot, &elbow(-0.6), &elbow(0.6), 1.0)
        .with_limits(MotionLimits::none())
        .with_task(task.clone());
    let mut reached = given.clone();
    reached.end.q_free = vec![0, 1];
    reached.end.q[0] += 0.1;
    reached.task = task.with_end_tool(ToolPose::of(tip()).with_position([FREE, 0.6, FREE]));
    let (given, reached) = (solve(&given), solve(&reached));
    let end = reached.trajectory.q.last().unwrap();
    let expected = elbow(0.6);
    assert!((0..2).all(|i| (end[i] - expected[i]).abs() < 1e-6), "{end:?} {expected:?}");
    assert!((reached.total() / given.total() - 1.0).abs() < 1e-6, "{} {}", reached.total(), given.total());
}
