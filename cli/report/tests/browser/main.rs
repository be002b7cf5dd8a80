//! The page in headless Chromium: buttons, keys, plots and pictures work, and the console stays empty.
//!
//! Without Chromium these tests are skipped; `CHROME` names one that is not found.

#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod chromium;
mod plots;
mod stage;

use chromium::Page;
use costate::robot::LoadOptions;
use costate_control::{Problem, ProblemFile, Solution, Solver};
use costate_report::{ReportOptions, models, report};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};

/// A solved problem and its page.
struct Case {
    problem: Problem,
    solution: Solution,
    file: PathBuf,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

impl Case {
    /// A problem of the examples.
    fn of(name: &str) -> Self {
        let read =
            ProblemFile::read(root().join(format!("examples/problems/{name}.toml")), LoadOptions::default());
        let ProblemFile { problem, options, text, robot_path, .. } = read.unwrap();
        let solution = Solver::new(&problem, options).unwrap().solve();
        let robot_path = robot_path.unwrap();
        let models = match robot_path.extension() {
            Some(extension) if extension == "urdf" => {
                let urdf = std::fs::read_to_string(&robot_path).unwrap();
                models::of_urdf(&urdf, robot_path.parent().unwrap(), &[]).unwrap().links
            }
            _ => Vec::new(),
        };
        let options = ReportOptions::default().with_source(text).with_models(models);
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pages");
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join(format!("{name}.html"));
        std::fs::write(&file, report(&problem, &solution, &options)).unwrap();
        Self { problem, solution, file }
    }

    /// A motion in four phases with a payload.
    fn phases() -> &'static Self {
        static CASE: OnceLock<Case> = OnceLock::new();
        CASE.get_or_init(|| Self::of("ur5_pick_and_place"))
    }
}

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
