//! A problem as the text of its files.

use costate::lagrangian::Lagrangian;
use costate::robot::Robot;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};

/// Where the robot comes from.
pub enum RobotFile {
    /// The text of a robot in TOML.
    Text(String),
    /// A file of the folder `robots`, or of `examples/problems/robots`, copied beside the problem.
    Real(&'static str),
}

/// A problem that is being drawn.
pub struct Case {
    /// What it has beside its kind, for the table of faults.
    pub parts: Vec<String>,
    pub robot: Robot,
    pub file: RobotFile,
    /// `[robot.armature]` and `[robot.friction]` of a real robot.
    pub edits: String,
    /// Start and end of the plain motion, n each, and its time.
    pub from: Vec<f64>,
    pub to: Vec<f64>,
    pub time: f64,
    tables: BTreeMap<&'static str, Vec<(String, String)>>,
    /// Arrays of tables, as text.
    pub tail: String,
    /// A cost that a known motion has: the best one costs no more.
    pub known: Option<f64>,
}

/// The largest magnitudes along the quintic from rest to rest: n each, of the power one.
pub struct Peaks {
    pub v: Vec<f64>,
    pub a: Vec<f64>,
    pub jerk: Vec<f64>,
    pub torque: Vec<f64>,
    pub torque_rate: Vec<f64>,
    pub power: Vec<f64>,
    pub total_power: f64,
}

impl Case {
    pub fn new(robot: Robot, file: RobotFile, from: Vec<f64>, to: Vec<f64>, time: f64) -> Self {
        let mut case = Self {
            parts: Vec::new(),
            robot,
            file,
            edits: String::new(),
            from,
            to,
            time,
            tables: BTreeMap::new(),
            tail: String::new(),
            known: None,
        };
        let (from, to) = (list(&case.from), list(&case.to));
        case.set("start", "q", from);
        case.set("end", "q", to);
        case.set("time", "final", format!("{time:?}"));
        case
    }

    pub fn dof(&self) -> usize {
        self.robot.dof()
    }

    pub fn joints(&self) -> Vec<String> {
        self.robot.independent_joints().map(|joint| joint.name.clone()).collect()
    }

    /// Sets a key of a table, in place of what it was.
    pub fn set(&mut self, table: &'static str, key: &str, value: impl Into<String>) {
        let rows = self.tables.entry(table).or_default();
        rows.retain(|(found, _)| found != key);
        rows.push((key.into(), value.into()));
    }

    pub fn unset(&mut self, table: &'static str, key: &str) {
        if let Some(rows) = self.tables.get_mut(table) {
            rows.retain(|(found, _)| found != key);
        }
    }

    pub fn has(&self, table: &'static str, key: &str) -> bool {
        self.tables.get(table).is_some_and(|rows| rows.iter().any(|(found, _)| found == key))
    }

    pub fn part(&mut self, part: impl Into<String>) {
        self.parts.push(part.into());
    }

    /// Position at a time of the quintic `10 x^3 - 15 x^4 + 6 x^5` from start to end.
    pub fn position(&self, part: f64) -> Vec<f64> {
        let x = part;
        let s = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
        self.from.iter().zip(&self.to).map(|(a, b)| a + s * (b - a)).collect()
    }

    /// Largest values along that quintic, dry friction left out of the rates of torques.
    pub fn peaks(&self) -> Result<Peaks, String> {
        let n = self.dof();
        let (mut model, mut smooth) =
            (Lagrangian::<f64>::new(&self.robot), Lagrangian::<f64>::new(&self.robot.without_friction()));
        let zeros = || vec![0.0_f64; n];
        let mut peaks = Peaks {
            v: zeros(),
            a: zeros(),
            jerk: zeros(),
            torque: zeros(),
            torque_rate: zeros(),
            power: zeros(),
            total_power: 0.0,
        };
        let steps = 400;
        let mut before: Option<Vec<f64>> = None;
        let dt = self.time / steps as f64;
        for k in 0..=steps {
            let x = k as f64 / steps as f64;
            let q = self.position(x);
            let rate = 30.0 * x * x * (1.0 - x) * (1.0 - x) / self.time;
            let acceleration = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / self.time.powi(2);
            let jerk = 60.0 * (1.0 - 6.0 * x + 6.0 * x * x) / self.time.powi(3);
            let of =
                |s: f64| -> Vec<f64> { self.from.iter().zip(&self.to).map(|(a, b)| s * (b - a)).collect() };
            let (v, a, j) = (of(rate), of(acceleration), of(jerk));
            let tau = model.inverse_dynamics(&q, &v, &a).map_err(|error| error.to_string())?.to_vec();
            let plain = smooth.inverse_dynamics(&q, &v, &a).map_err(|error| error.to_string())?.to_vec();
            let most = |to: &mut f64, x: f64| *to = to.max(x.abs());
            for i in 0..n {
                most(&mut peaks.v[i], v[i]);
                most(&mut peaks.a[i], a[i]);
                most(&mut peaks.jerk[i], j[i]);
                most(&mut peaks.torque[i], tau[i]);
                most(&mut peaks.power[i], tau[i] * v[i]);
                if let Some(before) = &before {
                    most(&mut peaks.torque_rate[i], (plain[i] - before[i]) / dt);
                }
            }
            most(&mut peaks.total_power, tau.iter().zip(&v).map(|(tau, v)| tau * v).sum());
            before = Some(plain);
        }
        Ok(peaks)
    }

    fn problem(&self, robot: &str) -> String {
        let mut text = match self.edits.is_empty() {
            true => format!("robot = \"{robot}\"\n"),
            false => format!("[robot]\nfile = \"{robot}\"\n{}", self.edits),
        };
        for name in ["start", "end", "time", "cost", "limits", "actuation", "penalty", "gait", "periodic"] {
            let Some(rows) = self.tables.get(name).filter(|rows| !rows.is_empty()) else { continue };
            let _ = writeln!(text, "[{name}]");
            for (key, value) in rows {
                let _ = writeln!(text, "{key} = {value}");
            }
        }
        text.push_str(&self.tail);
        text
    }

    /// Writes the problem and its robot into a folder; the problem is the first file.
    pub fn write(&self, folder: &Path, name: &str) -> io::Result<Vec<PathBuf>> {
        let robot = match &self.file {
            RobotFile::Text(_) => format!("{name}.robot.toml"),
            RobotFile::Real(file) => file.rsplit('/').next().unwrap_or(file).to_string(),
        };
        let (problem, beside) = (folder.join(format!("{name}.toml")), folder.join(&robot));
        std::fs::write(&problem, self.problem(&robot))?;
        match &self.file {
            RobotFile::Text(text) => std::fs::write(&beside, text)?,
            RobotFile::Real(file) => {
                if !beside.exists() {
                    std::fs::copy(Path::new(crate::folder::FOLDER).join("../..").join(file), &beside)?;
                }
            }
        }
        Ok(vec![problem, beside])
    }
}

/// A list of numbers in TOML, with all their digits.
pub fn list(numbers: &[f64]) -> String {
    format!("[{}]", numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", "))
}

/// A list of lists.
pub fn lists(rows: &[Vec<f64>]) -> String {
    format!("[{}]", rows.iter().map(|row| list(row)).collect::<Vec<_>>().join(", "))
}

/// A list of strings.
pub fn names(names: &[String]) -> String {
    format!("[{}]", names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", "))
}
