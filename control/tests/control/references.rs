//! References over time, against closed forms.
//!
//! A mass of 1 kg with the cost 1/2 u^2 + 1/2 w (q - r(t))^2 and a cubic r has the optimal distance e = q - r
//! with e'''' = -w e: products of exp(+-k t) with the sine and cosine of k t, 4 k^4 = w.

use crate::sledge;
use costate::robot::{JointSpec, LinkInertia, LoadOptions, Robot};
use costate_control::{
    BoundaryState, FinalTime, JointReference, MotionLimits, Objective, Polish, Problem, ProblemError,
    ProblemFile, Reference, Solution, Solver, SolverOptions, Status, Task, TaskError, Tool, ToolReference,
    Via,
};
use nalgebra::{Matrix4, Rotation3, Vector4};

const WEIGHT: f64 = 300.0;
/// q and v at the start and at the end.
const START: [f64; 2] = [0.2, 0.0];
const END: [f64; 2] = [0.5, 0.3];
/// Cost of a second.
const SECOND: f64 = 0.9;

/// The reference with its first two derivatives.
fn reference(t: f64) -> [f64; 3] {
    [0.1 + 0.9 * t - 0.4 * t.powi(3), 0.9 - 1.2 * t * t, -2.4 * t]
}

/// The optimal motion in the time T.
struct Exact {
    time: f64,
    rate: f64,
    coefficients: Vector4<f64>,
}

impl Exact {
    fn new(time: f64) -> Self {
        let rate = (WEIGHT / 4.0_f64).powf(0.25);
        let [from, to] = [basis(rate, 0.0, time), basis(rate, time, time)];
        let rows = Matrix4::from_fn(|i, j| [from, to][i / 2][i % 2][j]);
        let [a, b] = [reference(0.0), reference(time)];
        let right = Vector4::new(START[0] - a[0], START[1] - a[1], END[0] - b[0], END[1] - b[1]);
        Self { time, rate, coefficients: rows.lu().solve(&right).unwrap() }
    }

    /// q, v, u.
    fn at(&self, t: f64) -> [f64; 3] {
        let basis = basis(self.rate, t, self.time);
        let of = |k: usize| Vector4::from(basis[k]).dot(&self.coefficients) + reference(t)[k];
        [of(0), of(1), of(2)]
    }

    /// Without that of time.
    fn cost(&self) -> f64 {
        let (pieces, place) = (400, (3.0_f64 / 20.0).sqrt());
        let h = self.time / f64::from(pieces);
        let rate = |t: f64| {
            let [q, _, u] = self.at(t);
            0.5 * u * u + 0.5 * WEIGHT * (q - reference(t)[0]).powi(2)
        };
        let of = |k: i32| {
            let middle = h * (f64::from(k) + 0.5);
            let side = rate(middle - place * h) + rate(middle + place * h);
            h * (4.0 / 9.0 * rate(middle) + 5.0 / 18.0 * side)
        };
        (0..pieces).map(of).sum()
    }
}

/// The four solutions with two derivatives; the growing ones are small at the start.
fn basis(k: f64, t: f64, time: f64) -> [[f64; 4]; 3] {
    let ((sin, cos), down, up) = ((k * t).sin_cos(), (-k * t).exp(), (k * (t - time)).exp());
    [
        [down * cos, down * sin, up * cos, up * sin],
        [-k * down * (cos + sin), k * down * (cos - sin), k * up * (cos - sin), k * up * (cos + sin)],
        [
            2.0 * k * k * down * sin,
            -2.0 * k * k * down * cos,
            -2.0 * k * k * up * sin,
            2.0 * k * k * up * cos,
        ],
    ]
}

const KNOTS: [f64; 3] = [-0.5, 0.37, 2.5];

fn of_joint() -> Reference {
    let rows = |k: usize| KNOTS.iter().map(|&t| vec![reference(t)[k]]).collect();
    JointReference::new(KNOTS.to_vec(), rows(0), vec![WEIGHT]).with_velocities(rows(1)).into()
}

