//! Arguments of `costate check`.

use crate::RobotArguments;
use crate::arguments::{positive, whole};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    pub robot: RobotArguments,
    /// Number of random states, besides q = 0
    #[arg(long, default_value = "100", value_parser = whole)]
    pub samples: usize,
    /// Seed of the random states
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Largest difference allowed, in units of the rounding error bound of its block
    #[arg(long, default_value = "1", value_parser = positive)]
    pub tolerance: f64,
    /// Print one JSON object and nothing else
    #[arg(long)]
    pub json: bool,
    /// Run all methods on long chains even if that takes minutes or gigabytes
    #[arg(long)]
    pub force: bool,
}
