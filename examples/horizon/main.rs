//! Receding horizon: the tool of an arm follows a moving goal, and the whole motion of the next second is
//! optimised anew in each period of its controller, with all limits of its joints and a stop at the end.
//!
//! In each period the solver gets the measured state and the way of the goal over the next second as a
//! reference, takes a few Newton steps from its last motion, as long as there is time, and gives the torques
//! for the period. The arm is integrated with these, and its limits are checked along what it really does.
//!
//!     cargo run --release -p costate-examples --example horizon                 # UR5 and Panda at 1 kHz
//!     cargo run --release -p costate-examples --example horizon -- ur5 200 5 6  # 200 Hz, 5 s, 6 steps
//!     cargo test -p costate-examples --example horizon

mod controller;
mod plant;
mod report;
#[cfg(test)]
mod tests;

use controller::Controller;
use plant::Arm;
use report::Report;
use std::error::Error;

/// Most Newton steps of a plan.
const STEPS: f64 = 3.0;

/// The part of a period that a plan may take.
const SHARE: f64 = 0.8;

/// Runs of the same, to tell what a plan takes from what other programs take.
const RUNS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, otherwise: f64| match arguments.get(k) {
        None => Ok(otherwise),
        Some(text) => text.parse::<f64>().ok().filter(|x| *x > 0.0 && x.is_finite()).ok_or_else(|| {
            format!(
                "'{text}' is not a positive number; give an arm, a rate (Hz), a duration (s) and Newton steps"
            )
        }),
    };
    let (rate, duration, steps) = (number(1, 1000.0)?, number(2, 4.0)?, number(3, STEPS)? as usize);
    let arms = match arguments.first() {
        None => vec![Arm::ur5()?, Arm::panda()?],
        Some(name) => vec![Arm::named(name)?],
    };
    for arm in arms {
        let mut report = follow(arm.clone(), rate, duration, steps, Some(SHARE))?;
        for _ in 1..RUNS {
            report.repeat(&follow(arm.clone(), rate, duration, steps, Some(SHARE))?);
        }
        println!("{report}");
    }
    Ok(())
}

/// An arm that follows its goal for a while; plans take at most the part `share` of a period, if any.
fn follow(
    mut arm: Arm,
    rate: f64,
    duration: f64,
    steps: usize,
    share: Option<f64>,
) -> Result<Report, Box<dyn Error>> {
    let mut controller = Controller::new(&arm, 1.0 / rate, steps, share)?;
    let mut report = Report::new(&arm, rate);
    for _ in 0..(duration * rate) as usize {
        let spent = controller.plan(arm.time, &arm.q, &arm.v)?;
        report.add(spent, &controller.last);
        arm.advance(1.0 / rate, |t, tau| controller.torques(t, tau))?;
        report.look(&mut arm)?;
    }
    Ok(report)
}
