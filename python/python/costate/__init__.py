"""Robot dynamics with exact first and second derivatives, and optimal motions.

A `Robot` is read from a URDF or TOML file or built in code. `Dynamics` computes its dynamics in (q, v) or (q, p) with
Jacobians and contracted Hessians, `Step` one time step of it, on NumPy arrays with any leading batch axes. `Problem`
poses a task, its `Solution` is the cheapest motion that does it within all limits; `Resolve` solves it again and again.

>>> import costate, numpy as np
>>> robot = costate.Robot.builder("pendulum").revolute("hinge", axis=[0, 1, 0], mass=1, com=[0, 0, -1]).build()
>>> dynamics = costate.Dynamics(robot)
>>> q, v, tau = np.linspace(-1, 1, 1000)[:, None], np.zeros(1), np.zeros(1)
>>> f, J = dynamics.linearise(q, v, tau)
>>> f.shape, J.shape
((1000, 2), (1000, 2, 3))
"""

from types import FunctionType as _Function

from ._branch import Branch
from ._check import CheckReport, Comparison, check
from ._costate import ConstrainedDynamics, Dynamics, Frame, Robot, RobotBuilder, Step, __version__, codegen
from ._errors import (
    ArgumentError,
    CodegenError,
    ConstraintError,
    CostateError,
    Interrupted,
    LimitWarning,
    MotionError,
    NonFiniteResult,
    NonFiniteState,
    NonUnitQuaternion,
    ProblemError,
    ProblemWarning,
    RobotError,
    RobotWarning,
    SingularMassMatrix,
    StateError,
    StateWarning,
    StepNotSolved,
)
from ._feedback import Feedback, MotionDerivative, Resolved
from ._outcomes import Outcome, WorkerDied
from ._pinocchio import JointMap
from ._problem import Problem
from ._program import Program, ProgramRow, ProgramSamples, ProgramSolution
from ._remarks import Remark
from ._resolve import Resolve
from ._run import Iteration
from ._samples import Gains, Samples, Sensitivity
from ._solution import Solution
from ._sweep import sweep

__all__ = [
    "ArgumentError",
    "Branch",
    "CheckReport",
    "CodegenError",
    "Comparison",
    "ConstrainedDynamics",
    "ConstraintError",
    "CostateError",
    "Dynamics",
    "Feedback",
    "Frame",
    "Gains",
    "Interrupted",
    "Iteration",
    "JointMap",
    "LimitWarning",
    "MotionDerivative",
    "MotionError",
    "NonFiniteResult",
    "NonFiniteState",
    "NonUnitQuaternion",
    "Outcome",
    "Problem",
    "ProblemError",
    "ProblemWarning",
    "Program",
    "ProgramRow",
    "ProgramSamples",
    "ProgramSolution",
    "Remark",
    "Resolve",
    "Resolved",
    "Robot",
    "RobotBuilder",
    "RobotError",
    "RobotWarning",
    "Samples",
    "Sensitivity",
    "SingularMassMatrix",
    "Solution",
    "StateError",
    "StateWarning",
    "Step",
    "StepNotSolved",
    "WorkerDied",
    "__version__",
    "check",
    "codegen",
    "sweep",
]

# The names of classes in messages and pickles, and those of methods that they have from parts of them.
for _name in __all__:
    _class = globals()[_name]
    if not isinstance(_class, type):
        continue
    _class.__module__ = "costate"
    for _base in _class.__mro__:
        if _base.__module__.startswith("costate._") and _base.__name__ not in __all__:
            for _part in vars(_base).values():
                if isinstance(_part, _Function):
                    _part.__qualname__ = f"{_name}.{_part.__name__}"
del _name, _class, _base, _part
