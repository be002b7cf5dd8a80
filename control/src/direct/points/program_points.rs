//! Torques with their derivatives by machine code, four points at a time.

use super::generic_points::{LanePoints, Rows, groups};
use super::programs::{Lanes, Programs};
use super::values::{PointDynamics, Points};
use crate::constants::programs as constants;
use crate::options::MachineCode;
use costate::EvalError;
use costate::robot::Robot;
use costate_numerics::widest;
use std::ops::Range;
use std::sync::Arc;

/// Points that are computed together.
const LANES: usize = 4;

/// Machine code for four points at a time, where the processor and the robot allow it.
///
/// By default the first points are computed by the generic code, one after the other, since a short solve is
/// over before a program is compiled. Where no machine code is to be had, the generic code computes several
/// points at a time. Where an argument or a result is not finite, it computes the points again: results and
/// errors are then its own.
#[derive(Debug)]
pub(crate) struct ProgramPoints {
    generic: LanePoints,
    /// None where machine code is not wanted.
    programs: Option<Arc<Programs>>,
    /// Points whose torques, and whose second derivatives, the generic code computes before machine code
    /// does, no matter whether it is there already: results do not depend on what was solved before.
    left: [usize; 2],
    inputs: Vec<[f64; LANES]>,
    outputs: Vec<[f64; LANES]>,
}

impl ProgramPoints {
    pub fn new(robot: &Robot, machine_code: MachineCode) -> Self {
        let n = robot.dof();
        let left = match machine_code {
            MachineCode::Later => [constants::TORQUES * n, constants::HESSIANS * n],
            MachineCode::AtOnce | MachineCode::Never => [0; 2],
        };
        Self {
            generic: LanePoints::new(robot),
            programs: (machine_code != MachineCode::Never).then(|| Programs::of(robot)),
            left,
            inputs: vec![[0.0; LANES]; 4 * n],
            outputs: vec![[0.0; LANES]; n + 8 * n * n],
        }
    }

    /// Whether so many points are among the first ones of torques or second derivatives.
    fn are_first(&mut self, which: usize, count: usize) -> bool {
        let left = &mut self.left[which];
        let first = *left > 0;
        *left = left.saturating_sub(count);
        first
    }
}

impl PointDynamics for ProgramPoints {
    fn evaluate_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError> {
        let first = self.are_first(0, which.len());
        let programs = self.programs.clone();
        if first {
            return self.generic.one.evaluate_some(points, which);
        }
        let Some(tau) = programs.as_ref().and_then(|programs| programs.tau()) else {
            return self.generic.evaluate_some(points, which);
        };
        let n = points.dof;
        let (inputs, outputs) = (&mut self.inputs[..3 * n], &mut self.outputs[..n]);
        for group in groups(which, LANES) {
            let finite = run(tau, inputs, outputs, |inputs| gather(&points.z, &group, inputs))?;
            if finite {
                widest(
                    #[inline(always)]
                    || Rows { rows: &mut points.tau, size: n, group }.put_all(0..n, |k| outputs[k]),
                );
            } else {
                self.generic.one.evaluate_some(points, group)?;
            }
        }
        Ok(())
    }

    fn contract_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError> {
        let first = self.are_first(1, which.len());
        let programs = self.programs.clone();
        if first {
            return self.generic.one.contract_some(points, which);
        }
        let Some(second) = programs.as_ref().and_then(|programs| programs.second()) else {
            return self.generic.contract_some(points, which);
        };
        let n = points.dof;
        for group in groups(which, LANES) {
            let finite = run(second, &mut self.inputs, &mut self.outputs, |inputs| {
                let (z, weights) = inputs.split_at_mut(3 * n);
                gather(&points.z, &group, z);
                gather(&points.weights, &group, weights);
            })?;
            if finite {
                let outputs = self.outputs.as_slice();
                widest(
                    #[inline(always)]
                    || take(outputs, group, points),
                );
            } else {
                self.generic.one.contract_some(points, group)?;
            }
        }
        Ok(())
    }
}

