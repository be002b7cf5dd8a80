//! By how much contact forces are inside their limits.

use super::contact::{Contact, Sole};
use crate::matrix::Matrix;
use crate::robot::ConstraintRow;
use crate::scalar::Scalar;
use std::ops::Range;

/// What a margin measures: c >= 0 says that the contact bears its force f and moment m in one respect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MarginKind {
    /// `c = f_z`: the ground does not pull (N).
    Normal,
    /// `c = mu f_z - sqrt(f_x^2 + f_y^2 + d^2)` with the coefficient of friction mu: no sliding (N). It is
    /// smooth and concave. The force d of [`Contact::smoothing`](super::Contact::smoothing) makes the cone
    /// narrower by at most d, never wider: c >= 0 means `|(f_x, f_y)| < mu f_z`, and f_z of at least d / mu.
    Friction,
    /// `c = mu f_z - f_x` for a planar contact (N).
    FrictionForward,
    /// `c = mu f_z + f_x` for a planar contact (N).
    FrictionBackward,
    /// `c = f_z x_most + m_y`: the centre of pressure `(-m_y / f_z, m_x / f_z)` is not in front of the sole
    /// (N m).
    Front,
    /// `c = -f_z x_least - m_y`: nor behind it (N m).
    Back,
    /// `c = f_z y_most - m_x`: nor to its left (N m).
    Left,
    /// `c = -f_z y_least + m_x`: nor to its right (N m).
    Right,
    /// `c = l f_z - m_z` with l of [`Contact::torsion`](super::Contact::torsion): no turning (N m).
    TwistLeft,
    /// `c = l f_z + m_z` (N m).
    TwistRight,
}

impl MarginKind {
    fn words(self) -> &'static str {
        match self {
            Self::Normal => "normal force",
            Self::Friction => "friction",
            Self::FrictionForward => "friction forward",
            Self::FrictionBackward => "friction backward",
            Self::Front => "centre of pressure in front",
            Self::Back => "centre of pressure behind",
            Self::Left => "centre of pressure to the left",
            Self::Right => "centre of pressure to the right",
            Self::TwistLeft => "torsion to the left",
            Self::TwistRight => "torsion to the right",
        }
    }
}

/// By how much the force of one contact is inside one of its limits: a function c(lambda) of the multipliers
/// of the stance, c >= 0 inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Margin {
    contact: usize,
    name: String,
    kind: MarginKind,
    form: Form,
}

/// A function of the multipliers, by their numbers.
#[derive(Clone, Debug, PartialEq)]
enum Form {
    Linear(Vec<(usize, f64)>),
    Cone { along: [usize; 2], normal: usize, friction: f64, smoothing: f64 },
}

impl Margin {
    /// The margins of one contact, whose multipliers are `rows` of those of the stance.
    pub(super) fn of(index: usize, contact: &Contact, rows: &Range<usize>) -> Vec<Self> {
        use ConstraintRow::{TurnX, TurnY, TurnZ, X, Y, Z};
        let at = |row: ConstraintRow| {
            contact.rows().iter().position(|&other| other == row).map(|place| rows.start + place)
        };
        // Every contact holds x and z.
        let (Some(x), Some(z)) = (at(X), at(Z)) else { return Vec::new() };
        let mut margins = Vec::new();
        let mut push = |kind: MarginKind, form: Form| {
            let name = format!("{}: {}", contact.name(), kind.words());
            margins.push(Self { contact: index, name, kind, form });
        };
        let linear = |normal: f64, other: Option<usize>, factor: f64| {
            let other = other.map(|other| (other, factor));
            Form::Linear([(z, normal)].into_iter().chain(other).collect())
        };
        push(MarginKind::Normal, linear(1.0, None, 0.0));
        if let Some(friction) = contact.friction {
            match at(Y) {
                Some(y) => {
                    let smoothing = contact.smoothing;
                    push(MarginKind::Friction, Form::Cone { along: [x, y], normal: z, friction, smoothing });
                }
                None => {
                    push(MarginKind::FrictionForward, linear(friction, Some(x), -1.0));
                    push(MarginKind::FrictionBackward, linear(friction, Some(x), 1.0));
                }
            }
        }
        if let Some(Sole { x: [back, front], y: [right, left] }) = contact.sole {
            push(MarginKind::Front, linear(front, at(TurnY), 1.0));
            push(MarginKind::Back, linear(-back, at(TurnY), -1.0));
            if let Some(about_x) = at(TurnX) {
                push(MarginKind::Left, linear(left, Some(about_x), -1.0));
                push(MarginKind::Right, linear(-right, Some(about_x), 1.0));
            }
        }
        if let (Some(length), Some(about_z)) = (contact.torsion, at(TurnZ)) {
            push(MarginKind::TwistLeft, linear(length, Some(about_z), -1.0));
            push(MarginKind::TwistRight, linear(length, Some(about_z), 1.0));
        }
        margins
    }

    /// Which contact of the stance.
    pub fn contact(&self) -> usize {
        self.contact
    }

    /// `CONTACT: what it measures`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it measures.
    pub fn kind(&self) -> MarginKind {
        self.kind
    }

    /// c(lambda), for all multipliers of the stance.
    pub fn value<S: Scalar>(&self, lambda: &[S]) -> S {
        match &self.form {
            Form::Linear(terms) => {
                terms.iter().fold(S::zero(), |sum, &(row, factor)| sum.plus_times(lambda[row], factor))
            }
            Form::Cone { along, normal, friction, smoothing } => {
                lambda[*normal].times(*friction) - Self::tangential(lambda, *along, *smoothing)
            }
        }
    }

    /// `sqrt(f_x^2 + f_y^2 + d^2)`.
    fn tangential<S: Scalar>(lambda: &[S], along: [usize; 2], smoothing: f64) -> S {
        let [x, y] = along.map(|row| lambda[row]);
        (x * x + y * y).plus(smoothing * smoothing).sqrt()
    }

    /// Adds weight times c_lambda.
    pub fn add_gradient<S: Scalar>(&self, lambda: &[S], weight: S, gradient: &mut [S]) {
        match &self.form {
            Form::Linear(terms) => {
                terms.iter().for_each(|&(row, factor)| gradient[row] += weight.times(factor));
            }
            Form::Cone { along, normal, friction, smoothing } => {
                gradient[*normal] += weight.times(*friction);
                let factor = weight * Self::tangential(lambda, *along, *smoothing).recip();
                along.iter().for_each(|&row| gradient[row] -= factor * lambda[row]);
            }
        }
    }

    /// Adds weight times the second derivatives: `(t t' - 1) / s` on the tangential forces of a cone, with `s
    /// = sqrt(f_x^2 + f_y^2 + d^2)` and `t = (f_x, f_y) / s`.
    pub fn add_hessian<S: Scalar>(&self, lambda: &[S], weight: S, hessian: &mut Matrix<S>) {
        let Form::Cone { along, smoothing, .. } = &self.form else { return };
        let inverse = Self::tangential(lambda, *along, *smoothing).recip();
        let factor = weight * inverse;
        for &i in along {
            hessian[(i, i)] -= factor;
            for &j in along {
                hessian[(i, j)] += factor * (lambda[i] * inverse) * (lambda[j] * inverse);
            }
        }
    }
}
