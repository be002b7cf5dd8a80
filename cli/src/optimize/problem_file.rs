//! From a problem file to a problem; what is wrong is said with file, line and key.

use super::lines::{key_at, line_at, line_of};
use super::tables::{EndTable, JointName, ProblemFile, SolverTable, StartFromTable, TimeTable};
use costate::robot::{LoadOptions, Robot};
use costate_control::{Bounds, Cost, End, Options, Penalty, Problem, Start, Time, Trajectory};
use std::path::Path;

/// What a problem file asks for.
pub struct Task {
    pub problem: Problem,
    pub options: Options,
    pub start_from: Option<Trajectory>,
    /// The file itself.
    pub text: String,
}

/// The key at fault: every message about one begins with it.
fn key(message: &str) -> &str {
    let ends = |c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '.');
    message.split(ends).next().unwrap_or_default()
}

impl Task {
    /// Reads a problem file and what it refers to.
    pub fn read(path: &Path, load: LoadOptions) -> Result<Self, String> {
        let unreadable = |error| format!("{}: cannot be read ({error}); check the path", path.display());
        let text = std::fs::read_to_string(path).map_err(unreadable)?;
        let place = |line: Option<usize>| line.map_or(String::new(), |line| format!(":{line}"));
        let at = |line, message: &str| format!("{}{}: {message}", path.display(), place(line));
        let file: ProblemFile = toml::from_str(&text).map_err(|error| {
            let line = error.span().map(|span| line_at(&text, span.start));
            // What is missing at the top has the place of the first key.
            let of_table =
                |start: usize| start > 0 && matches!(text.as_bytes().get(start), Some(b'[' | b'{'));
            let missing = error.message().starts_with("missing field");
            let span = error.span().filter(|span| !missing || of_table(span.start));
            let key = span.and_then(|span| key_at(&text, &span));
            let key = key.map_or(String::new(), |key| format!("{key}: "));
            let remedy = if missing { "; add it" } else { "" };
            at(line, &format!("{key}{}{remedy}", error.message().trim_end()))
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let read = || -> Result<_, String> {
            let robot = Robot::from_file_with(folder.join(&file.robot), load);
            let problem = problem(&file, robot.map_err(|error| format!("robot: {error}"))?)?;
            problem.check().map_err(|error| error.to_string())?;
            let options = options(&file.solver);
            options.check().map_err(|error| error.to_string())?;
            let saved = |table: &StartFromTable| read_start(&folder.join(&table.file), &problem.robot);
            let start_from = file.start_from.as_ref().map(saved).transpose();
            Ok((start_from.map_err(|error| format!("start_from.file: {error}"))?, problem, options))
        };
        let (start_from, problem, options) =
            read().map_err(|message| at(line_of(&text, key(&message)), &message))?;
        Ok(Self { problem, options, start_from, text })
    }
}

fn read_start(path: &Path, robot: &Robot) -> Result<Trajectory, String> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| format!("{}: cannot be read ({error}); check the path", path.display()))?;
    Trajectory::from_json(&text, robot).map_err(|error| {
        format!("{}: {error}; give a file that `costate optimize --save` wrote", path.display())
    })
}

fn problem(file: &ProblemFile, robot: Robot) -> Result<Problem, String> {
    let n = robot.len();
    let or = |list: &Option<Vec<f64>>, value: f64| list.clone().unwrap_or_else(|| vec![value; n]);
    let EndTable { q, v, q_free, v_free } = &file.start;
    let start = Start {
        q: q.clone(),
        v: or(v, 0.0),
        q_free: joints(&robot, "start.q_free", q_free)?,
        v_free: joints(&robot, "start.v_free", v_free)?,
    };
    let EndTable { q, v, q_free, v_free } = &file.end;
    let end = End {
        q: q.clone(),
        v: or(v, 0.0),
        q_free: joints(&robot, "end.q_free", q_free)?,
        v_free: joints(&robot, "end.v_free", v_free)?,
    };
    let bounds = file.bounds.as_ref();
    let penalty = file.penalty.as_ref();
    Ok(Problem {
        start,
        end,
        time: time(&file.time)?,
        cost: Cost { time: file.cost.time, effort: or(&file.cost.effort, 0.0) },
        terms: Vec::new(),
        gain: or(&file.actuation.gain, 1.0),
        bounds: bounds.map(|table| Bounds { u_min: table.u_min.clone(), u_max: table.u_max.clone() }),
        penalty: penalty.map(|table| Penalty {
            weight: table.weight,
            q_min: table.q_min.clone(),
            q_max: table.q_max.clone(),
            v_max: table.v_max.clone(),
        }),
        robot,
    })
}

fn time(table: &TimeTable) -> Result<Time, &'static str> {
    match *table {
        TimeTable { last: Some(_), free: true, .. } => {
            Err("time.final stands beside `free = true`; keep one of the two")
        }
        TimeTable { last: Some(_), guess: Some(_), .. } => {
            Err("time.guess goes with `free = true`; remove it or time.final")
        }
        TimeTable { last: Some(last), .. } => Ok(Time::Fixed(last)),
        TimeTable { free: true, guess: Some(guess), .. } => Ok(Time::Free { guess }),
        TimeTable { free: true, .. } => {
            Err("time.guess is missing; with `free = true` it says where to begin, in s")
        }
        _ => Err("time.final is missing; give it in s, or `free = true` and `guess`"),
    }
}

