//! Guesses in other coordinates.

use crate::extremal::legendre::{Legendre, OfRobot};
use crate::search::guess::{Guess, RobotGuess};
use crate::solve::crossings::Crossing;
use costate::robot::Robot;
use std::marker::PhantomData;

/// Guesses in the coordinates of E. Where the map fails, z is left in the old ones: that is a bad guess, and
/// Newton's method reports the error when it evaluates the dynamics at the same pose.
pub(crate) struct Mapped<'a, E> {
    pub guess: RobotGuess<'a>,
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

    fn saved_duration(&self) -> Option<f64> {
        self.guess.saved_duration()
    }

    fn saved_mesh(&self) -> Option<Vec<f64>> {
        self.guess.saved_mesh()
    }

    fn saved_crossings(&self) -> Vec<Crossing> {
        self.guess.saved_crossings()
    }

    fn forget_saved(&mut self) {
        self.guess.forget_saved();
    }

    fn is_replaceable(&self) -> bool {
        self.guess.is_replaceable()
    }
}
