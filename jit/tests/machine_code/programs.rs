//! Machine code of random programs, bit by bit, against the same steps done one by one.

use costate::codegen::{Expr, Id, Node, Program, RecordedResult};
use costate::scalar::Scalar;
use costate_jit::{Compiled, JitError, JitNumber};
use costate_test_support::properties;
use proptest::prelude::*;

/// One random step: its operation and its operands among the values so far (counted from the last, modulo
/// their number).
type Choice = (u8, [usize; 3]);

fn choices(most: usize) -> impl Strategy<Value = Vec<Choice>> {
    // Near operands make chains, far ones values that live long.
    let operand = prop_oneof![3 => 0..6_usize, 2 => 0..60_usize, 1 => 0..2000_usize];
    prop::collection::vec((0..40_u8, prop::array::uniform3(operand)), 1..most)
}

/// The program of these choices: every third value is a result.
fn recorded(inputs: usize, choices: &[Choice]) -> Program {
    let program = Program::record("random", &[("x", inputs)], |arguments| {
        let mut values: Vec<Expr> = arguments[0].clone();
        values.extend([0.75, -2.0, 1e3].map(Expr::from_f64));
        for (kind, operands) in choices {
            let [a, b, c] = operands.map(|back| values[values.len() - 1 - back % values.len()]);
            values.push(match kind {
                0..8 => a + b,
                8..14 => a - b,
                14..20 => a * b,
                20..26 => a * b + c,
                26..30 => a * b - c,
                30..34 => c - a * b,
                34 => a / b,
                35 => -a,
                36 => (a * a).sqrt(),
                37 => Expr::select(a.less(b), c, a),
                38 => (-(a * a)).exp(),
                _ => a.exp_m1(),
            });
        }
        let results: Vec<Expr> = values.iter().rev().step_by(3).copied().collect();
        vec![RecordedResult::vector("y", results)]
    });
    program.unwrap()
}

/// What each step means; products that are joined with a sum are rounded once.
fn by_steps(program: &Program, inputs: &[f64]) -> Vec<f64> {
    let mut values: Vec<f64> = Vec::new();
    for node in program.nodes() {
        let of = |id: Id| values[id.index()];
        values.push(match *node {
            Node::Constant(value) => value,
            Node::Input(k) => inputs[k as usize],
            Node::Neg(a) => -of(a),
            Node::Add(a, b) => of(a) + of(b),
            Node::Sub(a, b) => of(a) - of(b),
            Node::Mul(a, b) => of(a) * of(b),
            Node::Div(a, b) => of(a) / of(b),
            Node::MulAdd(a, b, c) => of(a).mul_add(of(b), of(c)),
            Node::MulSub(a, b, c) => of(a).mul_add(of(b), -of(c)),
            Node::NegMulAdd(a, b, c) => (-of(a)).mul_add(of(b), of(c)),
            Node::Sqrt(a) => of(a).sqrt(),
            Node::Sin(a) => of(a).sin(),
            Node::Cos(a) => of(a).cos(),
            Node::Exp(a) => of(a).exp(),
            Node::ExpM1(a) => of(a).exp_m1(),
            Node::Less(a, b) => f64::from(u8::from(of(a) < of(b))),
            Node::Select(mask, a, b) => {
                if of(mask) != 0.0 {
                    of(a)
                } else {
                    of(b)
                }
            }
        });
    }
    program.results().iter().flat_map(|result| &result.entries).map(|id| values[id.index()]).collect()
}

/// Equal bit by bit; any NaN equals any other.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

/// Runs machine code on a part of a longer slice.
fn run<T: JitNumber + PartialEq>(compiled: &Compiled<T>, inputs: &[T], other: T) -> Result<Vec<T>, String> {
    let mut found = vec![other; compiled.outputs() + 4];
    let (before, rest) = found.split_at_mut(2);
    let (results, after) = rest.split_at_mut(compiled.outputs());
    compiled.call(inputs, results).unwrap();
    match [before, after].concat() == [other; 4] {
        true => Ok(results.to_vec()),
        false => Err("it writes beside its outputs".into()),
    }
}

