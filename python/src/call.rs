//! The states of a call: their numbers are read, evaluated one by one or in fours, and written.

use crate::argument::{Argument, Entries};
use crate::arrays::{Axes, Source};
use crate::errors::Failure;
use crate::failures::Failures;
use crate::fours;
use crate::plan::{Place, Plan};
use crate::results::Target;
use crate::workspace::Workspace;
use costate::EvalError;
use costate::configuration::Quaternions;
use costate::robot::Robot;
use costate_jit::finite_states;
use costate_numerics::widest_fused;
use std::ops::Range;

/// The states of one call.
pub struct Call<'a> {
    pub plan: &'a Plan,
    pub robot: &'a Robot,
    pub sources: &'a [Source],
    pub targets: &'a [Target],
    pub axes: Axes,
    /// Whether some results are no numbers where nothing is wrong.
    pub gaps: bool,
}

impl Call<'_> {
    /// Evaluates one state; its results are not-a-number where that fails.
    #[inline]
    pub fn one(&self, workspace: &mut Workspace, state: usize, failures: &mut Failures) {
        let Self { plan, sources, targets, axes, .. } = self;
        let buffer = workspace.state(plan);
        let mut finite = true;
        for place in &plan.places {
            let to = &mut buffer[place.at..place.at + place.length];
            sources[place.argument].copy(axes, state, place.start, to);
            finite &= all_finite(to);
        }
        let done = match finite {
            true => workspace.evaluate(plan),
            false => Err(self.not_finite(workspace.state(plan))),
        };
        let buffer = workspace.state(plan);
        finite = true;
        for (output, target) in plan.outputs.iter().zip(*targets) {
            // SAFETY: each state of a call is evaluated once, by one thread.
            let result = unsafe { target.of(state) };
            match done {
                Ok(()) => {
                    output.write(buffer, 0, result);
                    finite &= self.gaps || all_finite_of_many(result);
                }
                Err(_) => result.fill(f64::NAN),
            }
        }
        if let Err(failure) = done {
            let failure = match failure {
                // The library does not say which argument it is in.
                Failure::Evaluation(error @ EvalError::NotUnit { .. }) => {
                    let found = self.quaternion(workspace.state(plan), |all, q| all.first_not_unit(q));
                    found.unwrap_or(Failure::Evaluation(error))
                }
                failure => failure,
            };
            failures.add(state, failure);
        } else if !finite {
            failures.add(state, self.not_finite_result(workspace.state(plan)));
            // SAFETY: as above.
            targets.iter().for_each(|target| unsafe { target.of(state) }.fill(f64::NAN));
        }
    }

    /// A quaternion without a direction, or the largest number of all arguments of a state, where a result is
    /// not finite.
    #[cold]
    fn not_finite_result(&self, buffer: &[f64]) -> Failure {
        if let Some(failure) = self.quaternion(buffer, |all, q| all.first_without_direction(q)) {
            return failure;
        }
        let all = self.plan.places.iter().flat_map(|place| {
            let numbers = &buffer[place.at..place.at + place.length];
            numbers.iter().enumerate().map(move |(k, &value)| (place.argument, place.start + k, value))
        });
        let larger =
            |a: (usize, usize, f64), b: (usize, usize, f64)| if b.2.abs() > a.2.abs() { b } else { a };
        let (argument, index, value) = all.reduce(larger).unwrap_or_default();
        let (argument, joint) = self.entry(argument, index);
        Failure::Result { argument, index, joint, value }
    }

    /// The name of an argument, and of the joint that an entry of it belongs to.
    #[cold]
    fn entry(&self, argument: usize, index: usize) -> (&'static str, Option<String>) {
        let Argument { name, entries, .. } = self.plan.arguments[argument];
        let joint = match entries {
            Entries::Joints => self.robot.independent_joints().nth(index % self.robot.dof().max(1)),
            Entries::Positions => return (name, self.robot.joint_of_position(index).map(str::to_owned)),
            Entries::Axes | Entries::Rows => None,
        };
        (name, joint.map(|joint| joint.name.clone()))
    }

    /// The first quaternion of a state that is found, in the order of the arguments.
    #[cold]
    fn quaternion(
        &self,
        buffer: &[f64],
        find: impl Fn(&Quaternions, &dyn Fn(usize) -> f64) -> Option<usize>,
    ) -> Option<Failure> {
        let quaternions = Quaternions::of(self.robot);
        let positions = |place: &&Place| self.plan.arguments[place.argument].entries == Entries::Positions;
        self.plan.places.iter().filter(positions).find_map(|place| {
            let q = |entry: usize| buffer[place.at + entry];
            let k = find(&quaternions, &q)?;
            let joint = self.robot.free_joints()[k].name.clone();
            let argument = self.plan.arguments[place.argument].name;
            Some(Failure::NotUnit { argument, joint, length: quaternions.length(k, q) })
        })
    }

    /// The first number of a state that is not finite, in the order of the arguments.
    #[cold]
    fn not_finite(&self, buffer: &[f64]) -> Failure {
        let found = self.plan.places.iter().find_map(|place| {
            let numbers = &buffer[place.at..place.at + place.length];
            Some((place, place.start + numbers.iter().position(|number| !number.is_finite())?))
        });
        // One of them is: the caller has looked.
        let (argument, index) = found.map_or((0, 0), |(place, index)| (place.argument, index));
        let (argument, joint) = self.entry(argument, index);
        Failure::NonFinite { argument, index, joint }
    }

    /// Evaluates these states in fours, the last one repeated where they are not a multiple of four. States
    /// that are not certain are evaluated one by one.
    pub fn by_fours(&self, workspace: &mut Workspace, states: Range<usize>, failures: &mut Failures) {
        workspace.fit_four(self.plan);
        widest_fused(
            #[inline(always)]
            |wide| match wide {
                // SAFETY: vectors that fuse products and sums are of AVX or later, on x86.
                true => unsafe { self.fours::<true>(workspace, states, failures) },
                // SAFETY: asks for nothing.
                false => unsafe { self.fours::<false>(workspace, states, failures) },
            },
        );
    }

    /// # Safety
    /// `WIDE` only where the processor has AVX.
    #[inline(always)]
    unsafe fn fours<const WIDE: bool>(
        &self,
        workspace: &mut Workspace,
        states: Range<usize>,
        failures: &mut Failures,
    ) {
        let Self { plan, sources, targets, axes, .. } = self;
        for start in states.clone().step_by(4) {
            let four = std::array::from_fn(|lane| (start + lane).min(states.end - 1));
            let buffer = workspace.four(plan);
            let mut finite = [true; 4];
            for place in &plan.places {
                let to = &mut buffer[place.at..place.at + place.length];
                // SAFETY: the promise of the caller.
                unsafe { sources[place.argument].copy_four::<WIDE>(axes, four, place.start, to) };
                // Lanes look at their own arguments.
                if place.at < plan.core_inputs.start {
                    finite.iter_mut().zip(finite_states(to)).for_each(|(finite, found)| *finite &= found);
                }
            }
            let certain = workspace.evaluate_four(plan);
            let certain: [bool; 4] = std::array::from_fn(|lane| certain[lane] && finite[lane]);
            let buffer = workspace.four(plan);
            if certain == [true; 4] && start + 4 <= states.end {
                for (output, target) in plan.outputs.iter().zip(*targets) {
                    // SAFETY: each state of a call is evaluated once, by one thread; the rest is the promise
                    // of the caller.
                    unsafe { fours::write::<WIDE>(buffer, &output.places, target.of_all(start..start + 4)) };
                }
                continue;
            }
            for (lane, state) in (start..states.end.min(start + 4)).enumerate() {
                if !certain[lane] {
                    self.one(workspace, state, failures);
                    continue;
                }
                let buffer = workspace.four(plan);
                for (output, target) in plan.outputs.iter().zip(*targets) {
                    // SAFETY: each state of a call is evaluated once, by one thread.
                    output.write(buffer, lane, unsafe { target.of(state) });
                }
            }
        }
    }
}

/// Whether every number is finite: `0 x` is 0 if x is finite, and not a number otherwise.
#[inline]
fn all_finite(numbers: &[f64]) -> bool {
    numbers.iter().fold(0.0, |sum, number| sum + 0.0 * number) == 0.0
}

/// The same of many numbers: eight sums do not wait for each other.
#[inline]
fn all_finite_of_many(numbers: &[f64]) -> bool {
    let (parts, rest) = numbers.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for part in parts {
        sums.iter_mut().zip(part).for_each(|(sum, number)| *sum += 0.0 * number);
    }
    sums.iter().sum::<f64>() == 0.0 && all_finite(rest)
}
