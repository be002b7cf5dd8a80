//! Machine code of inverse dynamics and of its second derivatives, compiled once for each robot.

use crate::constants::programs as constants;
use costate::codegen::{Coordinates, ProgramOptions, Quantity, robot_program};
use costate::robot::Robot;
use costate_jit::{Compiled, JitError};
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};

/// Four states at once.
pub(super) type Lanes = Compiled<[f64; 4]>;

/// tau, and tau with tau_z and the Hessian of w.tau.
#[derive(Debug)]
pub(super) struct Programs {
    pub tau: Lanes,
    pub second: Lanes,
}

/// The programs of a robot, once they are compiled; `None` where the processor or the length of the programs
/// does not allow it.
pub(super) type Shared = Arc<OnceLock<Option<Arc<Programs>>>>;

/// Robots, the latest one first.
type Robots = Vec<(Robot, Shared)>;

/// Those of the last problems.
static RECENT: LazyLock<Mutex<Robots>> = LazyLock::new(Mutex::default);

/// The place for the programs of this robot, which all problems with an equal robot share.
pub(super) fn of(robot: &Robot) -> Shared {
    // What a panic leaves behind is a list all the same.
    let mut recent = RECENT.lock().unwrap_or_else(PoisonError::into_inner);
    first(&mut recent, robot)
}

/// Moves a robot to the front; too old ones go.
fn first(recent: &mut Robots, robot: &Robot) -> Shared {
    let known = recent.iter().position(|(known, _)| known == robot);
    let entry = known.map_or_else(|| (robot.clone(), Shared::default()), |at| recent.remove(at));
    let shared = entry.1.clone();
    recent.truncate(constants::ROBOTS - 1);
    recent.insert(0, entry);
    shared
}

impl Programs {
    /// Records and compiles both.
    pub fn new(robot: &Robot) -> Option<Self> {
        if robot.dof() > constants::JOINTS || costate_jit::supported().is_err() {
            return None;
        }
        let compiled = |quantity| {
            let options = ProgramOptions::default().with_limit(constants::STEPS);
            let program = robot_program(robot, quantity, Coordinates::Lagrangian, &options).ok()?;
            let compiled: Result<Lanes, JitError> = Compiled::with_limit(&program, constants::STEPS);
            compiled.ok()
        };
        let second = compiled(Quantity::YTauZZ)?;
        Some(Self { tau: compiled(Quantity::InverseDynamics)?, second })
    }
}

#[cfg(test)]
mod tests {
    use super::{Robots, first};
    use crate::constants::programs::ROBOTS;
    use costate_test_support::robots::file;
    use std::sync::Arc;

    #[test]
    fn equal_robots_share_their_programs_and_others_do_not() {
        let (robot, other) = (file("two_link.toml"), file("pendulum.toml"));
        let mut recent = Robots::new();
        let shared = first(&mut recent, &robot);
        assert!(!Arc::ptr_eq(&shared, &first(&mut recent, &other)));
        assert!(Arc::ptr_eq(&shared, &first(&mut recent, &robot.clone())));
        for k in 1..=ROBOTS {
            let elsewhere = robot.with_gravity([0.0, 0.0, k as f64]).unwrap();
            assert!(!Arc::ptr_eq(&shared, &first(&mut recent, &elsewhere)));
            assert_eq!(recent.len(), ROBOTS.min(k + 2));
        }
        assert!(!Arc::ptr_eq(&shared, &first(&mut recent, &robot)), "the oldest ones go");
    }
}