/// Both widths against the steps: one state, and four of which each lane has another one.
fn check(program: &Program, inputs: &[f64]) -> Result<(), String> {
    let (one, four) = match (Compiled::new(program), Compiled::lanes(program)) {
        (Ok(one), Ok(four)) => (one, four),
        (Err(JitError::Processor { .. }), _) => return Ok(()),
        (one, four) => return Err(format!("{one:?} {four:?}")),
    };
    let states = [1.0, -0.5, 3.0, 0.0].map(|scale| inputs.iter().map(|x| x * scale).collect::<Vec<f64>>());
    let lanes: Vec<[f64; 4]> = (0..inputs.len()).map(|k| states.each_ref().map(|state| state[k])).collect();
    let in_lanes = run(&four, &lanes, [0.123; 4])?;
    for (lane, state) in states.iter().enumerate() {
        let expected = by_steps(program, state);
        let alone = run(&one, state, 0.123)?;
        for (k, &expected) in expected.iter().enumerate() {
            for (what, found) in [("alone", alone[k]), ("in its lane", in_lanes[k][lane])] {
                if !same(found, expected) {
                    return Err(format!("result {k} {what} is {found}, not {expected}\n{program:?}"));
                }
            }
        }
    }
    Ok(())
}

fn special() -> impl Strategy<Value = f64> {
    let odd = vec![0.0, -0.0, 1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MIN_POSITIVE, 1e308];
    prop_oneof![6 => -2.0..2.0, 1 => prop::sample::select(odd)]
}

properties! {
    400;

    #[test]
    fn random_programs_agree_bit_by_bit(
        inputs in prop::collection::vec(special(), 1..70),
        choices in choices(500),
    ) {
        check(&recorded(inputs.len(), &choices), &inputs).map_err(TestCaseError::fail)?;
    }
}

#[test]
fn a_program_without_steps_copies() {
    let program = Program::record("copy", &[("x", 2)], |arguments| {
        let x = &arguments[0];
        let (sin, cos) = x[0].sin_cos();
        vec![RecordedResult::vector("y", vec![x[1], Expr::from_f64(2.5), x[0], sin, x[1], cos])]
    });
    let Ok(compiled) = Compiled::new(program.as_ref().unwrap()) else { return };
    let mut y = [0.0; 6];
    compiled.call(&[0.25, -3.0], &mut y).unwrap();
    assert_eq!(y[..3], [-3.0, 2.5, 0.25]);
    assert!((y[3] - 0.25_f64.sin()).abs() < 1e-16 && y[4] == -3.0 && (y[5] - 0.25_f64.cos()).abs() < 2e-16);
}

#[test]
fn functions_of_functions_are_called_one_after_the_other() {
    let program = Program::record("nested", &[("x", 1)], |arguments| {
        let x = arguments[0][0];
        let (sin, cos) = (x * x).sin_cos();
        let e = (sin + x).exp();
        let (s, c) = (e * cos).sin_cos();
        vec![RecordedResult::vector("y", vec![s * sin, c, e.exp_m1() + cos, (s + c).exp()])]
    });
    let Ok(compiled) = Compiled::new(program.as_ref().unwrap()) else { return };
    for x in [-1.5_f64, 0.0, 0.3, 2.0] {
        let mut y = [0.0; 4];
        compiled.call(&[x], &mut y).unwrap();
        let (sin, cos) = (x * x).sin_cos();
        let e = (sin + x).exp();
        let (s, c) = (e * cos).sin_cos();
        for (found, expected) in y.iter().zip([s * sin, c, e.exp_m1() + cos, (s + c).exp()]) {
            assert!(
                (found - expected).abs() <= 1e-14 * expected.abs().max(1.0),
                "{found} is not {expected} at {x}"
            );
        }
    }
}

/// 300 sums that are all computed before any of them is used: far more than there are registers.
#[test]
fn values_that_wait_are_kept() {
    let program = Program::record("waiting", &[("x", 300)], |arguments| {
        let x = &arguments[0];
        let squares: Vec<Expr> = x.iter().map(|&x| x * x.plus(1.0)).collect();
        let total = squares.iter().fold(Expr::zero(), |sum, &square| sum + square);
        let y: Vec<Expr> = squares.iter().map(|&square| square * total).collect();
        vec![RecordedResult::vector("y", y)]
    });
    let inputs: Vec<f64> = (0..300).map(|k| (f64::from(k) * 0.7).cos()).collect();
    check(&program.unwrap(), &inputs).unwrap();
}
