//! The lines of the results: one for each motion.

use crate::limits::Excess;
use serde::{Deserialize, Serialize};
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A motion and its verdict.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub seed: u64,
    pub number: usize,
    pub kind: String,
    /// Parts of the problem beside its kind.
    pub parts: Vec<String>,
    pub joints: usize,
    /// "refused" where the problem cannot be posed.
    pub status: String,
    pub message: String,
    pub cost: Option<f64>,
    /// Estimated error as the solution states it; where it states none, the tolerance. Relative.
    pub stated_error: Option<f64>,
    pub tolerance: f64,
    pub final_time: Option<f64>,
    pub intervals: usize,
    pub polished: bool,
    /// By this study, with the torques that the motion needs and with those that the solution gives.
    pub own_cost: Option<f64>,
    pub own_cost_cut: Option<f64>,
    /// Sum of the magnitudes of the parts of the cost: errors are relative to it.
    pub size: Option<f64>,
    /// |own cost - cost| / size, the smaller one of both.
    pub cost_off: Option<f64>,
    /// The finer mesh: "crossings" or the number of parts, its intervals, how it ended, its own cost.
    pub finer: Option<String>,
    pub finer_intervals: usize,
    pub finer_status: Option<String>,
    pub finer_cost: Option<f64>,
    /// (own cost - cost on the finer mesh) / size, if that motion keeps its limits and ends.
    pub cheaper: Option<f64>,
    /// The cost of a known motion of this problem.
    #[serde(default)]
    pub known_cost: Option<f64>,
    pub excesses: Vec<Excess>,
    /// What was not judged, and why.
    pub not_judged: Vec<String>,
    /// Of a converged motion: "wrong cost", "cheaper found" (on the finer mesh), "cheaper known", "limits
    /// broken".
    pub faults: Vec<String>,
    pub milliseconds: f64,
    pub judge_milliseconds: f64,
}

impl Record {
    pub fn is_converged(&self) -> bool {
        self.status == "converged"
    }

    pub fn has(&self, fault: &str) -> bool {
        self.faults.iter().any(|found| found == fault)
    }
}

/// The lines of a file.
pub struct Results {
    pub records: Vec<Record>,
    path: PathBuf,
}

impl Results {
    /// Reads what is there; no file is an empty one.
    pub fn open(path: &Path) -> Result<Self, String> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(format!("{}: {error}", path.display())),
        };
        let read = |(number, line): (usize, &str)| {
            serde_json::from_str(line).map_err(|error| format!("{}:{}: {error}", path.display(), number + 1))
        };
        Ok(Self { records: text.lines().enumerate().map(read).collect::<Result<_, _>>()?, path: path.into() })
    }

    /// Whether this motion was judged already.
    pub fn hold(&self, seed: u64, number: usize) -> bool {
        self.records.iter().any(|record| (record.seed, record.number) == (seed, number))
    }

    /// Appends a line.
    pub fn add(&mut self, record: Record) -> io::Result<()> {
        if let Some(folder) = self.path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        let mut file = OpenOptions::new().create(true).append(true).open(&self.path)?;
        writeln!(file, "{}", serde_json::to_string(&record)?)?;
        self.records.push(record);
        Ok(())
    }
}
