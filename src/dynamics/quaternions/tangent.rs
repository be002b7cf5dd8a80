//! One joint: between its entries and the tangent space, to first order.

use super::local::{Local, Parts};
use super::turn::{Momenta, Turn};
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// With (theta, rho) the rotation vector and the displacement of the tangent, and (e_v, e_pi) what is added
/// to the momenta, to second order in a change of x
///
/// $$ \rho = d - w \times d, \qquad \theta = 2 w - 2 s w, \qquad
///    e\_v = \exp(-\theta)\\, (p\_v + g) - p\_v, $$
/// $$ e\_\pi = c + s\\, \pi - \sigma w - w \times \pi + s\\, c - k w - w \times c $$
///
/// with conjugate momenta, e_v = g and e_pi = c without. The rates (v, omega) and (phi, psi) of momenta are
/// rates of x by
///
/// $$ d = v, \quad (w, s) = \tfrac12 (\omega, 0), \quad g = \varphi + \omega \times p\_v, \quad
///    (c, k) = (\psi, 0) + \tfrac12 (\omega, 0) \circ (\pi, \sigma) $$
///
/// and without conjugate momenta by g = phi, c = psi.
impl<S: Scalar> Turn<S> {
    /// (rho, theta, e_v, e_pi) to first order.
    pub fn tangent(&self, change: &Local<S>) -> Parts<S> {
        let Local { d, w, s, g, c, .. } = *change;
        let twice = w.times(2.0);
        match self.momenta {
            None => [d, twice, g, c],
            Some(Momenta { linear, angular, along }) => {
                let turned = angular.scaled(s) - w.scaled(along) - w.cross(angular);
                [d, twice, g - twice.cross(linear), c + turned]
            }
        }
    }

    /// The costate of x of a costate of the tangent space: the transpose of [`tangent`](Self::tangent).
    pub fn pulled(&self, [of_d, of_turn, of_g, of_c]: Parts<S>) -> Local<S> {
        let mut y = Local { d: of_d, w: of_turn.times(2.0), s: S::zero(), g: of_g, c: of_c, k: S::zero() };
        if let Some(Momenta { linear, angular, along }) = self.momenta {
            y.w = y.w + of_g.cross(linear).times(2.0) + of_c.cross(angular) - of_c.scaled(along);
            y.s = of_c.dot(angular);
        }
        y
    }

    /// Rates of x from those of the tangent space.
    pub fn rate(&self, [v, omega, phi, psi]: Parts<S>) -> Local<S> {
        let mut rate = Local { d: v, w: omega.times(0.5), s: S::zero(), g: phi, c: psi, k: S::zero() };
        if let Some(Momenta { linear, angular, along }) = self.momenta {
            rate.g = phi + omega.cross(linear);
            rate.c = psi + (omega.scaled(along) + omega.cross(angular)).times(0.5);
            rate.k = -omega.dot(angular).times(0.5);
        }
        rate
    }

    /// What a change of x adds to the entries of these rates, to first order.
    pub fn rate_slope(&self, [v, omega, phi, psi]: Parts<S>, change: &Local<S>) -> Local<S> {
        let Local { w, s, g, c, k, .. } = *change;
        let zero = Vec3::zero();
        let mut slope = Local {
            d: w.cross(v).times(2.0),
            w: (omega.scaled(s) + w.cross(omega)).times(0.5),
            s: -w.dot(omega).times(0.5),
            g: zero,
            c: zero,
            k: S::zero(),
        };
        if let Some(Momenta { linear, angular, along }) = self.momenta {
            let turned = w.cross(omega).times(2.0);
            slope.g = w.cross(phi).times(2.0) + turned.cross(linear) + omega.cross(g);
            let whole = turned.scaled(along) + turned.cross(angular) + omega.scaled(k) + omega.cross(c);
            slope.c = whole.times(0.5) + w.cross(psi) - psi.scaled(s);
            slope.k = -(turned.dot(angular) + omega.dot(c)).times(0.5) - w.dot(psi);
        }
        slope
    }

    /// The costate of the tangent space of a costate of x: the transpose of [`rate`](Self::rate).
    pub fn costate(&self, y: &Local<S>) -> Parts<S> {
        [y.d, y.w.times(0.5) + self.moment(y), y.g, y.c]
    }

    /// What a change of x adds to that costate, to first order.
    pub fn costate_slope(&self, y: &Local<S>, change: &Local<S>) -> Parts<S> {
        let Local { w, s, g, c, k, .. } = *change;
        let zero = Vec3::zero();
        let of_v = y.d.cross(w).times(2.0);
        let of_omega = (y.w.scaled(s) + y.w.cross(w) - w.scaled(y.s)).times(0.5);
        if self.momenta.is_none() {
            return [of_v, of_omega, zero, zero];
        }
        let moved = moment(y, &Momenta { linear: g, angular: c, along: k });
        [
            of_v,
            of_omega + self.moment(y).cross(w).times(2.0) + moved,
            y.g.cross(w).times(2.0),
            y.c.cross(w) - y.c.scaled(s) - w.scaled(y.k),
        ]
    }

    /// What omega has in y by the momenta that turn with the frame.
    pub(super) fn moment(&self, y: &Local<S>) -> Vec3<S> {
        self.momenta.map_or(Vec3::zero(), |momenta| moment(y, &momenta))
    }
}

/// `p_v x y_g + 1/2 (sigma y_c + pi x y_c - y_k pi)`.
fn moment<S: Scalar>(y: &Local<S>, momenta: &Momenta<S>) -> Vec3<S> {
    let Momenta { linear, angular, along } = *momenta;
    let turned = y.c.scaled(along) + angular.cross(y.c) - angular.scaled(y.k);
    linear.cross(y.g) + turned.times(0.5)
}