fn joints(robot: &Robot, key: &str, names: &[JointName]) -> Result<Vec<usize>, String> {
    let place = |name: &JointName| match name {
        JointName::Place(place) => Ok(*place),
        JointName::Name(name) => {
            let place = robot.joints().iter().position(|joint| joint.name == *name);
            let known =
                || robot.joints().iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>().join(", ");
            place.ok_or_else(|| {
                format!("{key} names joint '{name}', which does not exist; there are {}", known())
            })
        }
    };
    let mut places: Vec<usize> = names.iter().map(place).collect::<Result<_, _>>()?;
    places.sort_unstable();
    places.dedup();
    Ok(places)
}

fn options(table: &SolverTable) -> Options {
    let defaults = Options::default();
    Options {
        tolerance: table.tolerance.unwrap_or(defaults.tolerance),
        nodes: table.nodes.unwrap_or(defaults.nodes),
        starts: table.starts.unwrap_or(defaults.starts),
        seed: table.seed.unwrap_or(defaults.seed),
        jacobian: table.jacobian.unwrap_or(defaults.jacobian),
        method: table.method.unwrap_or(defaults.method),
        coordinates: table.coordinates.unwrap_or(defaults.coordinates),
        ..defaults
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate_control::{Coordinates, Jacobian, Method};

    /// Reads this text, followed by the two-link arm of the repository.
    fn read(name: &str, text: &str) -> Task {
        let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../robots/two_link.toml");
        let file = std::env::temp_dir().join(format!("costate_problem_{}_{name}.toml", std::process::id()));
        std::fs::write(&file, format!("robot = {robots:?}\n{text}")).unwrap();
        let task = Task::read(&file, LoadOptions::default());
        std::fs::remove_file(&file).unwrap();
        task.unwrap()
    }

    #[test]
    fn every_key_reaches_the_problem() {
        let Task { problem, options, start_from, .. } = read(
            "all",
            "[start]\nq = [0, 0.1]\nv = [0.2, 0.3]\nq_free = [1]\nv_free = [\"elbow\", 0]\n\
             [end]\nq = [1, 1.1]\nv = [1.2, 1.3]\nq_free = [\"elbow\", 1, 0]\nv_free = [\"shoulder\"]\n\
             [time]\nfree = true\nguess = 2\n\
             [cost]\ntime = 3\neffort = [2, 0]\n\
             [actuation]\ngain = [5, -6]\n\
             [bounds]\nu_min = [-inf, -8]\nu_max = [7.5, 8.5]\n\
             [penalty]\nweight = 9\nq_min = [-10, -11]\nq_max = [10, 11]\nv_max = [12, 13]\n\
             [solver]\nstarts = 14\nseed = 15\ntolerance = 1e-6\nnodes = 17\njacobian = \"without_hessian\"\nmethod = \"shooting\"\n\
             coordinates = \"lagrangian\"\n",
        );
        let (q, v) = (vec![0.0, 0.1], vec![0.2, 0.3]);
        assert_eq!(problem.start, Start { q, v, q_free: vec![1], v_free: vec![0, 1] });
        let (q, v) = (vec![1.0, 1.1], vec![1.2, 1.3]);
        assert_eq!(problem.end, End { q, v, q_free: vec![0, 1], v_free: vec![0] });
        assert_eq!(problem.time, Time::Free { guess: 2.0 });
        assert_eq!(problem.cost, Cost { time: 3.0, effort: vec![2.0, 0.0] });
        assert_eq!(problem.gain, [5.0, -6.0]);
        let bounds = Bounds { u_min: vec![f64::NEG_INFINITY, -8.0], u_max: vec![7.5, 8.5] };
        assert_eq!(problem.bounds, Some(bounds));
        let limits = |a: f64, b: f64| Some(vec![a, b]);
        let (q_min, q_max, v_max) = (limits(-10.0, -11.0), limits(10.0, 11.0), limits(12.0, 13.0));
        assert_eq!(problem.penalty, Some(Penalty { weight: 9.0, q_min, q_max, v_max }));
        assert_eq!((options.starts, options.seed, options.tolerance, options.nodes), (14, 15, 1e-6, 17));
        assert_eq!((options.jacobian, options.method), (Jacobian::WithoutHessian, Method::Shooting));
        assert_eq!(options.coordinates, Coordinates::Lagrangian);
        assert!(start_from.is_none());
    }

    #[test]
    fn what_is_left_out_has_the_values_that_the_documents_say() {
        let text = "[start]\nq = [0, 0]\n[end]\nq = [1, 1]\n[time]\nfinal = 2\n[cost]\neffort = [1, 1]\n";
        let Task { problem, options, .. } = read("least", text);
        assert_eq!((problem.start.v, problem.end.v), (vec![0.0; 2], vec![0.0; 2]));
        assert_eq!((problem.end.q_free.len(), problem.end.v_free.len()), (0, 0));
        assert_eq!((problem.start.q_free.len(), problem.start.v_free.len()), (0, 0));
        assert_eq!((problem.time, problem.cost.time, problem.gain), (Time::Fixed(2.0), 0.0, vec![1.0; 2]));
        assert!(problem.bounds.is_none() && problem.penalty.is_none());
        assert_eq!(options, Options::default());
    }
}
