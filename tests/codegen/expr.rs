//! Recording: folding, sharing, signs, and functions that cannot be recorded.

use costate::codegen::{CodegenError, Expr, Node, Program, RecordedResult};
use costate::kernels::friction;
use costate::robot::Friction;
use costate::scalar::{Operations, Scalar};

/// A function of three numbers with these results.
pub fn recorded(function: impl FnOnce(Expr, Expr, Expr) -> Vec<Expr>) -> Program {
    Program::record("function", &[("x", 3)], |arguments| {
        let entries = function(arguments[0][0], arguments[0][1], arguments[0][2]);
        vec![RecordedResult::vector("r", entries)]
    })
    .unwrap()
}

/// The results at these inputs.
pub fn at<S: Scalar>(program: &Program, inputs: &[S]) -> Vec<S> {
    let mut outputs = vec![S::zero(); program.outputs()];
    program.evaluate(inputs, &mut outputs, &mut Vec::new()).unwrap();
    outputs
}

#[test]
fn constants_are_folded() {
    let program = recorded(|x, y, z| {
        let (zero, one) = (Expr::zero(), Expr::one());
        let minus = -one;
        vec![
            x * zero + y * one - (z * minus) * one,
            x + zero - (zero - x),
            -(-x),
            x - x,
            zero / x,
            Expr::from_f64(2.0).sqrt() * Expr::from_f64(3.0),
            x.plus(1.5).plus(-1.5),
            x.times(4.0).times(0.25),
            (y - x) + x,
            x * y + (z - y) * x,
            x / Expr::from_f64(4.0),
        ]
    });
    let expected = Operations { add: 1, mul: 2, ..Operations::default() };
    assert_eq!(
        program.operations(),
        Operations { mul: expected.mul + 1, ..expected },
        "{:?}",
        program.nodes()
    );
    let values = at(&program, &[0.3, -0.7, 2.0]);
    assert_eq!(values, [1.3, 0.6, 0.3, 0.0, 0.0, 3.0 * 2.0_f64.sqrt(), 0.3, 0.3, -0.7, 0.6, 0.075]);
}

#[test]
fn equal_operations_are_recorded_once_whatever_their_order_and_signs() {
    let program = recorded(|x, y, z| {
        let (s, c) = (x * y).sin_cos();
        let (t, d) = (y * -x).sin_cos();
        vec![s, -t, c - d, (x - z).recip() + Expr::one() / (z - x), (x - y) * (z - x) - (y - x) * (x - z)]
    });
    let count = |of: fn(&Node) -> bool| program.nodes().iter().filter(|node| of(node)).count();
    assert_eq!(
        (program.steps(), count(|node| matches!(node, Node::Sin(_)))),
        (2, 1),
        "{:?}",
        program.nodes()
    );
    let sine = (0.3_f64 * -0.7).sin();
    assert_eq!(at(&program, &[0.3, -0.7, 2.0]), [sine, sine, 0.0, 0.0, 0.0]);
}

#[test]
fn negations_cost_nothing_where_a_difference_can_be_reversed() {
    fn turned<S: Scalar>(x: S, y: S, z: S, which: usize) -> S {
        match which {
            0 => -(x - y * z),
            1 => -((x - y) * z),
            2 => -(x - y) / z,
            _ => -(z + (x - y) * (x - z)),
        }
    }
    for which in 0..4 {
        let program = recorded(|x, y, z| vec![turned(x, y, z, which)]);
        let changes = program.nodes().iter().filter(|node| matches!(node, Node::Neg(_))).count();
        assert_eq!(changes, 0, "{:?}", program.nodes());
        let (found, expected) = (at(&program, &[0.3, -0.7, 2.0])[0], turned(0.3, -0.7, 2.0, which));
        assert!((found - expected).abs() <= 4e-16 * f64::abs(expected), "{found} is not {expected}");
    }
}

#[test]
fn a_product_is_joined_with_every_sum_or_computed_once() {
    let steps = |program: &Program| {
        let joined = |node: &&Node| matches!(node, Node::MulAdd(..) | Node::MulSub(..) | Node::NegMulAdd(..));
        (program.steps(), program.nodes().iter().filter(joined).count())
    };
    let sums = recorded(|x, y, z| vec![x * y + z, z - x * y]);
    assert_eq!((steps(&sums), sums.operations().mul), ((2, 2), 1));
    let result = recorded(|x, y, z| vec![x * y + z, x * y]);
    assert_eq!(steps(&result), (2, 0));
}

/// A sum of p products and t other terms takes p + max(t - 1, 0) steps, in whatever order it was recorded.
#[test]
fn a_sum_of_products_takes_no_more_steps_than_it_must() {
    let nested = recorded(|x, y, z| {
        let (a, b) = (x + y, y - z);
        vec![a, b, ((a * b - x * z) + (y * y - a)) - ((z - b * z) - x * x)]
    });
    assert_eq!(nested.steps(), 2 + 5 + 1, "{:?}", nested.nodes());
    // x y is a factor too, so it is computed.
    let pure = recorded(|x, y, z| vec![(x * y - z * z) + (y * z - x * x), -(x * z) - (y * y - x * y * z)]);
    assert_eq!(pure.steps(), 1 + 3 + 3, "{:?}", pure.nodes());
    // x y joins both sums, each of which has two other terms.
    let shared = recorded(|x, y, z| vec![(x * y + z) - y, (x - x * y) - z]);
    assert_eq!(shared.steps(), 2 + 2, "{:?}", shared.nodes());
    let (x, y, z) = (0.3, -0.7, 2.0);
    let (a, b) = (x + y, y - z);
    let expected = [
        vec![a, b, a * b - x * z + y * y - a - z + b * z + x * x],
        vec![x * y - z * z + y * z - x * x, x * y * z - x * z - y * y],
        vec![x * y + z - y, x - x * y - z],
    ];
    for (program, expected) in [nested, pure, shared].iter().zip(expected) {
        let near = |(found, expected): (f64, f64)| (found - expected).abs() < 1e-14;
        let found = at(program, &[x, y, z]);
        assert!(
            found.iter().copied().zip(expected.iter().copied()).all(near),
            "{found:?} is not {expected:?}"
        );
    }
}

