"""Problems of optimal motions."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

from ._costate import Robot, _Problem
from ._errors import ProblemError
from ._solves import Solves
from ._tables import table_of, text_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    _Path = str | PathLike[str]


class Problem(Solves):
    """Find the cheapest motion of a robot from its start to its end, within all limits.

    A problem has the tables of a problem file of the command ``costate optimize``, as nested dictionaries with the
    same keys, which stand under Notes. Each of them is a keyword here. Where one number or list says most, it can stand
    for the table: ``start=q`` and ``end=q`` for positions, ``time=T`` for a fixed final time, ``cost=weights`` for the
    weights of the squared torques, ``limits=True`` for the limits of the robot. Lists have one entry for each of
    ``robot.joint_names`` and can be arrays; one number stands for all joints in ``cost``, ``limits``, ``bounds``,
    ``penalty`` and ``actuation``. Units are rad, m, kg, s, N m, N and W.

    Positions of robots with floating and spherical joints have ``robot.nq`` entries, with unit quaternions (x, y, z, w),
    all other lists n. Such a joint has no actuator unless ``limits={"torque_max": ...}`` or ``bounds`` give it forces;
    tools, obstacles, vias and limits of rates other than velocities are not taken then.

    A problem never changes. Problems with equal robots, tables and options are equal; a pickle contains the robot.

    Parameters
    ----------
    robot : Robot
        The robot. With ``robot={"payload": {...}}`` in ``tables`` it is changed first.
    tables : dict, optional
        All tables by their names; keywords add to them.
    start, end : dict or array (nq)
        Where the motion begins and ends: ``q``, ``v`` (0), ``a``, ``q_free``, ``v_free``, ``tool``. With ``tool`` at the
        start ``q`` is found.
    time : dict or float
        ``{"final": T}``, or ``{"free": True}`` for a free final time, with a first ``guess`` (s) if there is one.
    cost : dict or array (n)
        ``effort``, ``time``, ``energy``, ``torque_rate``, ``jerk``, ``tool``, ``reference``.
    limits : dict or bool, optional
        Hard limits: ``q_min``, ``q_max``, ``v_max``, ``a_max``, ``torque_max``, ``power_max``, ... Those of the robot are
        kept too, the tighter of the two, unless ``"from_robot": False``; True is ``{"from_robot": True}``, False
        ``{"from_robot": False}``. If nothing is said, those of the robot are kept if each of its joints has limits of
        rate and effort, as in the URDF of a product, and there are neither bounds nor penalties, or if something is asked
        for that the direct method alone takes (vias, obstacles, tools, jerks, energy, ...); otherwise a motion that exceeds
        them is a `LimitWarning`.
    via, keep, obstacle : list of dict
        Places on the way; what tools keep; what the robot keeps away from, with the bodies of ``collision``.
    bounds, penalty, actuation, periodic, gait, collision, solver, start_from : dict
        The other tables.
    folder : path, optional
        Where relative paths in the tables begin.

    Raises
    ------
    ProblemError
        With ``key``, the key at fault.

    Notes
    -----
    The keys of the tables, with their defaults in parentheses:

    - ``robot``: ``gravity``, ``armature``, ``friction``, ``limits``, ``frame``, ``payload`` (``frame``, ``mass``,
      ``com``, ``inertia``, ``shape``), ``wrench``, ``lock``, ``reduced_to``.
    - ``tool`` of an end or a via, a dict or a list of them: ``frame``, ``offset`` (0), ``xyz`` (m; inf for free), and
      ``rpy``, ``rotation`` (3 rows), ``quaternion`` (x, y, z, w), ``along`` with ``axis`` ([0, 0, 1]), or ``yaw`` alone.
    - ``cost``: ``time`` (0), ``effort`` (0), ``energy``, ``energy_smoothing`` (1 W), ``torque_rate``, ``jerk``;
      ``tool``, with the keys of a tool and ``position_weight`` (1), ``orientation_weight`` (1); ``reference`` with
      ``times``, ``positions``, ``velocities`` and ``weights``, or those of a tool, ``frame``, ``offset``,
      ``orientations``, ``position_weight``, ``orientation_weight``.
    - ``limits``: ``q_min``, ``q_max``, ``v_max``, ``a_max``, ``torque_max``, ``jerk_max``, ``torque_rate_max``,
      ``power_max``, ``total_power_max``, ``corner_speed``, ``no_load_speed``, ``from_robot``.
    - ``bounds``: ``u_min``, ``u_max``. ``penalty``: ``weight``, ``q_min``, ``q_max``, ``v_max``. ``actuation``: ``gain``.
    - ``via``: ``q``, ``v``, ``q_free``, ``v_free``, ``stop`` (False), ``time``, ``tool``, ``payload``, a list.
      ``periodic``: ``shift`` (0).
    - ``gait``: ``stance``, ``swing``, ``along``, ``length``, ``friction`` (0.6), ``clearance`` (0), ``mirror``,
      ``symmetrise`` (False), ``sole``, ``double_support``, ``trailing``, ``flipped``, ``width``, ``sole_width``.
    - ``keep``: ``kind`` "plane", "line", "box", "axis", "orientation", "speed" or "acceleration", ``frame``,
      ``offset``, and ``through``, ``normal``, ``along``, ``distance``, ``min``, ``max``, ``axis``, ``angle``, ``rpy``,
      ``rotation``, ``quaternion``, ``speed``, ``acceleration`` as the kind needs them.
    - ``obstacle``: ``kind`` "sphere", "capsule", "box" or "half_space", ``name``, and ``xyz``, ``rpy``, ``size``,
      ``from``, ``to``, ``radius``, ``normal``. ``shape`` of a payload has the first three kinds.
    - ``collision``: ``capsules`` ("auto" or "urdf"), ``radius``, ``capsule`` (``name``, ``frame``, ``from``, ``to``,
      ``radius``), ``margin`` (0), ``pairs`` ("all", or pairs of names), ``except``.
    - ``solver``: the options of `solve`. ``start_from``: ``file``.

    Examples
    --------
    >>> import costate
    >>> builder = costate.Robot.builder("cart", gravity=[0, 0, 0])
    >>> robot = builder.prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> problem = costate.Problem(robot, start=[0.0], end=[1.0], time=1.0, cost=[1.0])
    >>> round(problem.solve().cost, 6)  # 6 (m d)^2/T^3
    24.0
    """

    __slots__ = ("_core",)
    _core: _Problem

    def __init__(
        self,
        robot: Robot,
        tables: Mapping[str, Any] | None = None,
        *,
        start: Mapping[str, Any] | ArrayLike | None = None,
        end: Mapping[str, Any] | ArrayLike | None = None,
        time: Mapping[str, Any] | float | None = None,
        cost: Mapping[str, Any] | ArrayLike | None = None,
        limits: Mapping[str, Any] | bool | None = None,
        bounds: Mapping[str, Any] | None = None,
        penalty: Mapping[str, Any] | None = None,
        actuation: Mapping[str, Any] | ArrayLike | None = None,
        via: Sequence[Mapping[str, Any]] | None = None,
        periodic: Mapping[str, Any] | ArrayLike | bool | None = None,
        gait: Mapping[str, Any] | None = None,
        keep: Sequence[Mapping[str, Any]] | Mapping[str, Any] | None = None,
        obstacle: Sequence[Mapping[str, Any]] | Mapping[str, Any] | None = None,
        collision: Mapping[str, Any] | None = None,
        solver: Mapping[str, Any] | None = None,
        start_from: Mapping[str, Any] | None = None,
        folder: _Path = "",
    ) -> None:
        given: dict[str, Any] = {"start": start, "end": end, "time": time, "cost": cost, "limits": limits}
        given |= {"bounds": bounds, "penalty": penalty, "actuation": actuation, "via": via, "periodic": periodic}
        given |= {"keep": keep, "obstacle": obstacle, "collision": collision, "solver": solver}
        given |= {"gait": gait, "start_from": start_from}
        all_tables = dict(tables or {})
        for name, value in given.items():
            if value is None:
                continue
            if name in all_tables:
                error = ProblemError(f"{name}: given twice, by name and in `tables`; keep one of the two")
                error.key = name
                raise error
            all_tables[name] = value
        text = text_of({name: table_of(name, value) for name, value in all_tables.items()})
        self._set(_Problem.of_robot(robot, text, fspath(folder)))

    def _set(self, core: _Problem) -> None:
        object.__setattr__(self, "_core", core)

    @classmethod
    def _of(cls, core: _Problem) -> Problem:
        problem = cls.__new__(cls)
        problem._set(core)
        return problem

    @classmethod
    def from_file(
        cls,
        path: _Path,
        *,
        friction: bool = False,
        strict: bool = False,
        floating_base: bool = False,
        quaternions: bool = False,
    ) -> Problem:
        """Read a problem file with the robot that it names, as ``costate optimize`` does.

        Parameters
        ----------
        path : path
            The problem file (TOML). Paths in it are relative to its folder.
        friction, strict, floating_base, quaternions : bool
            As in `Robot.from_file`, unless ``[robot]`` of the file says otherwise.

        Returns
        -------
        Problem
            With `ProblemWarning` for what is probably not meant.

        Raises
        ------
        ProblemError
            With ``path``, ``line`` and ``key``.
        ArgumentError
            For ``floating_base`` of a robot in TOML.
        OSError
            Where the file cannot be read.
        """
        return cls._of(_Problem.from_file(fspath(path), [friction, strict, floating_base, quaternions]))

    @classmethod
    def from_text(
        cls,
        text: str,
        robot: Robot | None = None,
        *,
        folder: _Path = "",
        friction: bool = False,
        strict: bool = False,
        floating_base: bool = False,
        quaternions: bool = False,
    ) -> Problem:
        """Read the text of a problem file.

        Parameters
        ----------
        text : str
            The text (TOML).
        robot : Robot, optional
            The robot, in the place of one that the text names.
        folder : path
            Where relative paths in the text begin.
        friction, strict, floating_base, quaternions : bool
            As in `Problem.from_file`, for a robot that the text names.

        Returns
        -------
        Problem
            With `ProblemWarning` for what is probably not meant.

        Raises
        ------
        ProblemError
            With ``key``; with ``line`` for a text that names its robot.
        """
        if robot is not None:
            return cls._of(_Problem.of_robot(robot, text, fspath(folder)))
        return cls._of(_Problem.from_text(text, fspath(folder), [friction, strict, floating_base, quaternions]))

    @property
    def robot(self) -> Robot:
        """The robot that moves, with the changes of ``[robot]``."""
        return self._core.robot()

    @property
    def text(self) -> str:
        """The text of the problem file, or of the tables that were given."""
        return self._core.text

    @property
    def warnings(self) -> list[str]:
        """What is odd about it, a `ProblemWarning` each, and what was done to pose it, which is logged alone."""
        return self._core.warnings

    @property
    def options(self) -> dict[str, Any]:
        """The options of the solver, all of them."""
        options: dict[str, Any] = json.loads(self._core.options_json())
        return options

    def with_parameter(self, parameter: str, value: float) -> Problem:
        """The problem with another value of one of its numbers.

        Parameters
        ----------
        parameter : {"final_time", "gravity", "armature", "bounds", "penalty_weight"}
            T (s), the weight of the penalties, or a factor of gravity, of the armature, of the distance of the bounds.
        value : float
            The value.

        Returns
        -------
        Problem
            Another one; this one does not change.

        Raises
        ------
        ProblemError
            Where the problem has no such number, or must not have this value.
        """
        return Problem._of(self._core.with_parameter(parameter, value))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a Problem does not change: {name}")

    def __eq__(self, other: object) -> bool:
        return self._core == other._core if isinstance(other, Problem) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._core)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Problem._of, (self._core,))

    def __repr__(self) -> str:
        robot = self._core.robot()
        return f"Problem({robot.name!r}, n={robot.n})"
