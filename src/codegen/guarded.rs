//! Programs that say whether their mass matrix was regular: `sum_k (s_k (M^-1)_kk)^2`.

use super::error::CodegenError;
use super::expr::Expr;
use super::program::Program;
use super::quantity::{Coordinates, Quantity};
use super::recording::limit_recording;
use super::robot::{Options, program_with};
use crate::error::EvalError;
use crate::kernels::{Factor, KernelOne};
use crate::matrix::Matrix;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// Below this, 2^84, the `guard` of a [`guarded_program`] says that M is regular.
pub const REGULAR: f64 = (1_u128 << 84) as f64;

/// Records a quantity of a robot for a compiler in process: [`robot_program`](super::robot_program), guarded.
///
/// Where M is inverted ([`Quantity::inverts`]) the last result is `guard`, one number: `sum_k (s_k (M^-1)_kk)^2`, where
/// `eps s_k` is the rounding of `M_kk`. With the pivots D_k of `M = L' D L`, each may consist of as much rounding as
/// `eps m_i`, and `sum_i m_i / D_i = sum_k s_k (M^-1)_kk`: below [`REGULAR`] no `m_i / D_i` exceeds 2^45, and the generic code
/// takes M for regular too (up to 64 joints). Elsewhere, and where the guard is not a number, M may be singular: ask the
/// generic code then. A quantity that contains M^-1 is three steps a joint longer for it, F and
/// energies by up to a third.
///
/// The recording is given up once it has more than `most` operations. It holds what the program leaves out in the end: up to
/// twice as many operations as the program has steps, more only for energies. Its memory is in proportion.
///
/// # Errors
/// [`CodegenError::Quantity`] where there is no such quantity in these coordinates, [`CodegenError::LongRecording`].
pub fn guarded_program(
    robot: &Robot,
    quantity: Quantity,
    coordinates: Coordinates,
    most: usize,
) -> Result<Program, CodegenError> {
    program_with(robot, quantity, coordinates, &Options::default(), |tree, q| {
        limit_recording(most);
        let guard = quantity.inverts(coordinates).then(|| guard(tree, q)).transpose()?;
        Ok(guard.into_iter().map(|guard| ("guard".into(), 1, 1, vec![guard])).collect())
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

    /// Three turning axes in one point: M is singular where the second is at a right angle.
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
        assert_eq!(count, 9);
    }

    #[test]
    fn a_recording_ends_at_its_limit() {
        let short = |most| guarded_program(&gimbal(), Quantity::FX, Coordinates::Hamiltonian, most);
        assert_eq!(short(50).unwrap_err(), CodegenError::LongRecording { limit: 50 });
        let steps = short(usize::MAX).unwrap().steps();
        assert_eq!(short(3 * steps).unwrap().steps(), steps);
    }
}
