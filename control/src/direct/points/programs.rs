//! Machine code of inverse dynamics and of its second derivatives, compiled once for each robot.

use crate::constants::programs as constants;
use costate::codegen::{Coordinates, ProgramOptions, Quantity, robot_program};
use costate::robot::Robot;
use costate_jit::Compiled;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Four states at once.
pub(super) type Lanes = Compiled<[f64; 4]>;

/// The programs of a robot, each compiled when it is first asked for; `None` where the processor or the
/// length of the program does not allow it.
#[derive(Debug)]
pub(super) struct Programs {
    robot: Robot,
    tau: OnceLock<Option<Lanes>>,
    second: OnceLock<Option<Lanes>>,
}

/// Those of the last problems, the latest one first.
static RECENT: Mutex<Vec<Arc<Programs>>> = Mutex::new(Vec::new());

impl Programs {
    /// Those of this robot, which all problems with an equal robot share.
    pub fn of(robot: &Robot) -> Arc<Self> {
        // What a panic leaves behind is a list all the same.
        Self::first(&mut RECENT.lock().unwrap_or_else(PoisonError::into_inner), robot)
    }

    /// Moves those of a robot to the front; too old ones go.
    fn first(recent: &mut Vec<Arc<Self>>, robot: &Robot) -> Arc<Self> {
        let new = || Arc::new(Self { robot: robot.clone(), tau: OnceLock::new(), second: OnceLock::new() });
        let known = recent.iter().position(|known| known.robot == *robot);
        let programs = known.map_or_else(new, |at| recent.remove(at));
        recent.truncate(constants::ROBOTS - 1);
        recent.insert(0, Arc::clone(&programs));
        programs
    }

    /// tau.
    pub fn tau(&self) -> Option<&Lanes> {
        self.tau.get_or_init(|| compiled(&self.robot, Quantity::InverseDynamics)).as_ref()
    }

    /// tau, tau_z, and the Hessian of w.tau.
    pub fn second(&self) -> Option<&Lanes> {
        self.second.get_or_init(|| compiled(&self.robot, Quantity::YTauZZ)).as_ref()
    }
}

fn compiled(robot: &Robot, quantity: Quantity) -> Option<Lanes> {
    if robot.dof() > constants::JOINTS || costate_jit::supported().is_err() {
        return None;
    }
    let options = ProgramOptions::default().with_limit(constants::STEPS);
    let program = robot_program(robot, quantity, Coordinates::Lagrangian, &options).ok()?;
    Lanes::with_limit(&program, constants::STEPS).ok()
}

#[cfg(test)]
mod tests {
    use super::Programs;
    use crate::constants::programs::ROBOTS;
    use costate_test_support::robots::file;
    use std::sync::Arc;

    #[test]
    fn equal_robots_share_their_programs_and_others_do_not() {
        let (robot, other) = (file("two_link.toml"), file("pendulum.toml"));
        let mut recent = Vec::new();
        let shared = Programs::first(&mut recent, &robot);
        assert!(!Arc::ptr_eq(&shared, &Programs::first(&mut recent, &other)));
        assert!(Arc::ptr_eq(&shared, &Programs::first(&mut recent, &robot.clone())));
        for k in 1..=ROBOTS {
            let elsewhere = robot.with_gravity([0.0, 0.0, k as f64]).unwrap();
            assert!(!Arc::ptr_eq(&shared, &Programs::first(&mut recent, &elsewhere)));
            assert_eq!(recent.len(), ROBOTS.min(k + 2));
        }
        assert!(!Arc::ptr_eq(&shared, &Programs::first(&mut recent, &robot)), "the oldest ones go");
    }
}
