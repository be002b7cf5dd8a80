//! The page in headless Chromium: buttons, keys, plots and pictures work, and the console stays empty.
//!
//! Without Chromium these tests are skipped; `CHROME` names one that is not found.

#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod chromium;
mod pages;
mod plots;
mod stage;

use chromium::Page;
use costate::robot::LoadOptions;
use costate_control::{Problem, ProblemFile, Solution, Solver};
use costate_report::models::{self, LinkModel};
use costate_report::{ReportOptions, report};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};

/// A solved problem and its page.
struct Case {
    problem: Problem,
    solution: Solution,
    models: Vec<LinkModel>,
    file: PathBuf,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

impl Case {
    /// A problem of the examples.
    fn of(name: &str) -> Self {
        let path = root().join(format!("examples/problems/{name}.toml"));
        Self::solved(name, ProblemFile::read(path, LoadOptions::default()).unwrap())
    }

    /// The problem of a text, whose paths begin in the root of the repository.
    fn of_text(name: &str, text: &str) -> Self {
        Self::solved(name, ProblemFile::from_text(text, root(), LoadOptions::default()).unwrap())
    }

    fn solved(name: &str, file: ProblemFile) -> Self {
        let ProblemFile { problem, options, text, robot_path, .. } = file;
        let solution = Solver::new(&problem, options).unwrap().solve();
        let robot_path = robot_path.unwrap();
        let models = match robot_path.extension() {
            Some(extension) if extension == "urdf" => {
                let urdf = std::fs::read_to_string(&robot_path).unwrap();
                models::of_urdf(&urdf, robot_path.parent().unwrap(), &[]).unwrap().links
            }
            _ => Vec::new(),
        };
        let options = ReportOptions::default().with_source(text).with_models(models.clone());
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pages");
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join(format!("{name}.html"));
        std::fs::write(&file, report(&problem, &solution, &options)).unwrap();
        Self { problem, solution, models, file }
    }

    /// A motion in four phases with a payload.
    fn phases() -> &'static Self {
        static CASE: OnceLock<Case> = OnceLock::new();
        CASE.get_or_init(|| Self::of("ur5_pick_and_place"))
    }

    /// A UR5 that moves faster than its limits allow, which it was not asked to keep: u has
    /// bounds, if infinite ones.
    fn hasty() -> &'static Self {
        static CASE: OnceLock<Case> = OnceLock::new();
        CASE.get_or_init(|| Self::of_text("hasty", HASTY))
    }

    /// A UR5 whose tool goes round a ball.
    fn around() -> &'static Self {
        static CASE: OnceLock<Case> = OnceLock::new();
        CASE.get_or_init(|| Self::of_text("around", AROUND))
    }
}

const HASTY: &str = r#"
robot = "robots/ur5.urdf"
[start]
q = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0]
[end]
q = [2.0, -1.0, 1.2, -1.5, -1.57, 0.5]
[time]
final = 0.6
[cost]
effort = [4.4e-5, 4.4e-5, 4.4e-5, 1.3e-3, 1.3e-3, 1.3e-3]
[bounds]
u_min = [-inf, -inf, -inf, -inf, -inf, -inf]
u_max = [inf, inf, inf, inf, inf, inf]
"#;

const AROUND: &str = r#"
robot = "robots/ur5.urdf"
[start]
q = [0.0, -1.2, 1.6, -1.9, -1.57, 0.0]
[end]
q = [1.5, -1.2, 1.6, -1.9, -1.57, 0.0]
[time]
final = 1.2
[cost]
effort = [4.4e-5, 4.4e-5, 4.4e-5, 1.3e-3, 1.3e-3, 1.3e-3]
[limits]
from_robot = true
[[obstacle]]
name = "ball"
kind = "sphere"
xyz = [-0.35, -0.5, 0.35]
radius = 0.08
[[collision.capsule]]
frame = "tool0"
from = [0.0, 0.0, -0.05]
to = [0.0, 0.0, 0.0]
radius = 0.04
"#;

/// One browser at a time: each of them draws with all cores.
static ONE: Mutex<()> = Mutex::new(());

/// Opens the browser for a test; `None` where there is none.
fn browser(test: &str) -> Option<Page> {
    let Some(browser) = chromium::find() else {
        // Not by a macro, whose words the runner of tests would keep to itself.
        let _ = writeln!(std::io::stderr(), "skipped: no Chromium; CHROME=/path/to/chromium names one");
        return None;
    };
    let profile = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("profile-{test}"));
    let _ = std::fs::remove_dir_all(&profile);
    let alone = ONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    Some(Page::open(&browser, &profile, alone))
}

/// Fails if the page complained.
fn assert_silent(page: &Page) {
    assert!(page.complaints.is_empty(), "{:#?}", page.complaints);
}
