//! The motion of a frame as a function for automatic differentiation.

use super::function::Function;
use crate::error::{EvalError, check_length};
use crate::kinematics::{Kinematics, ReferenceFrame};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// `(q, v) -> (x, V)`: position of the origin of a frame and its twist, from 2n inputs to 9 outputs.
///
/// The derivative of V by v is the Jacobian of the frame.
#[derive(Clone, Debug)]
pub struct FrameMotion {
    tree: Tree,
    /// Position of the frame in [`Robot::frames`].
    pub frame: usize,
    /// The convention of the twist.
    pub axes: ReferenceFrame,
}

impl FrameMotion {
    /// For the frame of this number.
    pub fn new(robot: &Robot, frame: usize, axes: ReferenceFrame) -> Self {
        Self { tree: Tree::from(robot), frame, axes }
    }
}

impl Function for FrameMotion {
    type Workspace<S: Scalar> = Kinematics<S>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn outputs(&self) -> usize {
        9
    }

    fn workspace<S: Scalar>(&self) -> Kinematics<S> {
        Kinematics::from_tree(self.tree.clone())
    }

    fn evaluate<S: Scalar>(
        &self,
        kinematics: &mut Kinematics<S>,
        z: &[S],
        outputs: &mut [S],
    ) -> Result<(), EvalError> {
        check_length("z", z, self.inputs())?;
        check_length("outputs", outputs, self.outputs())?;
        let (q, v) = z.split_at(self.tree.dof());
        kinematics.set_state(q, v)?;
        let twist = kinematics.twist(self.frame, self.axes)?;
        let parts = [kinematics.pose(self.frame)?.position].into_iter();
        let parts = parts.chain([twist.angular, twist.linear].map(Vec3::to_array));
        for (outputs, part) in outputs.chunks_exact_mut(3).zip(parts) {
            outputs.copy_from_slice(&part);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::derivative::Hessian;

    #[test]
    fn derivatives_are_those_of_the_workspace() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/robots/cart_pole.toml");
        let robot = Robot::from_file(file).unwrap();
        let frame = robot.frames().len() - 1;
        let mut hessian = Hessian::new(FrameMotion::new(&robot, frame, ReferenceFrame::Local));
        let mut kinematics = Kinematics::<f64>::new(&robot);
        kinematics.set_position(&[0.3, -0.8]).unwrap();
        let second = hessian.hessian_tensor(&[0.3, -0.8, 0.0, 0.0]).unwrap();
        let jacobian = kinematics.jacobian(frame, ReferenceFrame::Local).unwrap();
        for k in 0..6 {
            for j in 0..2 {
                assert!((second.jacobian()[(3 + k, 2 + j)] - jacobian[(k, j)]).abs() < 1e-15, "{k}, {j}");
            }
        }
        let curvature = kinematics.position_hessian(frame, &[1.0, 2.0, 3.0]).unwrap();
        let expected: f64 = (0..3).map(|k| (k + 1) as f64 * second.entry(k, 1, 1)).sum();
        assert!((curvature[(1, 1)] - expected).abs() < 1e-15);
    }
}
