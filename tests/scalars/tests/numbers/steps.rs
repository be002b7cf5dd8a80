//! Every scalar goes through every scheme.

use costate::derivative::{Function, largest};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::scalar::{Count, Scalar, Tangent};
use costate::step::{
    Classical, HamiltonianRobot, ImplicitMidpoint, LagrangianRobot, Midpoint, ModelFamily, OneStep, Scheme,
    SemiImplicit, Step, StoermerVerlet, Verlet,
};
use costate_test_support::random_robot::difference;
use costate_test_support::robots;
use num_dual::{
    Dual, Dual2, Dual2_64, Dual2SVec64, Dual3_64, Dual32, Dual64, DualSVec64, HyperDual, HyperDual64,
    HyperDualSVec64, HyperHyperDual64,
};

/// (q, p) of the two-link arm on a free swing.
const SWING: [f64; 4] = [0.3, -0.8, 1.0, 0.5];

fn next<S: Scalar, F: ModelFamily, M: Scheme<F>>(family: F) -> Vec<S> {
    let function = OneStep::<F, M>::new(family);
    let z = SWING.into_iter().chain([0.2, -0.1, 0.05]).map(S::from_f64).collect::<Vec<_>>();
    let mut next = vec![S::zero(); 4];
    function.evaluate(&mut function.workspace(), &z, &mut next).unwrap();
    next
}

/// The real part is the result in `f64`, within `units` of the last place.
fn real_part_is_the_result_in_f64<S: Scalar>(re: impl Fn(&S) -> f64, units: f64) {
    let arm = robots::file("two_link.toml");
    let check = |found: Vec<S>, expected: Vec<f64>| {
        let found: Vec<f64> = found.iter().map(&re).collect();
        assert!(difference(&found, &expected) <= units * S::EPSILON, "{found:?} {expected:?}");
    };
    let (momenta, velocities) = (|| HamiltonianRobot::from(&arm), || LagrangianRobot::from(&arm));
    check(next::<_, _, Classical>(momenta()), next::<_, _, Classical>(momenta()));
    check(next::<_, _, Verlet>(momenta()), next::<_, _, Verlet>(momenta()));
    check(next::<_, _, Midpoint>(momenta()), next::<_, _, Midpoint>(momenta()));
    check(next::<_, _, SemiImplicit>(velocities()), next::<_, _, SemiImplicit>(velocities()));
    check(next::<_, _, Midpoint>(velocities()), next::<_, _, Midpoint>(velocities()));
}

#[test]
fn every_number_goes_through_every_scheme() {
    real_part_is_the_result_in_f64::<Dual64>(|x| x.re, 8.0);
    real_part_is_the_result_in_f64::<Dual2_64>(|x| x.re, 8.0);
    real_part_is_the_result_in_f64::<Dual3_64>(|x| x.re, 8.0);
    real_part_is_the_result_in_f64::<HyperDual64>(|x| x.re, 8.0);
    real_part_is_the_result_in_f64::<HyperHyperDual64>(|x| x.re, 8.0);
    real_part_is_the_result_in_f64::<DualSVec64<4>>(|x| x.re, 8.0);
    real_part_is_the_result_in_f64::<Dual2SVec64<3>>(|x| x.re, 8.0);
    real_part_is_the_result_in_f64::<HyperDualSVec64<2, 3>>(|x| x.re, 8.0);
    real_part_is_the_result_in_f64::<Dual<HyperDual64>>(|x| x.re.re, 8.0);
    real_part_is_the_result_in_f64::<Dual2<Dual64>>(|x| x.re.re, 8.0);
    real_part_is_the_result_in_f64::<Tangent<Tangent<f64>>>(|x| x.re.re, 8.0);
    real_part_is_the_result_in_f64::<Count>(|x| x.value(), 8.0);
    real_part_is_the_result_in_f64::<Tangent<Count>>(|x| x.re.value(), 8.0);
    real_part_is_the_result_in_f64::<HyperDual<Count>>(|x| x.re.value(), 8.0);
    real_part_is_the_result_in_f64::<f32>(|&x| f64::from(x), 100.0);
    real_part_is_the_result_in_f64::<Dual32>(|x| f64::from(x.re), 100.0);
}

