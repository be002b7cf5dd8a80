//! Sine and cosine of generated source.

use crate::text::{compiler, run_c};
use costate::codegen::{Expr, Program, RecordedResult};
use costate::scalar::Scalar;

/// What the text of every Rust program begins with.
#[allow(dead_code, clippy::all, clippy::pedantic, reason = "generated code calls less than all of it")]
mod runtime {
    include!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/codegen/emit/runtime/sin_cos.rs"));
    include!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/codegen/emit/runtime/number.rs"));
}

/// Angles of all sizes below 1e5 rad, zeros of sine and cosine among them.
fn moderate_angles() -> Vec<f64> {
    let mut random = fastrand::Rng::with_seed(5);
    let sizes = [1e-300, 1e-8, 1.0, 7.0, 300.0, 1e5];
    let mut angles: Vec<f64> =
        (0..400).map(|k| sizes[k % sizes.len()] * (2.0 * random.f64() - 1.0)).collect();
    angles.extend((-100..100).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_2));
    angles.extend([99_999.999, -99_999.999]);
    angles
}

/// Angles that the library function of the language is called for.
const LIBRARY_ANGLES: [f64; 8] = [1e5, -1e5, 1e6, -3.3e7, 1e22, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// Units in the last place of `expected`; 0 where neither is a number.
fn units(found: f64, expected: f64) -> f64 {
    if found == expected || found.is_nan() && expected.is_nan() {
        return 0.0;
    }
    (found - expected).abs() / (expected.abs().next_up() - expected.abs())
}

#[test]
fn sine_and_cosine_of_rust_source_are_right_to_two_units() {
    for x in moderate_angles().into_iter().chain(LIBRARY_ANGLES) {
        let (sin, cos) = runtime::Number::sin_cos(x);
        let worst = units(sin, x.sin()).max(units(cos, x.cos()));
        assert!(worst <= 2.0, "{worst} units at {x:e}");
    }
}

/// One source file: the same operations, so the same bits.
#[cfg(feature = "wide")]
#[test]
fn sine_and_cosine_of_lanes_are_those_of_rust_source() {
    use costate::scalar::F64x4;
    for x in moderate_angles().chunks(4) {
        let (sin, cos) = F64x4::from_lanes(x).sin_cos();
        for (k, &x) in x.iter().enumerate() {
            assert_eq!((sin.lane(k), cos.lane(k)), runtime::Number::sin_cos(x), "{x:e}");
        }
    }
}

/// The same operations in both languages, so the same bits; the same library function beyond, to one unit.
#[test]
fn sine_and_cosine_of_c_source_are_those_of_rust_source() {
    let cc = match compiler() {
        Ok(cc) => cc,
        Err(reason) => return println!("{reason}"),
    };
    let angles: Vec<f64> = moderate_angles().into_iter().chain(LIBRARY_ANGLES).collect();
    let program = Program::record("sines", &[("x", angles.len())], |arguments| {
        let entries: Vec<Expr> = arguments[0].iter().flat_map(|x| <[Expr; 2]>::from(x.sin_cos())).collect();
        vec![RecordedResult::vector("both", entries)]
    });
    let fused: &[&str] = if cfg!(target_feature = "fma") { &["-march=native"] } else { &[] };
    let found = run_c(&cc, &program.unwrap(), &angles, &[&["-O2", "-ffp-contract=off"], fused].concat());
    for (x, found) in angles.iter().zip(found.chunks(2)) {
        let (sin, cos) = runtime::Number::sin_cos(*x);
        let worst = units(found[0], sin).max(units(found[1], cos));
        let allowed = if x.abs() < 1e5 { 0.0 } else { 1.0 };
        assert!(worst <= allowed, "{worst} units at {x:e}: {found:?}");
    }
}
