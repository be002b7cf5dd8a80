//! Bodies of payloads: files, notes, and motions that keep them away from obstacles while they are carried.

use costate::robot::{LoadOptions, Placement};
use costate_control::{
    Payload, ProblemFile, ProblemWarning, Shape, Solution, Solver, SolverOptions, Status, Trajectory,
};

/// A two-link arm that passes a via, and a post beside the way of its tip.
const TOP: &str = "robot = \"two_link.toml\"\n[start]\nq = [0.0, 0.4]\n[end]\nq = [1.6, 0.4]\n[time]\nfinal = 2\n\
                   [cost]\neffort = 1\n[limits]\nfrom_robot = false\n";
const POST: &str =
    "[[obstacle]]\nkind = \"sphere\"\nname = \"post\"\nxyz = [1.45, 1.35, 0.0]\nradius = 0.05\n";
const LOAD: &str = "frame = \"joint:elbow\"\nmass = 0.1\ncom = [1.0, 0.0, 0.0]\n";
const BALL: &str = "shape = { kind = \"sphere\", radius = 0.2 }\n";

fn read(lines: &str) -> Result<ProblemFile, String> {
    let text = format!("{TOP}{lines}");
    ProblemFile::from_text(&text, "../robots", LoadOptions::default()).map_err(|error| error.to_string())
}

fn solve(file: &ProblemFile) -> Solution {
    let solution = Solver::new(&file.problem, SolverOptions::default().with_tolerance(1e-4)).unwrap().solve();
    assert_eq!(solution.motion.status, Status::Converged, "{}", solution.motion.status);
    solution
}

/// Least distance of the tip from the middle of the post, between two times (s).
fn nearest(trajectory: &Trajectory, solution: &Solution, file: &ProblemFile, [from, to]: [f64; 2]) -> f64 {
    let times: Vec<f64> = (0..=400).map(|k| from + (to - from) * f64::from(k) / 400.0).collect();
    let samples = solution.sample_at(&file.problem, &times).unwrap();
    assert!(trajectory.t.len() > 1);
    let tip = |q: &Vec<f64>| {
        let (a, b) = (q[0], q[0] + q[1]);
        [a.cos() + b.cos(), a.sin() + b.sin()]
    };
    samples.q.iter().map(tip).map(|x| (x[0] - 1.45).hypot(x[1] - 1.35)).fold(f64::INFINITY, f64::min)
}

#[test]
fn shapes_reach_the_problem() {
    let loads = format!(
        "[[via]]\nq = [0.8, 0.4]\n[[via.payload]]\n{LOAD}shape = {{ kind = \"box\", size = [0.1, 0.2, 0.3], rpy = [0, 0, 0.5] }}\n\
         [[via.payload]]\nframe = \"joint:elbow\"\nmass = 1\nshape = {{ kind = \"capsule\", from = [0, 0, 0], to = [1, 0, 0], radius = 0.1 }}\n"
    );
    let file = read(&loads).unwrap();
    let carried = file.problem.vias[0].payload.as_ref().unwrap();
    let placement = Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.0, 0.0, 0.5]);
    assert_eq!(carried[0].shape, Some(Shape::Box { placement, size: [0.1, 0.2, 0.3] }));
    let capsule = Shape::Capsule { from: [0.0; 3], to: [1.0, 0.0, 0.0], radius: 0.1 };
    assert_eq!(carried[1].shape, Some(capsule));
    assert_eq!(carried[0].name(), "payload of joint:elbow");
    for (shape, expected) in [
        ("shape = { kind = \"half_space\", normal = [0, 0, 1] }", "unknown"),
        ("shape = { kind = \"sphere\" }", "radius: missing"),
        ("shape = { kind = \"sphere\", radius = 0 }", "must be positive"),
        ("shape = { kind = \"box\", size = [1, 1, -1] }", "must be positive"),
        ("shape = { kind = \"box\", size = [1, 1, 1], radius = 1 }", "unknown key"),
    ] {
        let lines = format!("{POST}[[via]]\nq = [0.8, 0.4]\n[[via.payload]]\n{LOAD}{shape}\n");
        let error = read(&lines).unwrap_err();
        assert!(error.contains(expected), "{shape}: {error}");
    }
}