/// x along a line, to be differentiated in its parameter t at 0.
fn along_a_line<S: Scalar, M: Scheme<HamiltonianRobot>>(t: S) -> Vec<S> {
    let mut step = M::step::<S>(HamiltonianRobot::from(&robots::file("two_link.toml")).model());
    let x: Vec<S> = [0.7, -0.3, 0.4, 0.9].iter().zip(SWING).map(|(&d, x)| t.times(d).plus(x)).collect();
    let u = [t.times(0.3).plus(0.2), S::from_f64(-0.1)];
    step.evaluate(&x, &u, t.times(0.1).plus(0.1)).unwrap().to_vec()
}

/// Derivatives of third order through Newton's method are those through the formulas of the second order.
#[test]
fn derivatives_of_third_order_converge_too() {
    fn agree<M: Scheme<HamiltonianRobot>>() {
        let third = along_a_line::<_, M>(Dual3_64::from_re(0.0).derivative());
        let seed =
            Dual::new(Dual::new(Dual64::new(0.0, 1.0), Dual64::from(1.0)), Dual::from_re(Dual64::from(1.0)));
        let nested = along_a_line::<Dual<Dual<Dual64>>, M>(seed);
        let hyper =
            along_a_line::<_, M>(HyperHyperDual64::from_re(0.0).derivative1().derivative2().derivative3());
        let tangents = along_a_line::<_, M>(Tangent::new(
            HyperDual64::from_re(0.0).derivative1().derivative2(),
            Scalar::one(),
        ));
        let expected: Vec<f64> = third.iter().map(|x| x.v3).collect();
        assert!(largest(&expected) > 1e-3);
        let found = [
            nested.iter().map(|x| x.eps.eps.eps).collect::<Vec<_>>(),
            hyper.iter().map(|x| x.eps1eps2eps3).collect(),
            tangents.iter().map(|x| x.eps.eps1eps2).collect(),
        ];
        assert!(found.iter().all(|found| difference(found, &expected) < 1e-12), "{found:?} {expected:?}");
    }
    agree::<Classical>();
    agree::<Verlet>();
    agree::<Midpoint>();
}

/// The contracted Hessian of a step can itself be differentiated: beside a central difference of it.
#[test]
fn contractions_nest() {
    fn hessian<S: Scalar>(shift: S) -> Vec<S> {
        let arm = robots::file("two_link.toml");
        let mut x = SWING.map(S::from_f64);
        x[2] += shift;
        let (u, y, h) = ([S::from_f64(0.2); 2], SWING.map(S::from_f64), S::from_f64(0.1));
        let mut verlet = StoermerVerlet::new(HamiltonianSecondOrder::<S>::new(&arm));
        let mut midpoint = ImplicitMidpoint::new(HamiltonianSecondOrder::<S>::new(&arm));
        let verlet = verlet.contract(&x, &u, h, &y).unwrap();
        let midpoint = midpoint.contract(&x, &u, h, &y).unwrap();
        [Some(verlet.xx), verlet.ux, Some(midpoint.xx), midpoint.ux]
            .iter()
            .flatten()
            .flat_map(|b| b.iter_rows().flatten().copied())
            .collect()
    }
    let dual: Vec<f64> = hessian(Dual64::new(0.0, 1.0)).iter().map(|x| x.eps).collect();
    let (ahead, behind) = (hessian(1e-5), hessian(-1e-5));
    let central: Vec<f64> = ahead.iter().zip(behind).map(|(a, b)| (a - b) / 2e-5).collect();
    assert!(difference(&dual, &central) < 1e-7, "{:.1e}", difference(&dual, &central));
}
