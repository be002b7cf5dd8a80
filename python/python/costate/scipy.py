"""Optimal control with SciPy's and IPOPT's solvers, with exact first and second derivatives.

`Transcription` makes a nonlinear program of a motion: for ``scipy.optimize.minimize`` and, by the methods that
``cyipopt.Problem`` calls, for IPOPT. `Extremal` gives ``scipy.integrate.solve_bvp`` the conditions of the maximum
principle with their Jacobian.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._extremal import Extremal
from ._transcription import Program

__all__ = ["Extremal", "Transcription"]

_Array = NDArray[np.float64]

# The name of the class in messages and pickles.
Extremal.__module__ = __name__


class Transcription(Program):
    """A motion in equal time steps as a nonlinear program: direct multiple shooting.

    ::

        minimise    dt/2 sum_k [ tau_k' R tau_k + (x_k - goal)' Q (x_k - goal) ]
        subject to  x_{k+1} = Phi(x_k, tau_k),  k = 0 .. K-1,    x_0 = start,  x_K = goal

    Phi is one time step. The unknowns w are x_0 .. x_K (2n each), then tau_0 .. tau_{K-1} (n each). All derivatives are
    exact: the Jacobian of the constraints and the Hessian of the Lagrangian are one batched call of `Step` each.

    The methods are those of ``problem_obj`` of ``cyipopt.Problem``: values of the Jacobian and of the lower triangle of
    the Hessian come in the order of ``jacobianstructure`` and ``hessianstructure``.

    Parameters
    ----------
    step : Step
        The time step, with its scheme, duration and coordinates.
    intervals : int
        K.
    start, goal : array_like
        First and last state (2n), in the coordinates of the step.
    effort : float or array_like
        Diagonal of R (n), in 1/(N m)^2 or 1/N^2.
    deviation : float or array_like
        Diagonal of Q (2n).
    reach : bool
        Whether x_K = goal is demanded; otherwise only Q draws the motion there.
    limits : bool
        Whether torques, positions and, in (q, v), velocities stay within the limits of the robot.

    Attributes
    ----------
    lower, upper : ndarray
        Bounds of the unknowns; those of the first and the last state are equal.

    Raises
    ------
    ArgumentError
        For numbers that do not fit.

    Examples
    --------
    >>> import costate, costate.scipy
    >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> step = costate.Step(costate.Dynamics(robot), "rk4", 0.1)
    >>> motion = costate.scipy.Transcription(step, 10, [0.0, 0.0], [1.0, 0.0])
    >>> motion.n_unknowns, motion.n_constraints
    (32, 20)

    References
    ----------
    J. T. Betts, Practical Methods for Optimal Control and Estimation Using Nonlinear Programming, 2010, chapter 3.
    """

    def minimize(self, guess: ArrayLike | None = None, **options: Any) -> Any:
        """Solve by ``scipy.optimize.minimize``, method trust-constr.

        Parameters
        ----------
        guess : array_like (n_unknowns), optional
            Where it begins; that of ``guess()`` unless given.
        **options
            Of the method: ``maxiter``, ``gtol``, ...

        Returns
        -------
        scipy.optimize.OptimizeResult
            ``split`` takes its ``x`` apart.
        """
        from scipy.optimize import Bounds, LinearConstraint, NonlinearConstraint, minimize
        from scipy.sparse import coo_matrix

        count, structure = self.n_unknowns, self.hessianstructure()

        def whole(values: _Array) -> Any:
            lower = coo_matrix((values, structure), shape=(count, count)).tocsr()
            return lower + lower.T - _diagonal(lower)

        def jacobian(w: _Array) -> Any:
            shape = (self.n_constraints, count)
            return coo_matrix((self.jacobian(w), self.jacobianstructure()), shape=shape).tocsr()

        def curvature(w: _Array, y: _Array) -> Any:
            return whole(self.hessian(w, y, 0.0))

        # SciPy calls `hess` with the multipliers too, which the types of scipy-stubs do not know.
        constraint: Callable[..., Any] = NonlinearConstraint
        constraints = [constraint(self.constraints, 0.0, 0.0, jac=jacobian, hess=curvature)]
        fixed = np.flatnonzero(self.lower == self.upper)
        if fixed.size:
            chosen = coo_matrix((np.ones(fixed.size), (np.arange(fixed.size), fixed)), shape=(fixed.size, count))
            constraints.append(LinearConstraint(chosen.tocsr(), self.lower[fixed], self.lower[fixed]))
        # Bounds make the method keep inside of them: only where there are some.
        lower, upper = self.lower.copy(), self.upper.copy()
        lower[fixed], upper[fixed] = -np.inf, np.inf
        bounds = None if np.isinf(lower).all() and np.isinf(upper).all() else Bounds(lower, upper)
        nothing = np.zeros(self.n_constraints)
        cost_hessian = whole(self.hessian(self.guess(), nothing, 1.0))
        solve: Callable[..., Any] = minimize
        return solve(
            self.objective,
            self.guess() if guess is None else np.asarray(guess, dtype=float),
            jac=self.gradient,
            hess=lambda w: cost_hessian,
            method="trust-constr",
            bounds=bounds,
            constraints=constraints,
            options=options,
        )

    def ipopt(self, guess: ArrayLike | None = None, **options: Any) -> tuple[_Array, dict[str, Any]]:
        """Solve by IPOPT, with ``cyipopt`` installed.

        Parameters
        ----------
        guess : array_like (n_unknowns), optional
            Where it begins; that of ``guess()`` unless given.
        **options
            Of IPOPT: ``tol``, ``print_level``, ...

        Returns
        -------
        w : ndarray (n_unknowns)
            The unknowns.
        report : dict
            What IPOPT says about them.

        Raises
        ------
        ImportError
            Where cyipopt is not installed.
        """
        try:
            from cyipopt import Problem  # type: ignore[import-not-found,unused-ignore]
        except ImportError as error:
            message = "Transcription.ipopt needs cyipopt: pip install cyipopt, or conda install -c conda-forge cyipopt"
            raise ImportError(message) from error

        zero = np.zeros(self.n_constraints)
        problem = Problem(
            self.n_unknowns, self.n_constraints, self, lb=self.lower, ub=self.upper, cl=zero, cu=zero
        )
        for name, value in options.items():
            problem.add_option(name, value)
        w, report = problem.solve(self.guess() if guess is None else np.asarray(guess, dtype=float))
        return np.asarray(w), report


def _diagonal(matrix: Any) -> Any:
    from scipy.sparse import diags

    return diags(matrix.diagonal())