/// Friction as in the kernels: exponential functions, comparisons, selections.
fn law(v: Expr) -> Vec<Expr> {
    let law = Friction { viscous: 0.7, coulomb: 3.0, coulomb_velocity: 0.25 };
    let d = friction(&law, v);
    vec![d.value, d.first, d.second]
}

#[test]
fn selections_are_right_on_both_sides_and_for_nan() {
    let program = recorded(|x, y, _| [law(x * y), vec![x.abs(), Expr::select(x.less(y), x, -y)]].concat());
    let law = Friction { viscous: 0.7, coulomb: 3.0, coulomb_velocity: 0.25 };
    for x in [-3.0, -0.1, -1e-9, 0.0, 1e-9, 0.2, 5.0, f64::INFINITY] {
        for y in [-2.0, 0.3] {
            let d = friction(&law, x * y);
            let expected = [d.value, d.first, d.second, x.abs(), if x < y { x } else { -y }];
            for (found, expected) in at(&program, &[x, y, 0.0]).into_iter().zip(expected) {
                let same = found == expected || (found.is_nan() && expected.is_nan());
                assert!(
                    same || (found - expected).abs() <= 4e-16 * expected.abs(),
                    "{found} is not {expected} at {x}, {y}"
                );
            }
        }
    }
    let found = at(&program, &[f64::NAN, 1.0, 0.0]);
    assert!(found[..4].iter().all(|value| value.is_nan()), "{found:?}");
    assert_eq!(found[4], -1.0, "no number is greater than NaN");
}

#[test]
fn an_expression_of_another_recording_is_an_error() {
    let mut kept = None;
    let first = recorded(|x, _, _| {
        kept = Some((x + Expr::one(), x.less(Expr::one())));
        vec![x]
    });
    assert_eq!(first.steps(), 0);
    let (stale, mask) = kept.unwrap();
    let refused = |use_it: &dyn Fn(Expr) -> Expr| {
        let outcome = Program::record("second", &[("x", 1)], |arguments| {
            vec![RecordedResult::vector("r", vec![use_it(arguments[0][0])])]
        });
        assert_eq!(outcome.unwrap_err(), CodegenError::Foreign);
    };
    refused(&|x| x * stale);
    refused(&|_| stale);
    refused(&|_| -stale);
    refused(&|x| Expr::select(mask, x, -x));
    refused(&|x| Expr::select(stale.less(x), x, -x));
    let outside = stale * Expr::from_f64(2.0) + stale;
    refused(&|x| x + outside);
    let constant = Expr::from_f64(2.0) * Expr::from_f64(3.0);
    assert_eq!(at(&recorded(|x, _, _| vec![x * constant]), &[2.0, 0.0, 0.0]), [12.0]);
}

#[test]
fn a_recording_within_a_recording_is_separate() {
    let program = recorded(|x, y, _| {
        let before = x * y;
        let inner = recorded(|a, b, _| vec![a - b]);
        assert_eq!(at(&inner, &[5.0, 3.0, 0.0]), [2.0]);
        vec![before + x]
    });
    assert_eq!(at(&program, &[2.0, 3.0, 0.0]), [8.0]);
}

#[test]
fn a_branch_on_a_recorded_value_is_an_error() {
    let outcome = Program::record("branching", &[("x", 1)], |arguments| {
        let x = arguments[0][0];
        let larger = if Scalar::is_finite(x) { x } else { Expr::zero() };
        vec![RecordedResult::vector("r", vec![larger])]
    });
    assert_eq!(outcome.unwrap_err(), CodegenError::Branch);
}

#[test]
fn names_and_shapes_that_source_cannot_have_are_refused() {
    let record = |name: &str, argument: &str, result: &str, rows| {
        Program::record(name, &[(argument, 1)], |x| {
            vec![RecordedResult::matrix(result, rows, 1, x[0].clone())]
        })
    };
    assert!(record("f", "x", "r", 1).is_ok());
    for (name, argument, result) in
        [("2f", "x", "r"), ("f", "while", "r"), ("f", "x", "x"), ("f", "x", "F'"), ("f", "f", "r")]
    {
        assert!(
            matches!(record(name, argument, result, 1), Err(CodegenError::Name { .. })),
            "{name} {argument} {result}"
        );
    }
    let shape = CodegenError::Shape { name: "r".into(), rows: 2, columns: 1, found: 1 };
    assert_eq!(record("f", "x", "r", 2).unwrap_err(), shape);
    assert!(at_wrong_length().to_string().contains("inputs has 1 entries, not 3"));
}

fn at_wrong_length() -> CodegenError {
    recorded(|x, _, _| vec![x]).evaluate(&[1.0], &mut [0.0], &mut Vec::new()).unwrap_err()
}

#[test]
fn public_types_are_debug_clone_and_send() {
    use costate::codegen::{
        COptions, ProgramArgument, ProgramOptions, ProgramResult, RobotQuantity, RustOptions,
    };
    fn check<T: std::fmt::Debug + Clone + Send + Sync>() {}
    check::<Expr>();
    check::<Program>();
    check::<ProgramArgument>();
    check::<ProgramResult>();
    check::<ProgramOptions>();
    check::<RobotQuantity<f64>>();
    check::<RustOptions>();
    check::<COptions>();
    check::<CodegenError>();
}