/// Runs a program on what `fill` puts in. Whether all arguments and results are finite.
fn run(
    program: &Lanes,
    inputs: &mut [[f64; LANES]],
    outputs: &mut [[f64; LANES]],
    fill: impl FnOnce(&mut [[f64; LANES]]),
) -> Result<bool, EvalError> {
    fill(inputs);
    program.call(inputs, outputs)?;
    Ok(widest(
        #[inline(always)]
        || all_finite(inputs) && all_finite(outputs),
    ))
}

/// Whether every number is finite: `0 x` is 0 if x is finite, and not a number otherwise.
#[inline(always)]
fn all_finite(values: &[[f64; LANES]]) -> bool {
    let mut sums = [[0.0; LANES]; 2];
    let (pairs, rest) = values.as_chunks::<2>();
    for [first, second] in pairs.iter().copied().chain(rest.iter().map(|&last| [last, last])) {
        for l in 0..LANES {
            sums[0][l] += 0.0 * first[l];
            sums[1][l] += 0.0 * second[l];
        }
    }
    sums.as_flattened().iter().all(|&sum| sum == 0.0)
}

/// The rows of a group, entry k of all of them in `to[k]`; the last row also in lanes without a point.
fn gather(rows: &[f64], group: &Range<usize>, to: &mut [[f64; LANES]]) {
    let size = to.len();
    let row = |lane: usize| &rows[size * (group.start + lane).min(group.end - 1)..][..size];
    let [a, b, c, d] = [row(0), row(1), row(2), row(3)];
    for (k, to) in to.iter_mut().enumerate() {
        *to = [a[k], b[k], c[k], d[k]];
    }
}

impl Rows<'_> {
    /// Writes entries of the rows: the k-th of them is `value(k)`, a lane for each point.
    #[inline(always)]
    fn put_all(&mut self, entries: Range<usize>, value: impl Fn(usize) -> [f64; LANES]) {
        let (size, count) = (self.size, entries.len());
        let rows = &mut self.rows[size * self.group.start..size * self.group.end];
        let mut k = 0;
        if self.group.len() == LANES {
            while k + LANES <= count {
                let tile = [value(k), value(k + 1), value(k + 2), value(k + 3)];
                for lane in 0..LANES {
                    let turned = [tile[0][lane], tile[1][lane], tile[2][lane], tile[3][lane]];
                    rows[size * lane + entries.start + k..][..LANES].copy_from_slice(&turned);
                }
                k += LANES;
            }
        }
        for k in k..count {
            let values = value(k);
            for (row, value) in rows.chunks_exact_mut(size).zip(values) {
                row[entries.start + k] = value;
            }
        }
    }
}

/// tau, tau_z, and the Hessian from its blocks in x = (q, v) and in a and q: all others are zero.
#[inline(always)]
fn take(outputs: &[[f64; LANES]], group: Range<usize>, points: &mut Points) {
    let n = points.dof;
    let (tau, rest) = outputs.split_at(n);
    let (tau_z, rest) = rest.split_at(3 * n * n);
    let (xx, aq) = rest.split_at(4 * n * n);
    Rows { rows: &mut points.tau, size: n, group: group.clone() }.put_all(0..n, |k| tau[k]);
    Rows { rows: &mut points.tau_z, size: 3 * n * n, group: group.clone() }
        .put_all(0..3 * n * n, |k| tau_z[k]);
    let mut hessian = Rows { rows: &mut points.hessian, size: 9 * n * n, group };
    for i in 0..2 * n {
        let (row, xx) = (3 * n * i, &xx[2 * n * i..2 * n * (i + 1)]);
        hessian.put_all(row..row + 2 * n, |k| xx[k]);
        match i < n {
            true => hessian.put_all(row + 2 * n..row + 3 * n, |k| aq[n * k + i]),
            false => hessian.put_all(row + 2 * n..row + 3 * n, |_| [0.0; LANES]),
        }
    }
    for i in 0..n {
        let (row, aq) = (3 * n * (2 * n + i), &aq[n * i..n * (i + 1)]);
        hessian.put_all(row..row + n, |k| aq[k]);
        hessian.put_all(row + n..row + 3 * n, |_| [0.0; LANES]);
    }
}

#[cfg(test)]
#[path = "program_points_tests.rs"]
mod tests;
