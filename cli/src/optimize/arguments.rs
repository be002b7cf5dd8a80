//! The arguments of `costate optimize`.

use super::continuation::ParameterRange;
use super::samples::rate;
use crate::arguments::{count, positive};
use clap::{ValueEnum, ValueHint};
use costate_control::{Polish, Verify};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

#[derive(clap::Args)]
pub struct Arguments {
    /// Problem file (.toml)
    #[arg(value_hint = ValueHint::FilePath)]
    pub problem: PathBuf,
    /// Print the solution as one JSON object instead of a table
    #[arg(long)]
    pub json: bool,
    /// Write the report, a single HTML file
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
    /// Folder in which packages lie, or of a package, for meshes package://NAME/PATH of a URDF in the report;
    /// may be given several times
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub package_path: Vec<PathBuf>,
    /// Write the figures of the report as SVG files; figures of an earlier run are removed
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub svg: Option<PathBuf>,
    /// Save the solution, or the best iterate, as JSON; a problem file reads it with [start_from]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub save: Option<PathBuf>,
    /// Sample the motion at a fixed rate (1kHz, 500Hz, 1000), for --sample-to and --json; the last sample is
    /// at the final time
    #[arg(long, value_name = "RATE", value_parser = rate)]
    pub sample: Option<f64>,
    /// Write the samples as CSV: t, and q, v, a, tau and u of each joint
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, requires = "sample")]
    pub sample_to: Option<PathBuf>,
    /// Write the gains of the optimal feedback, dtau/dq and dtau/dv, at the rate of --sample or at the points
    /// of the motion, and its derivatives by the limits and by the masses of payloads, as JSON
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with = "range")]
    pub feedback: Option<PathBuf>,
    /// Follow the solution while a parameter changes (indirect methods): final_time (s), or a factor of
    /// gravity, armature, bounds, penalty_weight or smoothing; as gravity=0:1
    #[arg(long = "continue", value_name = "PARAMETER=FROM:TO")]
    pub range: Option<ParameterRange>,
    /// Stop after this time (s) and keep the best iterate; overrides solver.time_limit of the problem file
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<Duration>,
    /// Solve so many times, each from the beginning, and tell the least time: later ones find the machine
    /// code that the first one compiled
    #[arg(long, value_name = "COUNT", value_parser = count, conflicts_with = "range")]
    pub repeat: Option<NonZeroUsize>,
    /// Number of guesses that are solved to the end, the first one and disturbed ones; the cheapest motion is
    /// kept [default: one, the best of several that are looked at roughly]; overrides solver.starts of the
    /// problem file
    #[arg(long, value_name = "COUNT", value_parser = count)]
    pub starts: Option<NonZeroUsize>,
    /// Threads for several starts; by default as many as the processor runs at once; overrides solver.threads
    /// of the problem file
    #[arg(long, value_name = "COUNT", value_parser = count)]
    pub threads: Option<NonZeroUsize>,
    /// How the solution is verified; overrides solver.verify of the problem file
    #[arg(long, value_enum, value_name = "LEVEL")]
    pub verify: Option<Level>,
    /// Solve the conditions of the maximum principle from the motion of the direct method, for more digits,
    /// switching and conjugate times: true, false, or auto, for at most ten times the work of the direct
    /// method; overrides solver.polish of the problem file
    #[arg(long, value_enum, value_name = "WHEN", num_args = 0..=1, require_equals = true,
        default_missing_value = "true")]
    pub polish: Option<When>,
    /// Also print the derivatives of the cost by masses, first moments, inertias, lengths and all other
    /// numbers of the robot
    #[arg(long)]
    pub sensitivities: bool,
    /// Also print where the time went: evaluating points, Newton's equations, line search, meshes,
    /// verification (direct method)
    #[arg(long)]
    pub times: bool,
    /// Also print the table of Newton steps
    #[arg(long)]
    pub iterations: bool,
    /// Refuse robots with warnings that suggest a mistake (unknown elements or attributes, massless links,
    /// missing or swapped limits, inertias that no rigid body has)
    #[arg(long)]
    pub strict: bool,
    /// Load <dynamics damping friction> of a URDF as viscous and smooth Coulomb friction
    #[arg(long)]
    pub friction: bool,
    /// Let the root link of a URDF float: it moves by a floating joint, `root_joint`, with a quaternion
    #[arg(long)]
    pub floating_base: bool,
    /// Read joints of type `floating` of a URDF as such, with quaternions, not as six joints
    #[arg(long)]
    pub quaternions: bool,
}

/// How a solution is verified.
#[derive(Clone, Copy, ValueEnum)]
pub enum Level {
    /// Integrated again by an adaptive integrator, and checked for conjugate times
    Full,
    /// By the estimated error and the factors of the equations
    Factors,
    /// Not at all: the status is never "converged"
    None,
}

impl From<Level> for Verify {
    fn from(level: Level) -> Self {
        match level {
            Level::Full => Self::Full,
            Level::Factors => Self::Factors,
            Level::None => Self::None,
        }
    }
}

/// Whether to polish.
#[derive(Clone, Copy, ValueEnum)]
pub enum When {
    /// Where it applies
    True,
    /// Not at all
    False,
    /// Where it applies, for at most ten times the work of the direct method, Newton steps times nodes
    Auto,
}

impl From<When> for Polish {
    fn from(when: When) -> Self {
        match when {
            When::True => Self::Always,
            When::False => Self::Never,
            When::Auto => Self::Auto,
        }
    }
}

/// Parser of a time limit.
fn seconds(text: &str) -> Result<Duration, String> {
    let limit = positive(text)?;
    Duration::try_from_secs_f64(limit).ok().filter(|limit| !limit.is_zero()).ok_or_else(|| {
        "must be at least a nanosecond and less than 1e19 s; leave it out for no limit".to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::seconds;
    use std::time::Duration;

    #[test]
    fn time_limits_are_positive_and_finite() {
        assert_eq!(seconds("0.5"), Ok(Duration::from_millis(500)));
        for text in ["0", "-1", "inf", "nan", "1e300", "1e-12", "soon"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
