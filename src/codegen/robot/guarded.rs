//! Programs that tell whether the mass matrix was regular, by `sum_k (s_k (M^-1)_kk)^2`.

use super::options::ProgramOptions;
use super::program::program_with;
use super::quantity::{Coordinates, Quantity};
use crate::codegen::error::CodegenError;
use crate::codegen::program::Program;
use crate::codegen::program_ends::RecordedResult;
use crate::codegen::record::Expr;
use crate::error::EvalError;
use crate::kernels::{Factor, KernelOne};
use crate::matrix::Matrix;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// M is regular where the `guard` of a [`guarded_program`] is below this, 2^84.
pub const REGULAR: f64 = (1_u128 << 84) as f64;

/// Records a quantity of a robot for a just-in-time compiler: [`robot_program`](super::robot_program) with a
/// guard, at most `limit` steps long.
///
/// Where M is inverted ([`Quantity::inverts`]) the last result is `guard`, one number: `sum_k (s_k
/// (M^-1)_kk)^2`, where `eps s_k` is the rounding error of `M_kk`. With the pivots D_k of `M = L' D L`, each
/// with a rounding error up to `eps m_i`, `sum_i m_i / D_i = sum_k s_k (M^-1)_kk`: below [`REGULAR`] no `m_i
/// / D_i` exceeds 2^45, and the generic code accepts M as regular too (up to 64 joints). Otherwise, and where
/// the guard is not a number, M may be singular, and the generic code must decide. The guard adds three steps
/// a joint to a quantity that contains M^-1, and up to a third to F and energies; where the quantity has M in
/// the axes of the world, as second derivatives in (q, v) of long chains in general directions, M in body
/// frames and its inverse too.
///
/// # Errors
/// [`CodegenError::Quantity`] where the quantity is not defined in these coordinates;
/// [`CodegenError::LargeRobot`], [`CodegenError::LongRecording`] and [`CodegenError::TooLarge`] where the
/// program has more steps than the limit.
pub fn guarded_program(
    robot: &Robot,
    quantity: Quantity,
    coordinates: Coordinates,
    limit: usize,
) -> Result<Program, CodegenError> {
    let options = ProgramOptions::default().with_limit(limit);
    program_with(robot, quantity, coordinates, &options, |tree, q| {
        let guard = quantity.inverts(coordinates).then(|| guard(tree, q)).transpose()?;
        Ok(guard.into_iter().map(|guard| RecordedResult::vector("guard", vec![guard])).collect())
    })
}

/// `sum_k (s_k (M^-1)_kk)^2` at q.
fn guard(tree: &Tree, q: &[Expr]) -> Result<Expr, CodegenError> {
    let n = tree.dof();
    let (mut kernel, mut factor) = (KernelOne::<Expr>::new(tree), Factor::new(tree));
    kernel.set_position(tree, q)?;
    let size_of = |k| kernel.size_of_entry(tree, k);
    let singular = |k| EvalError::SingularMassMatrix { joint: tree.name(k).into() };
    factor.factor(kernel.mass_matrix(), size_of).map_err(singular)?;
    let mut inverse = Matrix::zeros(n, n);
    factor.inverse(&mut inverse);
    let ratios = (0..n).map(|k| size_of(k) * inverse[(k, k)]);
    Ok(ratios.fold(Expr::zero(), |sum, ratio| ratio.mul_add(ratio, sum)))
}

#[cfg(test)]
mod tests {
    use super::{REGULAR, guarded_program};
    use crate::codegen::{CodegenError, Coordinates, Quantity};
    use crate::hamiltonian::Hamiltonian;
    use crate::kernels::KernelOne;
    use crate::robot::{Robot, Tree, file};
    use std::f64::consts::FRAC_PI_2;

    /// Three revolute axes through one point: M is singular where the second is at a right angle.
    fn gimbal() -> Robot {
        let text = "name = 'gimbal'\n\
            [[joint]]\nname = 'z'\naxis = [0.0, 0.0, 1.0]\n\
            [[joint]]\nname = 'y'\naxis = [0.0, 1.0, 0.0]\n\
            [[joint]]\nname = 'x'\naxis = [1.0, 0.0, 0.0]\nmass = 1.0\ninertia = { xx = 0.2, yy = 0.3, zz = 0.4 }\n";
        file::parse(text, Default::default()).unwrap()
    }

    /// The last result at q, everything else of the state 0.1.
    fn guard(quantity: Quantity, coordinates: Coordinates, q: [f64; 3]) -> Option<f64> {
        let program = guarded_program(&gimbal(), quantity, coordinates, usize::MAX).ok()?;
        let inputs = [q.as_slice(), &vec![0.1; program.inputs() - 3]].concat();
        let mut outputs = vec![0.0; program.outputs()];
        program.evaluate(&inputs, &mut outputs, &mut Vec::new()).unwrap();
        let guarded = program.results().last().is_some_and(|result| result.name == "guard");
        assert_eq!(guarded, quantity.inverts(coordinates), "{}", program.name());
        guarded.then(|| outputs[outputs.len() - 1])
    }

    #[test]
    fn the_guard_of_every_quantity_tells_singular_from_regular_poses() {
        let (tree, q) = (Tree::from(&gimbal()), [0.3, 0.9, -0.7]);
        let inverse = Hamiltonian::<f64>::from_tree(tree.clone()).inverse_mass_matrix(&q).unwrap().clone();
        let mut kernel = KernelOne::<f64>::new(&tree);
        kernel.set_position(&tree, &q).unwrap();
        let expected: f64 = (0..3).map(|k| (kernel.size_of_entry(&tree, k) * inverse[(k, k)]).powi(2)).sum();
        let mut count = 0;
        for coordinates in [Coordinates::Hamiltonian, Coordinates::Lagrangian] {
            for quantity in Quantity::ALL {
                let Some(found) = guard(quantity, coordinates, q) else { continue };
                assert!((found - expected).abs() < 1e-12 * expected && found < REGULAR, "{found}");
                let singular = guard(quantity, coordinates, [0.3, FRAC_PI_2, -0.7]).unwrap();
                assert!(singular.is_nan() || singular >= REGULAR, "{singular}");
                count += 1;
            }
        }
        assert_eq!(count, 10);
    }

    #[test]
    fn a_recording_stops_at_its_limit() {
        let within = |limit| guarded_program(&gimbal(), Quantity::FX, Coordinates::Hamiltonian, limit);
        let name = String::from("gimbal_hamiltonian_f_x");
        let stopped = CodegenError::LongRecording { name: name.clone(), operations: 40, limit: 10 };
        assert_eq!(within(10).unwrap_err(), stopped);
        let steps = within(usize::MAX).unwrap().steps();
        assert_eq!(within(steps).unwrap().steps(), steps);
        let too_large = CodegenError::TooLarge { name, steps, limit: steps - 1 };
        assert_eq!(within(steps - 1).unwrap_err(), too_large);
        let large = CodegenError::LargeRobot { robot: "gimbal".into(), joints: 3, entries: 6, limit: 1 };
        assert_eq!(within(1).unwrap_err(), large);
    }
}
