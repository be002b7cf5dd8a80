"""A motion in time steps as a nonlinear program: its values and derivatives."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._costate import Step
from ._errors import argument_error, whole
from ._wanted import step_of

_Array = NDArray[np.float64]


def entries(name: str, value: ArrayLike, count: int) -> _Array:
    """So many finite numbers; a single one stands for all."""
    array = np.asarray(value, dtype=float)
    if array.shape not in ((), (count,)):
        raise argument_error(name, f"{name} has the shape {list(array.shape)}, not ({count},)")
    if not np.isfinite(array).all():
        raise argument_error(name, f"{name} is not finite; check the computation that produced it")
    return np.ascontiguousarray(np.broadcast_to(array, (count,)))


class Program:
    """The part of `costate.scipy.Transcription` without the solvers."""

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
        intervals = whole("intervals", intervals, 1)
        self.step = step = step_of(step)
        self.intervals = intervals
        self._n = step.dynamics.n
        n, states = self._n, 2 * self._n
        self.start, self.goal = entries("start", start, states), entries("goal", goal, states)
        self._r, self._q = entries("effort", effort, n), entries("deviation", deviation, states)
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

    def _key(self) -> tuple[_Array, ...]:
        return (self.start, self.goal, self._r, self._q, self.lower, self.upper)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        if (self.step, self.intervals) != (other.step, other.intervals):
            return False
        return all(np.array_equal(a, b) for a, b in zip(self._key(), other._key(), strict=True))

    def __hash__(self) -> int:
        return hash((self.step, self.intervals))

    def split(self, w: ArrayLike) -> tuple[_Array, _Array]:
        """States and torques of the unknowns.

        Parameters
        ----------
        w : array_like (n_unknowns)
            The unknowns.

        Returns
        -------
        x, tau : ndarray (K + 1, 2n), (K, n)
            States, and torques and forces (N m, N).
        """
        w = np.ascontiguousarray(w, dtype=float)
        if w.shape != (self.n_unknowns,):
            raise argument_error("w", f"w has the shape {list(w.shape)}, not ({self.n_unknowns},)")
        x, u = np.split(w, [2 * self._n * (self.intervals + 1)])
        return x.reshape(-1, 2 * self._n), u.reshape(-1, self._n)

    def join(self, x: ArrayLike, tau: ArrayLike) -> _Array:
        """The unknowns of states and torques: the inverse of ``split``.

        Parameters
        ----------
        x : array_like (K + 1, 2n)
            States.
        tau : array_like (K, n)
            Torques and forces (N m, N).

        Returns
        -------
        ndarray (n_unknowns)
            x_0 .. x_K, then tau_0 .. tau_{K-1}.
        """
        return np.concatenate([np.ravel(x), np.ravel(tau)]).astype(float)

    def guess(self) -> _Array:
        """A straight line from start to goal, without torques."""
        return self.join(np.linspace(self.start, self.goal, self.intervals + 1), np.zeros((self.intervals, self._n)))

    def _states(self, w: ArrayLike) -> tuple[_Array, _Array, _Array]:
        x, tau = self.split(w)
        return x[:-1, : self._n], x[:-1, self._n :], tau

    def objective(self, w: ArrayLike) -> float:
        """The cost.

        Parameters
        ----------
        w : array_like (n_unknowns)
            The unknowns.

        Returns
        -------
        float
            dt/2 sum_k [ tau_k' R tau_k + (x_k - goal)' Q (x_k - goal) ].
        """
        x, tau = self.split(w)
        return float(0.5 * self.step.dt * ((tau**2 @ self._r).sum() + ((x - self.goal) ** 2 @ self._q).sum()))

    def gradient(self, w: ArrayLike) -> _Array:
        """The derivative of the cost by the unknowns.

        Parameters
        ----------
        w : array_like (n_unknowns)
            The unknowns.

        Returns
        -------
        ndarray (n_unknowns)
            The gradient.
        """
        x, tau = self.split(w)
        return self.step.dt * self.join((x - self.goal) * self._q, tau * self._r)

    def constraints(self, w: ArrayLike) -> _Array:
        """x_{k+1} - Phi(x_k, tau_k), all zero for a motion.

        Parameters
        ----------
        w : array_like (n_unknowns)
            The unknowns.

        Returns
        -------
        ndarray (2n K)
            The constraints.
        """
        return (self.split(w)[0][1:] - self.step.f(*self._states(w))).ravel()

    def jacobian(self, w: ArrayLike) -> _Array:
        """The Jacobian of the constraints.

        Parameters
        ----------
        w : array_like (n_unknowns)
            The unknowns.

        Returns
        -------
        ndarray
            Its entries, in the order of ``jacobianstructure``.
        """
        by_z = -self.step.jacobian(*self._states(w))
        return np.concatenate([by_z.ravel(), np.ones(self.n_constraints)])

    def jacobianstructure(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Rows and columns of these entries."""
        rows = np.arange(self.n_constraints).reshape(self.intervals, -1, 1)
        shape = (self.intervals, 2 * self._n, 3 * self._n)
        blocks = [np.broadcast_to(part, shape).ravel() for part in (rows, self._z[:, None, :])]
        return np.concatenate([blocks[0], rows.ravel()]), np.concatenate([blocks[1], self._next.ravel()])

    def hessian(self, w: ArrayLike, lagrange: ArrayLike, obj_factor: float = 1.0) -> _Array:
        """The Hessian of ``obj_factor * objective + lagrange' constraints``.

        Parameters
        ----------
        w : array_like (n_unknowns)
            The unknowns.
        lagrange : array_like (n_constraints)
            Multipliers of the constraints.
        obj_factor : float
            Factor of the cost.

        Returns
        -------
        ndarray
            Entries of its lower triangle, in the order of ``hessianstructure``.
        """
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