fn of_tool() -> Reference {
    let rows = |k: usize, free: f64| KNOTS.iter().map(|&t| [reference(t)[k], free, free]).collect();
    let tool = Tool::new("joint:x").with_offset([0.0, 0.3, 0.0]);
    let reference = ToolReference::of(tool, KNOTS.to_vec());
    reference.with_positions(rows(0, f64::INFINITY), WEIGHT).with_velocities(rows(1, 0.0)).into()
}

fn problem(reference: Reference) -> Problem {
    Problem::rest_to_rest(sledge(), &START[..1], &END[..1], 1.0)
        .with_end(BoundaryState::fixed(&END[..1], &END[1..]))
        .with_limits(MotionLimits::none())
        .with_task(Task::default().with_reference(reference))
}

fn in_free_time(problem: Problem) -> Problem {
    problem.with_time(FinalTime::Free { guess: 0.7 }).with_cost(Objective::new(SECOND, vec![1.0]))
}

fn solve(problem: &Problem) -> Solution {
    let options = SolverOptions::default().with_polish(Polish::Never).with_tolerance(1e-9);
    let solution = Solver::new(problem, options).unwrap().solve();
    assert_eq!(solution.motion.status, Status::Converged);
    solution
}

fn close(found: f64, expected: f64, part: f64) {
    assert!((found - expected).abs() < part * expected.abs(), "{found} instead of {expected}");
}

/// dJ/dT without the cost of time, by central differences.
fn slope(time: f64) -> f64 {
    const STEP: f64 = 1e-4;
    (Exact::new(time + STEP).cost() - Exact::new(time - STEP).cost()) / (2.0 * STEP)
}

#[test]
fn a_mass_follows_a_cubic_at_the_exact_cost() {
    let exact = Exact::new(1.0);
    for reference in [of_joint(), of_tool()] {
        let solution = solve(&problem(reference));
        close(solution.total(), exact.cost(), 1e-8);
        for k in 0..=10 {
            let t = 0.1 * f64::from(k);
            let (point, [q, v, _]) = (solution.trajectory.at(t).unwrap(), exact.at(t));
            assert!((point.q[0] - q).abs() < 1e-5 && (point.v[0] - v).abs() < 1e-4, "{t}");
        }
        // H* changes with the clock; what is left is constant, and H* at the end.
        close(solution.motion.hamiltonian, -slope(1.0), 1e-3);
        assert!(solution.motion.hamiltonian_drift < 1e-3, "{}", solution.motion.hamiltonian_drift);
    }
}

#[test]
fn costs_of_jerks_do_not_disturb_the_hamiltonian() {
    // Continuous accelerations; the cost of jerks is next to nothing.
    let mut problem = problem(of_joint());
    problem.cost = problem.cost.with_jerk(vec![1e-9]);
    let options = SolverOptions::default().with_tolerance(1e-7);
    let solution = Solver::new(&problem, options).unwrap().solve();
    assert_eq!(solution.motion.status, Status::Converged);
    close(solution.total(), Exact::new(1.0).cost(), 1e-5);
    close(solution.motion.hamiltonian, -slope(1.0), 1e-2);
    assert!(solution.motion.hamiltonian_drift < 1e-2, "{}", solution.motion.hamiltonian_drift);
}

#[test]
fn a_free_final_time_is_where_the_exact_cost_is_least() {
    // The root of dJ/dT + c.
    let (mut low, mut high) = (0.5, 0.8);
    assert!(slope(low) + SECOND < 0.0 && slope(high) + SECOND > 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if slope(middle) + SECOND > 0.0 { high = middle } else { low = middle }
    }
    let expected = Exact::new(low).cost() + SECOND * low;
    for reference in [of_joint(), of_tool()] {
        let solution = solve(&in_free_time(problem(reference.clone())));
        close(solution.motion.final_time, low, 1e-5);
        close(solution.total(), expected, 1e-8);
        // A via where the motion passes anyway changes nothing, and is passed at the same time: the clock of
        // its second phase begins with the time of the first one.
        let passed = 0.45;
        let via = Via::at(&[Exact::new(low).at(passed)[0]]);
        let solution = solve(&in_free_time(problem(reference)).with_via(via));
        close(solution.trajectory.via_times[0], passed, 1e-4);
        close(solution.motion.final_time, low, 1e-5);
        close(solution.total(), expected, 1e-8);
    }
}

