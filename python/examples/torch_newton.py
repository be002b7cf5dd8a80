"""Newton's method with conjugate gradients: Hessian-vector products by PyTorch, no matrix."""

import costate
import costate.torch
import ddp
import torch

step = costate.torch.Model(ddp.model().dynamics).step("semi_implicit_euler", ddp.DT)
goal = torch.tensor(ddp.GOAL)


def cost(tau):
    """dt/2 sum |tau|^2 + w/2 |x_K - goal|^2 of the motion from rest."""
    x = torch.zeros(4, dtype=torch.float64)
    for k in range(ddp.STEPS):
        x = step(x[:2], x[2:], tau[k])
    return 0.5 * ddp.DT * (tau**2).sum() + 0.5 * ddp.WEIGHT * ((x - goal) ** 2).sum()


def newton_direction(g, product, most=100):
    """-H^-1 g by conjugate gradients; what was found until then, or -g, where the curvature is negative."""
    d, r = torch.zeros_like(g), -g
    p, enough = r.clone(), min(0.1, float(g.norm())) * g.norm()
    for _ in range(most):
        Hp = product(p)
        curvature = (p * Hp).sum()
        if curvature <= 0:
            return d if d.any() else -g
        length = (r * r).sum() / curvature
        d, r_new = d + length * p, r - length * Hp
        if r_new.norm() < enough:
            return d
        p, r = r_new + (r_new * r_new).sum() / (r * r).sum() * p, r_new
    return d


if __name__ == "__main__":
    tau = torch.zeros(ddp.STEPS, 2, dtype=torch.float64, requires_grad=True)
    for iteration in range(100):
        J = cost(tau)
        (g,) = torch.autograd.grad(J, tau, create_graph=True)
        if g.abs().max() < 1e-6:
            break
        slope = g.detach()
        d = newton_direction(slope, lambda p, g=g, tau=tau: torch.autograd.grad(g, tau, p, retain_graph=True)[0])
        with torch.no_grad():
            length = 1.0
            while cost(tau + length * d) > J + 1e-4 * length * (slope * d).sum() + 1e-14 * J:
                length /= 2
        tau = (tau + length * d).detach().requires_grad_()
    print(f"cost {J.item():.9g} after {iteration} iterations")
    expected = ddp.least_cost()
    assert abs(J.item() - expected) < 1e-8 * expected