#[test]
fn payloads_without_bodies_are_noted_where_bodies_count() {
    let bare = |lines: &str| {
        let file = read(lines).unwrap();
        let found: Vec<String> = file.problem.warnings().iter().map(ToString::to_string).collect();
        let is_bare = |warning: &ProblemWarning| matches!(warning, ProblemWarning::PayloadWithoutBody { .. });
        let count = file.problem.warnings().iter().filter(|warning| is_bare(warning)).count();
        (count, found)
    };
    let via = format!("[[via]]\nq = [0.8, 0.4]\n[[via.payload]]\n{LOAD}");
    let bodies = "[collision]\ncapsules = \"auto\"\nradius = 0.02\n";
    assert_eq!(bare(&via).0, 0, "nothing is avoided");
    let (count, found) = bare(&format!("{POST}{bodies}{via}"));
    assert!(count == 1 && found[0].contains("has no body and is not checked for collisions"), "{found:?}");
    assert_eq!(bare(&format!("{POST}{via}{BALL}")).0, 0);
    let robot =
        TOP.replace("robot = \"two_link.toml\"\n", "[robot]\nfile = \"two_link.toml\"\n[[robot.payload]]\n");
    let text = robot.replace("[start]", &format!("{LOAD}[start]")) + POST + bodies;
    let file = ProblemFile::from_text(&text, "../robots", LoadOptions::default()).unwrap();
    assert_eq!(file.problem.warnings().len(), 1, "{:?}", file.problem.warnings());
}

/// The ball at the tip passes the post in the phase in which it is carried, and the same motion without it
/// does not care.
#[test]
fn carried_bodies_keep_away_from_obstacles_while_they_are_carried() {
    let with = |first: &str, second: &str| {
        read(&format!(
            "{POST}[[via]]\nq = [0.35, 0.4]\ntime = 0.6\n{first}[[via]]\nq = [1.2, 0.4]\ntime = 1.4\n{second}"
        ))
        .unwrap()
    };
    let takes = format!("[[via.payload]]\n{LOAD}{BALL}");
    let carried = with(&takes, "payload = []\n");
    let found = solve(&carried);
    let close = nearest(&found.trajectory, &found, &carried, [0.6, 1.4]);
    assert!(close > 0.25 - 1e-5, "{close}");
    // Taken up behind the post it is in nobody's way.
    let later = with("", &takes);
    let free = solve(&later);
    let close = nearest(&free.trajectory, &free, &later, [0.6, 1.4]);
    assert!(close < 0.2, "{close}");
    assert!(free.verified.as_ref().is_some_and(|verified| verified.limits.passes()), "{:?}", free.verified);
    assert!(found.total() > free.total() * 1.01, "{} {}", found.total(), free.total());
    // A box whose capsules contain a ball of that size keeps at least as far away.
    let cube = "shape = { kind = \"box\", size = [0.4, 0.4, 0.4] }\n";
    let boxed = with(&takes.replace(BALL, cube), "payload = []\n");
    let boxed_motion = solve(&boxed);
    assert!(nearest(&boxed_motion.trajectory, &boxed_motion, &boxed, [0.6, 1.4]) > 0.25 - 1e-5);
}

/// An exception by the names of both bodies.
#[test]
fn payloads_may_touch_what_is_excepted() {
    let lines = format!(
        "{POST}[collision]\nexcept = [[\"payload of joint:elbow\", \"post\"]]\ncapsules = \"auto\"\nradius = 0.02\n\
         [[via]]\nq = [0.35, 0.4]\ntime = 0.6\n[[via.payload]]\n{LOAD}{BALL}[[via]]\nq = [1.2, 0.4]\ntime = 1.4\n"
    );
    let file = read(&lines).unwrap();
    let solution = solve(&file);
    assert!(nearest(&solution.trajectory, &solution, &file, [0.6, 1.4]) < 0.25);
    let wrong = read(&lines.replace("payload of joint", "payload of jint")).unwrap_err();
    assert!(wrong.contains("'payload of joint:elbow'"), "{wrong}");
    let _ = Payload::point("joint:elbow", 1.0, [0.0; 3])
        .with_shape(Shape::Sphere { centre: [0.0; 3], radius: 0.1 });
}
