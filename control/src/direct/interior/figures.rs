//! Figures of an iterate.

/// What an iterate costs, and how far it is from a solution.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Figures {
    pub cost: f64,
    /// Size of the cost, for tolerances: the integral of the magnitudes of its parts, no less than that of a
    /// small motion.
    pub size: f64,
    /// Sum of slack times multiplier.
    pub gap: f64,
    /// Largest violation of a limit or an equation, in parts of its range.
    pub violation: f64,
    /// The same of equations alone.
    pub equations: f64,
    /// Newton decrement: twice the change of cost that the next step promises.
    pub decrement: f64,
    /// The same without second derivatives of torques, of a solved motion whose torques cost something: by
    /// about as much it may cost too much; 0 where that is not known.
    pub shortfall: f64,
    pub iterations: usize,
    /// Whether the matrix of the last step, with exact second derivatives, was positive definite without
    /// damping.
    pub is_minimum: bool,
}