/// A link that turns about z.
fn wheel() -> Robot {
    let inertia = LinkInertia::point(1.0, [1.0, 0.0, 0.0]);
    let joint = JointSpec::revolute("turn").axis([0.0, 0.0, 1.0]).carrying(inertia);
    Robot::builder("wheel").joint(joint).build().unwrap()
}

#[test]
fn orientations_about_one_axis_are_angles() {
    let (times, angles) = (vec![0.0, 0.4, 1.0], [0.0, 1.0, 0.5]);
    // The mean of the slopes to both neighbours, weighed by the other interval.
    let middle = (0.6 * (1.0 / 0.4) + 0.4 * (-0.5 / 0.6)) / 1.0;
    let rows = |values: [f64; 3]| values.iter().map(|&value| vec![value]).collect::<Vec<_>>();
    let joint = JointReference::new(times.clone(), rows(angles), vec![500.0]);
    let turns = angles.map(|angle| Rotation3::from_euler_angles(0.0, 0.0, angle)).to_vec();
    let tool = ToolReference::of("joint:turn", times).with_orientations(turns, 500.0);
    let references: [Reference; 2] = [joint.with_velocities(rows([0.0, middle, 0.0])).into(), tool.into()];
    let costs = references.map(|reference| {
        let problem = Problem::rest_to_rest(wheel(), &[0.0], &[0.5], 1.0).with_limits(MotionLimits::none());
        solve(&problem.with_task(Task::default().with_reference(reference))).total()
    });
    close(costs[1], costs[0], 1e-9);
}

const TOP: &str = "robot = \"two_link.toml\"\n[start]\nq = [0, 0]\n[end]\nq = [1, 1]\n[time]\nfinal = 1\n\
                   [cost]\neffort = [1, 1]\n[[cost.reference]]\n";

fn read(lines: &str) -> Result<ProblemFile, String> {
    let file = ProblemFile::from_text(&format!("{TOP}{lines}"), "../robots", LoadOptions::default());
    file.map_err(|error| error.to_string())
}

#[test]
fn every_key_of_a_reference_reaches_the_problem() {
    let file = read(
        "times = [0, 0.5]\npositions = [[0, 1], [2, 3]]\nvelocities = [[4, 5], [6, 7]]\nweights = [1, 0]\n\
         [[cost.reference]]\nframe = \"elbow\"\noffset = [0, 0, 0.1]\ntimes = [1]\npositions = [[1, inf, 3]]\n\
         velocities = [[0.1, 0, 0]]\norientations = [[0, 0, 0.5]]\nposition_weight = 3\n\
         [[cost.reference]]\nframe = \"elbow\"\ntimes = [0]\norientations = [[0, 0, 0]]\norientation_weight = 4\n",
    );
    let turn = |angle| Rotation3::from_euler_angles(0.0, 0.0, angle);
    let rows = |rows: [[f64; 2]; 2]| rows.iter().map(|row| row.to_vec()).collect::<Vec<_>>();
    let joints = JointReference::new(vec![0.0, 0.5], rows([[0.0, 1.0], [2.0, 3.0]]), vec![1.0, 0.0])
        .with_velocities(rows([[4.0, 5.0], [6.0, 7.0]]));
    let tool = ToolReference::of(Tool::new("elbow").with_offset([0.0, 0.0, 0.1]), vec![1.0])
        .with_positions(vec![[1.0, f64::INFINITY, 3.0]], 3.0)
        .with_velocities(vec![[0.1, 0.0, 0.0]])
        .with_orientations(vec![turn(0.5)], 1.0);
    let mut other = ToolReference::of("elbow", vec![0.0]).with_orientations(vec![turn(0.0)], 4.0);
    other.position_weight = 1.0;
    let task = Task::default().with_reference(joints).with_reference(tool).with_reference(other);
    let found = file.unwrap().problem.task;
    // Rotations by their angles differ by rounding.
    for (found, expected) in found.references.iter().zip(&task.references) {
        match (found, expected) {
            (Reference::Tool(found), Reference::Tool(expected)) => {
                let plain = |tool: &ToolReference| {
                    let mut plain = tool.clone();
                    plain.orientations = None;
                    plain
                };
                assert_eq!(plain(found), plain(expected));
                let pairs = found.orientations.iter().flatten().zip(expected.orientations.iter().flatten());
                assert!(pairs.clone().count() == 1 && pairs.into_iter().all(|(a, b)| a.angle_to(b) < 1e-7));
            }
            (found, expected) => assert_eq!(found, expected),
        }
    }
    assert_eq!(found.references.len(), 3);
}

