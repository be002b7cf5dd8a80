"""Crocoddyl's SolverDDP with exact second derivatives of the dynamics: fewer iterations to the same motion."""

import costate
import costate.crocoddyl
import crocoddyl
import ddp
import numpy as np


def solve(exact: bool):
    step = ddp.model()
    models = [costate.crocoddyl.ActionModel(step, ddp.GOAL, exact=exact) for _ in range(ddp.STEPS)]
    final = costate.crocoddyl.FinalModel(step, ddp.GOAL, ddp.WEIGHT)
    solver = crocoddyl.SolverDDP(crocoddyl.ShootingProblem(np.zeros(4), models, final))
    solver.setCallbacks([costate.crocoddyl.Costates(models)])
    solver.th_stop = 1e-16
    guess = [np.zeros(4)] * (ddp.STEPS + 1), [np.zeros(2)] * ddp.STEPS
    assert solver.solve(*guess, 300, False)
    return solver


if __name__ == "__main__":
    exact, gauss_newton = solve(True), solve(False)
    print(f"exact Hessian: cost {exact.cost:.9g}, {exact.iter} iterations")
    print(f"Gauss-Newton:  cost {gauss_newton.cost:.9g}, {gauss_newton.iter} iterations")
    expected = ddp.least_cost()
    assert abs(exact.cost - expected) < 1e-8 * expected
    assert abs(gauss_newton.cost - expected) < 1e-6 * expected
