//! Arms of the package `example-robot-data` (its licences stand beside the files; nothing of it is kept in
//! this project).

use crate::problems::{Failure, ROOT};
use costate::robot::{LoadOptions, Robot};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The package on the Python index.
const PACKAGE: &str = "example-robot-data==6.0.0";
/// Its folder of robots.
const FOLDER: &str = "cmeel.prefix/share/example-robot-data/robots";

/// An arm, and what its tasks need to know.
pub struct Arm {
    pub name: &'static str,
    file: &'static str,
    /// The frame of its tool, whose z axis leads away from the arm.
    pub tool: &'static str,
    /// Joints of its hand, which are locked at 0.
    pub locked: &'static [&'static str],
}

/// The arms of the bench: six and seven joints, with narrow and with wide ranges.
pub const ARMS: [Arm; 4] = [
    Arm { name: "UR5", file: "ur_description/urdf/ur5_robot.urdf", tool: "tool0", locked: &[] },
    Arm {
        name: "Panda",
        file: "panda_description/urdf/panda.urdf",
        tool: "panda_link8",
        locked: &["panda_finger_joint1"],
    },
    Arm { name: "xArm7", file: "xarm_description/urdf/xarm7.urdf", tool: "link_eef", locked: &[] },
    Arm { name: "Z1", file: "z1_description/urdf/z1.urdf", tool: "gripperStator", locked: &["jointGripper"] },
];

impl Arm {
    /// Its URDF.
    pub fn path(&self, folder: &Path) -> PathBuf {
        folder.join(self.file)
    }

    /// The robot with its hand locked.
    pub fn robot(&self, folder: &Path) -> Result<Robot, Failure> {
        let robot = Robot::from_file_with(self.path(folder), LoadOptions::default())?;
        let locked: Vec<(&str, f64)> = self.locked.iter().map(|joint| (*joint, 0.0)).collect();
        Ok(if locked.is_empty() { robot } else { robot.lock(&locked)? })
    }
}

/// The folder of the robots, downloaded into `target/arms` where it is missing.
pub fn folder() -> Result<PathBuf, Failure> {
    let target = PathBuf::from(ROOT).join("target/arms");
    let folder = target.join(FOLDER);
    if folder.is_dir() {
        return Ok(folder);
    }
    eprintln!("downloading {PACKAGE} (131 MB) into target/arms");
    std::fs::create_dir_all(&target)?;
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    run(&python, &["-m", "pip", "download", "--quiet", "--no-deps", PACKAGE, "--dest"], &target)?;
    let wheel = std::fs::read_dir(&target)?.filter_map(Result::ok).map(|entry| entry.path());
    let wheel = wheel.filter(|path| path.extension().is_some_and(|end| end == "whl")).max();
    let wheel = wheel.ok_or("pip has downloaded no wheel")?;
    run(&python, &["-m", "zipfile", "-e", &wheel.display().to_string()], &target)?;
    Ok(folder)
}

fn run(program: &str, arguments: &[&str], folder: &Path) -> Result<(), Failure> {
    let status = Command::new(program).args(arguments).arg(folder).status();
    let status = status.map_err(|error| format!("{program}: {error}; set PYTHON to a Python with pip"))?;
    if status.success() { Ok(()) } else { Err(format!("{program} {} failed", arguments.join(" ")).into()) }
}
