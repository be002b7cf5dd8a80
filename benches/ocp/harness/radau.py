"""Radau collocation on one element [0, 1], the end among the points."""

import casadi as ca
import numpy

DEGREE = 3
POINTS = numpy.array(ca.collocation_points(DEGREE, "radau"))


def basis(nodes):
    """The Lagrange polynomials of these nodes."""
    found = []
    for j, node in enumerate(nodes):
        others = numpy.delete(nodes, j)
        found.append(numpy.poly1d(others, r=True) / numpy.prod(node - others))
    return found


STATE = basis(numpy.append(0.0, POINTS))
CONTROL = basis(POINTS)

# Row r, column j: derivative of the polynomial of node r (0 is the start of the element) at point j.
DERIVATIVE = numpy.array([[polynomial.deriv()(point) for point in POINTS] for polynomial in STATE])
# Weights of the quadrature that has the points as nodes.
WEIGHTS = numpy.array([polynomial.integ()(1.0) for polynomial in CONTROL])
