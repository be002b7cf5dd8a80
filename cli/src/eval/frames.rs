//! The key `frames`: poses, Jacobians and contracted second derivatives of frames.

use super::line::Answer;
use super::request::Request;
use super::route::Route;
use costate::configuration::FreeKinematics;
use costate::derivative::{FrameMotion, Function, Hessian, Jacobian, NestedHessian};
use costate::kinematics::ReferenceFrame;
use costate::matrix::Matrix;
use costate::robot::Robot;
use serde_json::{Value, json};

/// A Jacobian, 6 x n, and `w'x_qq`, n x n, if it is asked for.
type Derivatives = (Matrix<f64>, Option<Matrix<f64>>);

/// Workspaces for the frames of one robot.
pub struct Frames {
    robot: Robot,
    kinematics: FreeKinematics<f64>,
    route: Route,
}

impl Frames {
    pub fn new(robot: &Robot, route: Route) -> Self {
        // Functions of frames take no quaternions.
        let route = if robot.free_joints().is_empty() { route } else { Route::Analytic };
        Self { robot: robot.clone(), kinematics: FreeKinematics::new(robot), route }
    }

    /// Adds the key `frames` to the answer to a state.
    pub fn answer(
        &mut self,
        q: &[f64],
        requests: &[Request],
        answer: &mut Answer,
    ) -> Result<(), Box<dyn std::error::Error>> {
        self.kinematics.set_position(q)?;
        let frames = requests.iter().map(|request| self.frame(q, request)).collect::<Result<_, _>>()?;
        answer.value("frames", Value::Array(frames));
        Ok(())
    }

    fn frame(&mut self, q: &[f64], request: &Request) -> Result<Value, Box<dyn std::error::Error>> {
        let Request { frame, name, axes: (axes, convention), w } = request;
        let pose = self.kinematics.pose(*frame)?;
        let (jacobian, curvature) = self.derivatives(q, *frame, *convention, w.as_ref())?;
        let mut value = json!({
            "name": name, "axes": axes, "position": pose.position, "rotation": pose.rotation,
            "jacobian": rows(&jacobian),
        });
        if let (Some(w), Some(curvature), Value::Object(fields)) = (w, curvature, &mut value) {
            fields.insert("w".into(), json!(w));
            fields.insert("w_x_qq".into(), rows(&curvature));
        }
        Ok(value)
    }

    /// The Jacobian, 6 x n, and `w'x_qq`, by the method that was asked for; `tensors` and `jit` are about
    /// dynamics, and here the same as `analytic`.
    fn derivatives(
        &mut self,
        q: &[f64],
        frame: usize,
        axes: ReferenceFrame,
        w: Option<&[f64; 3]>,
    ) -> Result<Derivatives, Box<dyn std::error::Error>> {
        let function = || FrameMotion::new(&self.robot, frame, axes);
        let state = [q, &vec![0.0; q.len()]].concat();
        let weights = w.map(|w| [&w[..], &[0.0; 6]].concat());
        match self.route {
            Route::Dual => {
                let mut jacobian: Jacobian<_> = Jacobian::new(function());
                let first = by_velocities(jacobian.linearise(&state)?.jacobian, q.len());
                let mut nested = NestedHessian::new(function());
                let second =
                    weights.map(|weights| nested.contract(&state, &weights).map(|h| corner(h, q.len())));
                Ok((first, second.transpose()?))
            }
            Route::Hyperdual => {
                let mut hessian = Hessian::new(function());
                hessian.contract(&state, &weights.unwrap_or_else(|| vec![0.0; function().outputs()]))?;
                let second = w.map(|_| corner(hessian.last_contraction(), q.len()));
                Ok((by_velocities(hessian.last().jacobian(), q.len()), second))
            }
            _ => {
                let jacobian = self.kinematics.jacobian(frame, axes)?.clone();
                let second = w.map(|w| self.kinematics.position_hessian(frame, w).cloned());
                Ok((jacobian, second.transpose()?))
            }
        }
    }
}

/// The derivative of the twist by v.
fn by_velocities(jacobian: &Matrix<f64>, n: usize) -> Matrix<f64> {
    let rows: Vec<f64> = (3..9).flat_map(|k| jacobian.row(k)[n..].iter().copied()).collect();
    Matrix::from_rows(n, &rows)
}

/// The first n rows and columns.
fn corner(hessian: &Matrix<f64>, n: usize) -> Matrix<f64> {
    let rows: Vec<f64> = (0..n).flat_map(|i| hessian.row(i)[..n].iter().copied()).collect();
    Matrix::from_rows(n, &rows)
}

fn rows(matrix: &Matrix<f64>) -> Value {
    matrix.view().iter_rows().map(Value::from).collect()
}