#[test]
fn wrong_references_are_refused_by_key() {
    let cases = [
        ("positions = [[0, 0]]\nweights = [1, 1]\n", "times"),
        ("times = []\npositions = []\nweights = [1, 1]\n", "cost.reference.times: needs 1 entries"),
        ("times = [0, 0]\npositions = [[0, 0], [1, 1]]\nweights = [1, 1]\n", "not later than 0 s"),
        ("times = [0]\npositions = [[0, 0], [1, 1]]\nweights = [1, 1]\n", "one for each time, but has 2"),
        ("times = [0]\npositions = [[0]]\nweights = [1, 1]\n", "one for each joint, but has 1"),
        ("times = [0]\npositions = [[0, nan]]\nweights = [1, 1]\n", "positions: must be finite"),
        ("times = [0]\npositions = [[0, 0]]\nweights = [1, -1]\n", "neither negative"),
        ("times = [0]\npositions = [[0, 0]]\nweights = [1, 1]\norientations = [[0, 0, 0]]\n", "orientations"),
        ("frame = \"elbow\"\ntimes = [0]\n", "nothing is asked"),
        (
            "frame = \"elbow\"\ntimes = [0]\nvelocities = [[0, 0, 0]]\norientations = [[0, 0, 0]]\n",
            "give positions",
        ),
        (
            "frame = \"elbow\"\ntimes = [0, 1]\npositions = [[0, inf, 0], [0, 0, 0]]\n",
            "positions: must be finite",
        ),
        (
            "frame = \"elbow\"\ntimes = [0, 1]\norientations = [[0, 0, 0], [0, 0, 3.14159265]]\n",
            "half a turn",
        ),
        ("frame = \"hand\"\ntimes = [0]\npositions = [[0, 0, 0]]\n", "no frame 'hand'"),
        ("frame = \"elbow\"\ntimes = [0]\npositions = [[0, 0, 0]]\nweights = [1]\n", "weights"),
    ];
    for (lines, expected) in cases {
        let message = read(lines).unwrap_err();
        assert!(message.contains(expected) && message.starts_with("problem:"), "{lines}: {message}");
    }
    // Not by the indirect methods.
    let text = "times = [0]\npositions = [[0, 0]]\nweights = [1, 1]\n[solver]\nmethod = \"collocation\"\n";
    assert!(read(text).unwrap_err().contains("direct"));
    let mut wrong = problem(of_joint());
    wrong.task.references.push(JointReference::new(vec![0.0], vec![vec![0.0; 2]], vec![1.0]).into());
    match wrong.check_for(costate_control::Method::Direct) {
        Err(ProblemError::Task { key, cause: TaskError::WrongCount { expected: 1, found: 2, .. } }) => {
            assert_eq!(key.to_string(), "cost.reference.positions");
        }
        other => panic!("{other:?}"),
    }
}
