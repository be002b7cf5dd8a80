//! The direct method and its formulas. This page has no items: [`Solver`](crate::Solver) uses the method by
//! default, [`Method::Direct`](crate::Method::Direct) asks for it.
//!
//! A motion is a piecewise polynomial. Its torques follow from inverse dynamics, so the dynamics are no
//! equations to be solved. An interior-point method minimises the cost within the limits on one mesh after
//! the other. n is the number of joints; units are rad or m, s, N m or N.
//!
//! # Transcription
//!
//! The time is T, s = t/T runs from 0 to 1, and the mesh has nodes $s_0 = 0 < \dots < s_N = 1$ with
//! $h_k = s_{k+1} - s_k$. The unknowns are q and $q' = dq/ds$ at the nodes, a vector $b_k$ on each interval,
//! and T where it is free. With x from 0 to 1 on interval k and C the cubic with the given values and
//! derivatives at both ends,
//!
//! $$ q = C(x; q_k, h_k q'\_k, q_{k+1}, h_k q'\_{k+1}) + 16 \\, b_k x^2 (1 - x)^2, \qquad v = q'/T, \quad
//!    a = q''/T^2 $$
//!
//! q and v are continuous, a and the torques may jump at nodes. At Gauss's three points
//! $x_j = \tfrac12 \mp \sqrt{3/20}, \tfrac12$ with the weights $w_j = 5/18, 5/18, 4/9$,
//!
//! $$ \tau_{kj} = M(q) \\, a + c(q, v), \qquad J = c_t T + T \sum_k h_k \sum_j w_j \\, l(q, v, \tau)\_{kj} $$
//!
//! Limits $d_i(q, v, a, \tau) \ge 0$ hold at these points, those of positions and rates at the nodes too. A
//! joint without a motor is the equation $\tau = 0$ there. Costates come from the derivatives of the Lagrange
//! function L of a second at the points,
//!
//! $$ \lambda_v = L_a, \qquad \lambda_q = \lambda_q(t_k) + \int_{t_k}^t L_q \\, dt $$
//!
//! with the quadratic through the three values of $L_q$ (W. W. Hager, Runge-Kutta methods in optimal control
//! and the transformed adjoint system, Numerische Mathematik 87, 2000).
//!
//! With vias there is a time for each phase, and s goes on by one in each. At the ends of phases, the start
//! and the end of the motion too, v is the unknown in place of q'. Where jerks or rates of torques are
//! limited or cost anything, or accelerations are given at an end, the polynomial is the quintic with q, q'
//! and q'' of both ends. Jerks and rates of torques are then limited at Gauss's points, all else at Lobatto's
//! five, which integrate the cost.
//!
//! # Barrier problem
//!
//! With slacks $s_i$, equations $d_e = 0$, and the weight of a point in the integral over s as the weight
//! $w_i$ of its limits (at a node a tenth of the intervals beside it),
//!
//! $$ \min \\; J - \mu \sum_i w_i \log s_i \quad \text{with} \quad d_i = s_i, \\; d_e = 0, \qquad
//!    \mu \to 0 $$
//!
//! so the barrier is a rule for an integral, on each mesh for the same one. With multipliers $\eta$ and
//! $L = J - \sum_i \eta_i d_i - \sum_e \eta_e d_e$ the conditions of first order are
//!
//! $$ \nabla L = 0, \qquad d_i = s_i, \quad d_e = 0, \qquad \eta_i s_i = \mu w_i $$
//!
//! # Newton's equations, and what is eliminated
//!
//! Slacks and multipliers of limits go first, each by itself: with $\sigma = \eta/s$
//!
//! $$ \Delta s = \Delta d + d - s, \qquad
//!    \Delta \eta = \frac{\mu w - \eta d}{s} - \sigma \Delta d $$
//!
//! An equation keeps its multiplier, and $\tfrac12 \sigma_e d_e^2$ joins the cost,
//! $\sigma_e = \rho w_e/r_e^2$ with the range $r_e$ that its values have:
//! $\Delta \eta_e = -\sigma_e (d_e + \Delta d_e)$, the proximal method of multipliers. Where a whole step
//! leaves more than a tenth of violations that were small before, $\rho$ grows tenfold. What remains for the
//! unknowns $\xi$ of the motion is
//!
//! $$ K \Delta \xi = -g, \qquad
//!    g = \nabla J - \sum_i \left( \eta_i - \sigma_i d_i + \frac{\mu w_i}{s_i} \right) \nabla d_i -
//!    \sum_e (\eta_e - \sigma_e d_e) \nabla d_e $$
//!
//! $$ K = L_{\xi\xi} + \sum_i \sigma_i \nabla d_i \nabla d_i^\top +
//!    \sum_e \sigma_e \nabla d_e \nabla d_e^\top $$
//!
//! The Hessian is exact. A point contributes, in z = (q, v, a), the second derivatives of the running cost,
//! squares of the rows $\tau_z$, and the contracted second derivatives $y^\top \tau_{zz}$ with
//! $y_i = h_k w_j T r_i \tau_i$ (r the weights of the effort) less the multipliers of the limits of torques,
//! with the signs of their sides; functions of tools, clearances and powers add theirs. As z is linear in the
//! unknowns of an interval at constant T, $z = B_{kj} \xi$, a sum $B^\top H B$ carries this to K.
//!
//! The vectors $b_k$ meet only the two nodes of their interval. They are eliminated first, by Cholesky's
//! factorisation, which leaves a block-tridiagonal matrix with 2n unknowns a node. What all intervals share
//! (times of phases, ends of a periodic motion) is a border,
//!
//! $$ \begin{pmatrix} K & B \\\\ B^\top & C \end{pmatrix} \begin{pmatrix} \Delta \xi \\\\ \Delta y
//!    \end{pmatrix} = - \begin{pmatrix} g \\\\ g_y \end{pmatrix}, \qquad
//!    S = C - B^\top K^{-1} B $$
//!
//! so a step takes $O(N n^3)$ operations. The minimum is strict on the mesh where K and S are positive
//! definite: $L_{\xi\xi}$ is then positive along all changes that keep the equations (G. Debreu, Definite and
//! semidefinite quadratic forms, Econometrica 20, 1952). Where they are not, or no step is accepted, a
//! multiple $\delta$ of a metric joins K, ten times more until both is so. With R the weights of the effort,
//! or where there is none the cost of a second over the square of the range of the torque, a change costs
//!
//! $$ \delta \\, T \sum h w \left( |M \Delta a|\_R^2 + 0.01 \\, |M \Delta v|\_R^2/T^2 +
//!    0.01 \\, |M \Delta q|\_R^2/T^4 \right) $$
//!
//! The first of such steps on a mesh, 40 at most, leave out $\tau_{zz}$ instead, where effort costs and there
//! are no equations (Gauss and Newton's method).
//!
//! # Barrier parameter and length of a step
//!
//! Slacks and multipliers keep 0.005 of themselves: $\alpha = \min(1, 0.995 / \max_i(-\Delta s_i/s_i))$, and
//! the same, $\alpha_\eta$, for the multipliers. The step at $\mu = 0$ would leave the complementarity
//! $\gamma = \sum_i (s + \alpha \Delta s)\_i (\eta + \alpha_\eta \Delta \eta)\_i$, and
//!
//! $$ \mu = \left( \frac{\gamma}{\sum_i s_i \eta_i} \right)^{\\!3} \frac{\sum_i s_i \eta_i}{\sum_i w_i} $$
//!
//! (S. Mehrotra, On the implementation of a primal-dual interior point method, SIAM Journal on Optimization
//! 2, 1992), no smaller than the tolerance needs, and than a hundredth of the Newton decrement
//! $-g^\top \Delta \xi$ over $\sum_i w_i$. Up to two corrections with the same factors bring the products
//! $s_i \eta_i$ between 0.1 and 10 times $\mu w_i$ (J. Gondzio, Multiple centrality corrections in a
//! primal-dual method for linear programming, Computational Optimization and Applications 6, 1996).
//!
//! # Filter
//!
//! Trial steps are halved, down to 0.05 of the longest one, until they are accepted by
//!
//! $$ \theta = \sum_i \frac{w_i}{r_i} |d_i - s_i| + \sum_e \frac{w_e}{r_e} |d_e|, \qquad
//!    \varphi = J - \mu \sum_i w_i \log s_i $$
//!
//! With the slope $m = \nabla \varphi^\top (\Delta \xi, \Delta s)$ and the size |J| of the cost: if
//! $\alpha \\, (-m/|J|)^{2.3} > \theta^{1.1}$, then by Armijo's rule
//! $\varphi_+ \le \varphi + 10^{-4} \alpha m$; else if $\theta_+ \le (1 - 10^{-5}) \theta$ or
//! $\varphi_+ \le \varphi - 10^{-5} \theta$. In both cases the trial has to be better in the second sense
//! than all entries of the filter, which keeps the iterates that were left by steps of the second kind: A.
//! Waechter, L. T. Biegler, On the implementation of an interior-point filter line-search algorithm for
//! large-scale nonlinear programming, Mathematical Programming 106, 2006, sections 2.3 and 3.3. Differences:
//! entries keep J and logarithms apart, as $\mu$ changes in each step; $\theta_+ \le 10 \max(1, \theta)$
//! refers to the iterate, not to the start; the filter is forgotten up to five times where no step passes it,
//! and after steps that limits cut short; there is no second-order correction. The slacks of a trial are at
//! least the distances that it reaches, $s \leftarrow \max(s, d)$.
//!
//! The mesh is solved where the decrement and the gap $\sum s_i \eta_i$ are below parts of the tolerance
//! times |J|, and no limit or equation is off by more than 1e-9 of its range, or by more than rounding is.
//!
//! # Restoration: the elastic phase
//!
//! If violations do not fall in 40 steps, or no step is accepted beyond a limit, each limit may give by a
//! constant part $e_i$ of its range $r_i$, or of what it lacks at the start if that is more,
//! $d_i + r_i e_i \ge 0$, at the price
//!
//! $$ \frac{P}{2} \sum_i \left( e_i + \sqrt{e_i^2 + \delta^2} \right), \qquad \delta = 10^{-3} $$
//!
//! beside the cost, P at first 100 times the cost, then up to twice 100 times more. An equation of a task
//! that gives is two limits with one $e_i$; laws of physics (a joint without a motor has no torque, rows of
//! constraints) stay equations. The unknowns $e_i$ border Newton's equations as times do. The phase ends at a
//! motion that keeps all limits, from which the search goes on, or at a minimum with $e > 0$, on halved
//! intervals until that does not fall by a fifth: [`Infeasibility`](crate::Infeasibility), a local statement.
//! One elastic variable for a constraint is what the elastic mode of SNOPT has (P. E. Gill, W. Murray, M. A.
//! Saunders, SNOPT: an SQP algorithm for large-scale constrained optimization, SIAM Review 47, 2005, section
//! 4.7).
//!
//! # Estimated errors, and the next mesh
//!
//! Where a torque is smooth, that of the exact motion differs from the polynomial's by about a Legendre
//! polynomial of degree three on each interval, which vanishes at the points and has the mean square 1/7. The
//! torques of neighbours then differ by $D_i$ at the node between them, each by $D_i/2$ from the exact one.
//! With the mean of $D_i^2$ over both ends (without one at which the exact torque is likely to jump), Gauss's
//! rule with eight points as the finer one, and densities of multipliers $\lambda = \eta/(h w)$ between the
//! points as the quadratic through theirs, the error of the cost by interval k is estimated as
//!
//! $$ E_k = 1.5 \left( \frac{h_k T}{2} \sum_i r_i \frac{D_i^2}{4 \cdot 7} + \left| J_k^{\text{fine}} - J_k
//!    \right| \right) + \sum_i h_k \left| \int_0^1 \lambda_i d_i \\, dx \right| + \sum_j \left( P_{jk}
//!    \max_{|l - k| \le 1} e_{jl} + M_{jk} \right) $$
//!
//! with i over equations and limits of what may jump at nodes, the integral by the finer rule, and j over
//! limits of what does not jump: positions, rates and tasks. These are kept at points and nodes, and exceeded
//! between them by $e_{jl}$ where a limit is touched or left, mostly by nothing; at most 3e-3 of the range
//! counts, as a mesh is not accurate beyond that anyway. To keep them everywhere
//! costs this times the sum $P_{jk}$ of their multipliers $\eta$ there, to first order. A limit that was
//! moved inside by m costs $M_{jk} = \sum \eta m$. Densities times distances would be far too much where a
//! limit is touched: a multiplier stands at one point there, and its density between the points is that of
//! nothing. Where bodies pass through each other between the points, by more than 3e-3 of the range, the
//! error of their distance is $h_k \int_0^1 |\lambda d| \\, dx$: such a mesh says nothing about what it costs
//! to keep it. So it is for all limits that do not jump where accelerations are continuous. The reported
//! error is $(\sum_k E_k + \sum_i s_i \eta_i)/|J|$, the reported cost that of the finer rule. Limits are
//! looked at between the points too: a mesh is accurate where the error is below the tolerance and limits of
//! what does not jump are kept to 1e-4 of their range. Otherwise the intervals with the largest errors are
//! divided, in up to four parts each, as the errors fall with $h^7$; nodes move to where torques jump. An
//! interval whose error is mostly that of one peak beyond a limit of a position or task, which is nearly
//! kept, is divided where the motion touches it, in the mean of the multipliers around: with a node there for
//! a position, which is limited at nodes too, and with the middle of an interval there for a task. Then next
//! to nothing of the peak is left. What may jump is kept between points by limits of the coefficients in
//! Bernstein's basis (G. Farin, Curves and Surfaces for CAGD, 5th edition, 2002, chapter 4).
//!
//! A mesh is given up where the points miss more than the whole cost. After six of them in a row the search
//! begins again at the last motion that was not so, twice at most.
//!
//! With [`Verify::Full`](crate::Verify::Full) a converged motion is solved once more on halved intervals
//! ([`Motion::finer_mesh`](crate::Motion::finer_mesh)), and integrated again with its torques, cut to their
//! limits, by an adaptive method: it has to end within $0.3 \sqrt{\text{tolerance}}$ of the largest values
//! along the motion, in one piece or in the sum of 20 pieces.
