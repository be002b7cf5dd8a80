"""Solvers of nonlinear programs that CasADi comes with, and what each is given: options and exact derivatives."""

import casadi as ca

# Tolerance of both by default; with which costs of IPOPT come out about as near to the best ones as costate's at its first
# tolerance; and the number of that tolerance itself.
TIGHT, MIDDLE, LOOSE = 1e-8, 1e-6, 1e-4
LIMIT = 60.0


class Ipopt:
    """With MUMPS."""

    NAME = "ipopt"
    OPTIONS = {
        "print_time": False,
        # Not needed, and not to be had of compiled functions.
        "no_nlp_grad": True,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.linear_solver": "mumps",
        "ipopt.mu_strategy": "adaptive",
        # Limits are kept, not widened by 1e-8.
        "ipopt.bound_relax_factor": 0.0,
        "ipopt.max_iter": 1000,
    }
    SOLVED = ("Solve_Succeeded", "Solved_To_Acceptable_Level")

    def __init__(self, limit=LIMIT, tolerance=TIGHT):
        self.limit, self.tolerance = limit, tolerance

    def settings(self, program):
        return {**self.OPTIONS, **self.tolerances(), "ipopt.max_cpu_time": self.limit, **program.derivatives()}

    def tolerances(self):
        """What IPOPT accepts after 15 iterations without progress is 1e-6 with the tight tolerance, its default, and no looser
        than the tolerance with others."""
        if self.tolerance == TIGHT:
            return {"ipopt.tol": self.tolerance}
        keys = ("tol", "constr_viol_tol", "compl_inf_tol", "acceptable_tol", "acceptable_constr_viol_tol",
                "acceptable_compl_inf_tol")
        return {f"ipopt.{key}": self.tolerance for key in keys}

    def status(self, stats):
        """What it says, and whether that is a solution."""
        return stats["return_status"], stats["return_status"] in self.SOLVED


class Fatrop:
    """libfatrop, for programs in stages. It has no limit of time, but one of iterations."""

    NAME = "fatrop"
    OPTIONS = {"print_time": False, "calc_lam_p": False, "structure_detection": "manual"}

    def __init__(self, tolerance=TIGHT):
        self.tolerance = tolerance

    def settings(self, program):
        lower, upper = program.of.row_bounds()
        return {**self.OPTIONS, **program.of.structure(), "equality": (lower == upper).tolist(),
                "cache": self.functions(program),
                "fatrop": {"print_level": 0, "tol": self.tolerance, "max_iter": 1000}}

    @staticmethod
    def functions(program):
        """By the names under which CasADi keeps what it would derive itself. Gradients of the Lagrangian, which FATROP does not
        use, are zero."""
        weights, weight = ca.MX.sym("lam_g", program.of.rows + program.of.end_rows), ca.MX.sym("lam_f")
        arguments, zeros = [program.x, program.p], ca.DM.zeros(program.of.size)
        weighted = [*arguments, weight, weights]
        results = {
            "nlp_grad_f": (arguments, [program.gradient()]),
            "nlp_jac_g": (arguments, [program.equations(), program.jacobian()]),
            "nlp_hess_l": (weighted, [zeros, program.whole_hessian(weight, weights)]),
            "nlp_grad": (weighted, [program.cost(), program.equations(), zeros, ca.DM(0, 1)]),
        }
        return {name: ca.Function(name, *both) for name, both in results.items()}

    @staticmethod
    def status(stats):
        return str(stats["unified_return_status"]), bool(stats["success"])
