"""Robot dynamics with exact first and second derivatives.

A `Robot` is read from a URDF or TOML file or built in code. `Dynamics` computes its dynamics in (q, v) or (q, p) with
Jacobians and contracted Hessians, `Step` one time step of it, on NumPy arrays with any leading batch axes.

>>> import costate, numpy as np
>>> robot = costate.Robot.builder("pendulum").revolute("hinge", axis=[0, 1, 0], mass=1, com=[0, 0, -1]).build()
>>> dynamics = costate.Dynamics(robot)
>>> q, v, tau = np.linspace(-1, 1, 1000)[:, None], np.zeros(1), np.zeros(1)
>>> f, J = dynamics.linearise(q, v, tau)
>>> f.shape, J.shape
((1000, 2), (1000, 2, 3))
"""

from ._check import CheckReport, Comparison, check
from ._costate import Dynamics, Frame, Robot, RobotBuilder, Step, __version__, codegen
from ._errors import (
    ArgumentError,
    CodegenError,
    CostateError,
    NonFiniteState,
    RobotError,
    RobotWarning,
    SingularMassMatrix,
    StateError,
    StateWarning,
    StepNotSolved,
)
from ._pinocchio import JointMap

__all__ = [
    "ArgumentError",
    "CheckReport",
    "CodegenError",
    "Comparison",
    "CostateError",
    "Dynamics",
    "Frame",
    "JointMap",
    "NonFiniteState",
    "Robot",
    "RobotBuilder",
    "RobotError",
    "RobotWarning",
    "SingularMassMatrix",
    "StateError",
    "StateWarning",
    "Step",
    "StepNotSolved",
    "__version__",
    "check",
    "codegen",
]

# Their names in messages and pickles.
for _error in (
    ArgumentError,
    CodegenError,
    CostateError,
    NonFiniteState,
    RobotError,
    RobotWarning,
    SingularMassMatrix,
    StateError,
    StateWarning,
    StepNotSolved,
):
    _error.__module__ = "costate"
del _error
