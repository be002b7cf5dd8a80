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

from ._costate import Dynamics, Step
from ._errors import ArgumentError, argument_error

__all__ = ["Extremal", "Transcription"]

_Array = NDArray[np.float64]


def _argument(name: str, message: str) -> ArgumentError:
    return argument_error(name, f"{name} {message}")


def _entries(name: str, value: ArrayLike, count: int) -> _Array:
    """So many finite numbers; a single one stands for all."""
    array = np.asarray(value, dtype=float)
    if array.shape not in ((), (count,)):
        raise _argument(name, f"has the shape {list(array.shape)}, not ({count},)")
    if not np.isfinite(array).all():
        raise _argument(name, "is not finite; check the computation that produced it")
    return np.ascontiguousarray(np.broadcast_to(array, (count,)))


class Transcription:
    """A motion in equal time steps as a nonlinear program.

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
    """

    def __init__(
        self,
        step: Step,
        intervals: int,
        start: ArrayLike,
        goal: ArrayLike,
        *,
        effort: ArrayLike = 1.0,
        deviation: ArrayLike = 0.0,
        reach: bool = True,
        limits: bool = False,
    ) -> None:
        if intervals < 1:
            raise _argument("intervals", f"is {intervals}; at least one is needed")
        self.step = step
        self.intervals = intervals
        self._n = step.dynamics.n
        n, states = self._n, 2 * self._n
        self.start, self.goal = _entries("start", start, states), _entries("goal", goal, states)
        self._r, self._q = _entries("effort", effort, n), _entries("deviation", deviation, states)
        self.n_unknowns = states * (intervals + 1) + n * intervals
        self.n_constraints = states * intervals
        self.lower, self.upper = self._bounds(limits, reach)
        # The unknowns of each interval: x_k, then tau_k.
        first = np.arange(intervals)[:, None]
        in_x = states * first + np.arange(states)
        in_u = states * (intervals + 1) + n * first + np.arange(n)
        self._z = np.concatenate([in_x, in_u], axis=1)
        self._next = in_x + states
        self._row, self._column = np.tril_indices(3 * n)

    def _bounds(self, limits: bool, reach: bool) -> tuple[_Array, _Array]:
        n, robot = self._n, self.step.dynamics.robot
        x, u = np.full((2, self.intervals + 1, 2 * n), np.inf), np.full((2, self.intervals, n), np.inf)
        x[0], u[0] = -np.inf, -np.inf
        if limits:
            x[:, :, :n] = robot.position_limits[:, None, :]
            if self.step.dynamics.coordinates == "qv":
                x[:, :, n:] = np.multiply.outer([-1.0, 1.0], robot.velocity_limits)[:, None, :]
            u[:] = np.multiply.outer([-1.0, 1.0], robot.effort_limits)[:, None, :]
        x[:, 0] = self.start
        if reach:
            x[:, -1] = self.goal
        lower, upper = np.concatenate([x.reshape(2, -1), u.reshape(2, -1)], axis=1)
        return lower, upper

    def split(self, w: ArrayLike) -> tuple[_Array, _Array]:
        """The states x (K + 1, 2n) and the torques tau (K, n) of the unknowns."""
        w = np.ascontiguousarray(w, dtype=float)
        if w.shape != (self.n_unknowns,):
            raise _argument("w", f"has the shape {list(w.shape)}, not ({self.n_unknowns},)")
        x, u = np.split(w, [2 * self._n * (self.intervals + 1)])
        return x.reshape(-1, 2 * self._n), u.reshape(-1, self._n)

    def join(self, x: ArrayLike, tau: ArrayLike) -> _Array:
        """The unknowns of states and torques: the inverse of ``split``."""
        return np.concatenate([np.ravel(x), np.ravel(tau)]).astype(float)

    def guess(self) -> _Array:
        """A straight line from start to goal, without torques."""
        return self.join(np.linspace(self.start, self.goal, self.intervals + 1), np.zeros((self.intervals, self._n)))

    def _states(self, w: ArrayLike) -> tuple[_Array, _Array, _Array]:
        x, tau = self.split(w)
        return x[:-1, : self._n], x[:-1, self._n :], tau

    def objective(self, w: ArrayLike) -> float:
        """The cost."""
        x, tau = self.split(w)
        return float(0.5 * self.step.dt * ((tau**2 @ self._r).sum() + ((x - self.goal) ** 2 @ self._q).sum()))

    def gradient(self, w: ArrayLike) -> _Array:
        """Its derivative by the unknowns."""
        x, tau = self.split(w)
        return self.step.dt * self.join((x - self.goal) * self._q, tau * self._r)

    def constraints(self, w: ArrayLike) -> _Array:
        """x_{k+1} - Phi(x_k, tau_k), all zero for a motion (2n K)."""
        return (self.split(w)[0][1:] - self.step.f(*self._states(w))).ravel()

    def jacobian(self, w: ArrayLike) -> _Array:
        """The entries of the constraints' Jacobian."""
        by_z = -self.step.jacobian(*self._states(w))
        return np.concatenate([by_z.ravel(), np.ones(self.n_constraints)])

    def jacobianstructure(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Rows and columns of these entries."""
        rows = np.arange(self.n_constraints).reshape(self.intervals, -1, 1)
        shape = (self.intervals, 2 * self._n, 3 * self._n)
        blocks = [np.broadcast_to(part, shape).ravel() for part in (rows, self._z[:, None, :])]
        return np.concatenate([blocks[0], rows.ravel()]), np.concatenate([blocks[1], self._next.ravel()])

    def hessian(self, w: ArrayLike, lagrange: ArrayLike, obj_factor: float = 1.0) -> _Array:
        """The lower entries of the Hessian of ``obj_factor * objective + lagrange' constraints``."""
        y = np.ascontiguousarray(lagrange, dtype=float).reshape(self.intervals, 2 * self._n)
        blocks = -self.step.hessian(*self._states(w), y)
        diagonal = obj_factor * self.step.dt * np.concatenate([self._q, self._r])
        blocks[:, np.arange(3 * self._n), np.arange(3 * self._n)] += diagonal
        last = obj_factor * self.step.dt * self._q
        return np.concatenate([blocks[:, self._row, self._column].ravel(), last])

    def hessianstructure(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Rows and columns of these entries."""
        last = self._next[-1]
        rows, columns = self._z[:, self._row].ravel(), self._z[:, self._column].ravel()
        return np.concatenate([rows, last]), np.concatenate([columns, last])

    def minimize(self, guess: ArrayLike | None = None, **options: Any) -> Any:
        """Solve by ``scipy.optimize.minimize``, method trust-constr; ``options`` go to the method.

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
        """Solve by IPOPT, with ``cyipopt`` installed; ``options`` are those of IPOPT. The unknowns and its report."""
        from cyipopt import Problem  # type: ignore[import-not-found,unused-ignore]

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


class Extremal:
    """The conditions of the maximum principle for a motion of least effort, for ``scipy.integrate.solve_bvp``.

    ::

        H = y'f(x, tau) - 1/2 tau' R tau,    tau = R^-1 f_tau' y
        x' = f,    y' = -f_x' y,             x(0) = start,  x(T) = goal

    f is affine in tau in either coordinates, so that tau is a function of (x, y). The unknowns are z = (x, y), 4n. The
    Jacobian of the right-hand side is exact: it needs y'f_xx.

    Parameters
    ----------
    dynamics : Dynamics
        The model; in "qp" f_tau is constant.
    start, goal : array_like
        First and last state (2n), in the coordinates of the dynamics.
    effort : float or array_like
        Diagonal of R (n), positive, in 1/(N m)^2 or 1/N^2.

    Examples
    --------
    >>> import costate, costate.scipy, numpy as np
    >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> extremal = costate.scipy.Extremal(costate.Dynamics(robot, "qp"), [0.0, 0.0], [1.0, 0.0])
    >>> extremal.torques(np.array([0.0, 0.0, 24.0, 12.0])[:, None]).tolist()
    [[12.0]]
    """

    def __init__(self, dynamics: Dynamics, start: ArrayLike, goal: ArrayLike, *, effort: ArrayLike = 1.0) -> None:
        self.dynamics = dynamics
        self._n = dynamics.n
        self.start, self.goal = _entries("start", start, 2 * self._n), _entries("goal", goal, 2 * self._n)
        self._r = _entries("effort", effort, self._n)
        if not (self._r > 0).all():
            raise _argument("effort", "must be positive")

    def _parts(self, z: _Array) -> tuple[_Array, _Array, _Array]:
        z = np.ascontiguousarray(np.asarray(z, dtype=float).T)
        n = self._n
        return z[..., :n], z[..., n : 2 * n], z[..., 2 * n :]

    def torques(self, z: _Array) -> _Array:
        """tau = R^-1 f_tau' y (n, m) at m columns of z."""
        q, v, y = self._parts(z)
        result: _Array = (self.dynamics.adjoint(q, v, np.zeros(self._n), y)[..., 2 * self._n :] / self._r).T
        return result

    def fun(self, t: Any, z: _Array) -> _Array:
        """z' (4n, m) at m columns of z; the time is not used."""
        q, v, y = self._parts(z)
        tau = np.ascontiguousarray(self.torques(z).T)
        rates = self.dynamics.f(q, v, tau), -self.dynamics.adjoint(q, v, tau, y)[..., : 2 * self._n]
        return np.concatenate(rates, axis=-1).T

    def fun_jac(self, t: Any, z: _Array) -> _Array:
        """The derivative of ``fun`` by z (4n, 4n, m)."""
        q, v, y = self._parts(z)
        tau = np.ascontiguousarray(self.torques(z).T)
        _, j, h = self.dynamics.contract(q, v, tau, y)
        x = 2 * self._n
        f_x, f_u, h_xx, h_ux = j[..., :x], j[..., x:], h[..., :x, :x], h[..., x:, :x]
        # tau_x = R^-1 (y'f)_ux, tau_y = R^-1 f_u'.
        by_x, by_y = h_ux / self._r[:, None], np.swapaxes(f_u, -1, -2) / self._r[:, None]
        h_xu = np.swapaxes(h_ux, -1, -2)
        rows = [
            np.concatenate([f_x + f_u @ by_x, f_u @ by_y], axis=-1),
            np.concatenate([-h_xx - h_xu @ by_x, -np.swapaxes(f_x, -1, -2) - h_xu @ by_y], axis=-1),
        ]
        return np.moveaxis(np.concatenate(rows, axis=-2), 0, -1)

    def bc(self, a: _Array, b: _Array) -> _Array:
        """What must vanish of the first and the last z."""
        x = 2 * self._n
        return np.concatenate([a[:x] - self.start, b[:x] - self.goal])

    def bc_jac(self, a: _Array, b: _Array) -> tuple[_Array, _Array]:
        """Its derivatives by both."""
        x = 2 * self._n
        by_a, by_b = np.zeros((2, 2 * x, 2 * x))
        by_a[:x, :x] = by_b[x:, :x] = np.eye(x)
        return by_a, by_b

    def solve(self, duration: float, guess: ArrayLike | None = None, *, nodes: int = 20, **options: Any) -> Any:
        """Solve by ``scipy.integrate.solve_bvp`` for a motion of this duration (s); ``options`` go to it.

        Without a guess (4n, nodes) the iteration begins on a straight line from start to goal, with costates of zero.
        """
        from scipy.integrate import solve_bvp

        if guess is None:
            straight = np.linspace(self.start, self.goal, nodes, axis=1)
            guess = np.concatenate([straight, np.zeros_like(straight)])
        guess = np.asarray(guess, dtype=float)
        times = np.linspace(0.0, duration, guess.shape[1])
        return solve_bvp(self.fun, self.bc, times, guess, fun_jac=self.fun_jac, bc_jac=self.bc_jac, **options)
