//! Between the coordinates of a search and those of a saved motion.

use crate::extremal::Extremal;
use crate::extremal::hamiltonian::RobotExtremal;
use crate::extremal::lagrangian::LagrangianExtremal;
use crate::path::Wish;
use crate::search::Guess;
use crate::search::guess::RobotGuess;
use crate::solve::Context;
use costate::EvalError;
use costate::lagrangian::LegendreTransform;
use costate::robot::Robot;
use std::marker::PhantomData;

/// An extremal of a robot in coordinates of its own; guesses and saved motions are in z = (q, p, y_q, y_p).
pub(crate) trait OfRobot: Extremal {
    /// From (q, p, y_q, y_p) into its own coordinates, in place.
    ///
    /// # Errors
    /// A singular mass matrix.
    fn take(map: &mut Legendre, z: &mut [f64]) -> Result<(), EvalError>;

    /// From its own coordinates into (q, p, y_q, y_p), in place; of x alone where there is no more.
    ///
    /// # Errors
    /// A singular mass matrix.
    fn give(map: &mut Legendre, z: &mut [f64]) -> Result<(), EvalError>;
}

/// `p = M v`, `y_v = M y_p`, `y_q(q, v) = y_q(q, p) + P'y_p` with P = d(M v)/dq.
pub(crate) struct Legendre {
    map: LegendreTransform<f64>,
    none: Vec<f64>,
}

impl Legendre {
    pub fn new(robot: &Robot) -> Self {
        Self { map: LegendreTransform::new(robot), none: vec![0.0; robot.len()] }
    }
}

impl OfRobot for RobotExtremal {
    fn take(_: &mut Legendre, _: &mut [f64]) -> Result<(), EvalError> {
        Ok(())
    }

    fn give(_: &mut Legendre, _: &mut [f64]) -> Result<(), EvalError> {
        Ok(())
    }
}

impl OfRobot for LagrangianExtremal {
    fn take(map: &mut Legendre, z: &mut [f64]) -> Result<(), EvalError> {
        let n = map.none.len();
        let (x, y) = z.split_at_mut(2 * n);
        let mut at = map.map.at_momentum(&x[..n], &x[n..], &map.none)?;
        at.costate_to_lagrangian(y)?;
        x[n..].copy_from_slice(at.velocity());
        Ok(())
    }

    fn give(map: &mut Legendre, z: &mut [f64]) -> Result<(), EvalError> {
        let n = map.none.len();
        let (x, y) = z.split_at_mut(2 * n);
        let mut at = map.map.at(&x[..n], &x[n..], &map.none)?;
        if !y.is_empty() {
            at.costate_to_hamiltonian(y)?;
        }
        x[n..].copy_from_slice(at.momentum());
        Ok(())
    }
}

/// Guesses in the coordinates of E. Where these do not exist, what is left is no solution, and Newton's method, which meets the
/// same pose, says what is wrong with it.
pub(crate) struct Mapped<'a, E> {
    guess: RobotGuess<'a>,
    pub map: Legendre,
    coordinates: PhantomData<E>,
}

impl<'a, E: OfRobot> Mapped<'a, E> {
    pub fn new(guess: RobotGuess<'a>, robot: &Robot) -> Self {
        Self { guess, map: Legendre::new(robot), coordinates: PhantomData }
    }
}

impl<E: OfRobot> Guess for Mapped<'_, E> {
    fn simple(&mut self, goal: f64, s: f64, z: &mut [f64]) {
        self.guess.simple(goal, s, z);
        let _ = E::take(&mut self.map, z);
    }

    fn saved(&self) -> Option<f64> {
        self.guess.saved()
    }

    fn find_path(&mut self, wish: Wish, context: &mut Context<'_>) -> Option<(f64, f64)> {
        self.guess.find_path(wish, context)
    }

    fn path(&mut self, s: f64, z: &mut [f64]) {
        self.guess.path(s, z);
        let _ = E::take(&mut self.map, z);
    }
}
