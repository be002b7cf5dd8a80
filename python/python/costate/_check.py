"""The comparison of all methods for derivatives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from html import escape

import numpy as np

from ._costate import Robot, _compare
from ._errors import Interrupted, argument_error, whole


@dataclass(frozen=True)
class Comparison:
    """One quantity by one method, compared with hyper-dual numbers; the worst of all states.

    Attributes
    ----------
    quantity, method : str
        What was compared.
    difference, bound : float
        The largest difference relative to the largest entry, and what rounding may cause.
    agrees : bool or None
        Whether the difference is within the bound; None where rounding leaves too few digits to say.
    """

    quantity: str
    method: str
    difference: float
    bound: float
    agrees: bool | None


@dataclass(frozen=True, repr=False)
class CheckReport:
    """What `check` found.

    Attributes
    ----------
    comparisons : list of Comparison
        One for each quantity and method.
    states : int
        Number of states that were compared.
    left_out : int
        Number of states at which the mass matrix is singular.
    """

    comparisons: list[Comparison]
    states: int
    left_out: int

    @property
    def passed(self) -> bool:
        """Whether something was compared, and nothing differs by more than rounding."""
        return self.states > 0 and all(row.agrees is not False for row in self.comparisons)

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"

    def __repr__(self) -> str:
        verdict = "passed" if self.passed else "not passed"
        return f"CheckReport({verdict}, {len(self.comparisons)} comparisons, {self.states} states, {self.left_out} left out)"

    def __str__(self) -> str:
        words = {True: "agrees", False: "DIFFERS", None: "not comparable"}
        lines = [
            f"{row.quantity:<32} {row.method:<26} {row.difference:9.1e}  bound {row.bound:8.1e}  {words[row.agrees]}"
            for row in self.comparisons
        ]
        return "\n".join([*lines, f"{self.states} states compared, {self.left_out} left out"])


def check(robot: Robot, states: int = 5, *, seed: int = 0) -> CheckReport:
    """Compare all methods for the derivatives of a robot with each other at random states.

    Positions are uniform within the limits of the joints (pi or 1 m around 0 without), velocities, torques and
    costates within 1. Floating and spherical joints move from the neutral configuration by such directions; tensors
    and frames are not compared then. The bound of each difference is 32 standard deviations of the rounding error,
    propagated through every operation.

    Parameters
    ----------
    robot : Robot
        The robot.
    states : int
        Number of states, of which the first is at q = 0, or the neutral configuration.
    seed : int
        Of the random numbers.

    Returns
    -------
    CheckReport
        One comparison for each quantity and method.

    Raises
    ------
    ArgumentError
        For what is no robot, and a number of states or a seed that is negative or no whole number.
    StateError
        Where a state cannot be evaluated, with its number.
    Interrupted
        After Ctrl-C: ``reached`` is the report on the states that were compared. The state at which it came is finished
        by a thread and forgotten: with a large robot that takes seconds.

    References
    ----------
    J. A. Fike, J. J. Alonso, The development of hyper-dual numbers for exact second-derivative calculations, AIAA 2011-886.

    Examples
    --------
    >>> import costate
    >>> robot = costate.Robot.builder("pendulum").revolute("hinge", axis=[0, 1, 0], mass=1, com=[0, 0, -1]).build()
    >>> costate.check(robot).passed
    True
    """
    if not isinstance(robot, Robot):
        raise argument_error("robot", f"robot is a {type(robot).__name__}; give a costate.Robot, such as dynamics.robot")
    states = whole("states", states, 0)
    random = np.random.default_rng(whole("seed", seed, 0))
    lower, upper = _ranges(robot)
    sample = []
    for k in range(states):
        # With quaternions, directions from the neutral configuration.
        q = robot.integrate(robot.neutral(), random.uniform(lower, upper)) if k else robot.neutral()
        v, tau, y = (random.uniform(-1, 1, size) for size in (robot.n, robot.n, 2 * robot.n))
        sample.append((q.tolist(), v.tolist(), tau.tolist(), y.tolist()))
    rows, seen, left_out, raised = _compare(robot, sample)
    report = CheckReport([Comparison(*row) for row in rows], seen - left_out, left_out)
    if isinstance(raised, KeyboardInterrupt):
        raise Interrupted(report, f"interrupted after {seen} of {states} states; .reached is the report on these")
    if raised is not None:
        raise raised
    return report


def _ranges(robot: Robot) -> tuple[list[float], list[float]]:
    """Limits of positions; as far as pi or 1 m where there are none, twice as far beyond a single one."""
    least, most = [], []
    for kind, lower, upper in zip(robot.joint_kinds, *robot.position_limits.tolist(), strict=True):
        reach = math.pi if kind == "revolute" else 1.0
        if math.isfinite(lower) and math.isfinite(upper) and lower < upper:
            ends = (lower, upper)
        elif math.isfinite(lower) and not math.isfinite(upper):
            ends = (lower, lower + 2 * reach)
        elif math.isfinite(upper) and not math.isfinite(lower):
            ends = (upper - 2 * reach, upper)
        else:
            ends = (-reach, reach)
        least.append(ends[0])
        most.append(ends[1])
    return least, most
