//! Margins against their meaning and their derivatives, and contacts that cannot be.

use super::samples::{biped, hopper, lift, toe};
use super::*;
use crate::matrix::Matrix;
use num_dual::HyperDual64;

/// Margins, of forces that are given.
#[test]
fn margins_say_where_forces_are() {
    let (robot, foot, _) = hopper();
    let stance = Stance::new(&robot, &[foot.smoothing(2.0)]).unwrap();
    let names: Vec<MarginKind> = stance.margins().iter().map(Margin::kind).collect();
    use MarginKind::{Back, Friction, Front, Left, Normal, Right, TwistLeft, TwistRight};
    assert_eq!(names, [Normal, Friction, Front, Back, Left, Right, TwistLeft, TwistRight]);
    assert_eq!(stance.margins()[2].name(), "foot: centre of pressure in front");
    // 100 N at (0.1, 0.02) on the sole, with 30 N and 20 N along it and 1 N m about the normal.
    let lambda = [30.0, 20.0, 100.0, 2.0, -10.0, 1.0];
    let pressure = stance.centre_of_pressure(0, &lambda).unwrap();
    assert!((pressure[0] - 0.1).abs() < 1e-15 && (pressure[1] - 0.02).abs() < 1e-15, "{pressure:?}");
    let found: Vec<f64> = stance.margins().iter().map(|margin| margin.value(&lambda)).collect();
    let expected =
        [100.0, 50.0 - (900.0_f64 + 400.0 + 4.0).sqrt(), 5.0, 20.0, 4.0, 7.0, 3.0 - 1.0, 3.0 + 1.0];
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    assert_eq!(stance.centre_of_pressure(0, &[0.0, 0.0, -1.0, 0.0, 0.0, 0.0]), None);
    // The smooth cone is inside the exact one, by no more than its smoothing.
    for k in 0..200 {
        let angle = 0.3 * f64::from(k);
        let (size, normal) = (f64::from(k) * 0.3, 40.0 + 30.0 * angle.sin());
        let lambda = [size * angle.cos(), size * angle.sin(), normal, 0.0, 0.0, 0.0];
        let (smooth, exact) = (stance.margins()[1].value(&lambda), 0.5 * normal - size);
        assert!((0.0..=2.0 + 1e-12).contains(&(exact - smooth)), "{smooth} {exact}");
    }
    let planar = Stance::new(&biped(), &[toe("left").planar()]).unwrap();
    let found: Vec<f64> = planar.margins().iter().map(|margin| margin.value(&[20.0, 50.0])).collect();
    assert!(found.iter().zip([50.0, 10.0, 50.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
}

#[test]
fn derivatives_of_margins_by_forces_are_those_of_hyper_dual_numbers() {
    let (robot, foot, _) = hopper();
    let stance = Stance::new(&robot, &[foot.smoothing(3.0)]).unwrap();
    let lambda = [7.0, -4.0, 50.0, 2.0, -3.0, 1.0];
    for margin in stance.margins() {
        let (mut gradient, mut hessian) = ([0.0; 6], Matrix::zeros(6, 6));
        margin.add_gradient(&lambda, 1.5, &mut gradient);
        margin.add_hessian(&lambda, 1.5, &mut hessian);
        for (i, slope) in gradient.iter().enumerate() {
            for j in 0..6 {
                let mut seeds: Vec<HyperDual64> = lift(&lambda);
                seeds[i].eps1 = 1.0;
                seeds[j].eps2 = 1.0;
                let found = margin.value(&seeds);
                assert!((1.5 * found.eps1 - slope).abs() < 1e-14, "{}", margin.name());
                assert!((1.5 * found.eps1eps2 - hessian[(i, j)]).abs() < 1e-14, "{}", margin.name());
            }
        }
    }
}

#[test]
fn contacts_that_cannot_be_are_refused_by_name() {
    let refused = |contact: Contact, words: &str| {
        let error = Stance::new(&biped(), &[contact]).unwrap_err().to_string();
        assert!(error.contains("'left'") && error.contains(words), "{error}");
    };
    refused(toe("left").friction(-0.1), "friction");
    refused(toe("left").friction(f64::NAN), "friction");
    refused(toe("left").smoothing(0.0), "smoothing");
    refused(toe("left").torsion(0.1), "point");
    refused(toe("left").sole(Sole { x: [0.0, 0.1], y: [0.0, 0.1] }), "point");
    let foot = Contact::foot("left", "left_knee");
    refused(foot.clone().sole(Sole { x: [0.1, -0.1], y: [0.0, 0.1] }), "sole");
    refused(foot.torsion(-1.0), "torsion");
    let error = Stance::new(&biped(), &[Contact::point("left", "tail")]).unwrap_err().to_string();
    assert!(error.contains("'tail'"), "{error}");
}
