// Pinocchio, from its headers alone: model, data and algorithms are compiled here, with the flags of this machine.
#include "model.hpp"
#include "peer.h"

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea-second-order-derivatives.hpp>

namespace {

Context &at(void *context, const double *state) {
    auto &c = *static_cast<Context *>(context);
    c.load(state);
    return c;
}

Context &of(void *context) { return *static_cast<Context *>(context); }

template <pin::Convention convention> void aba(void *context, const double *state) {
    auto &c = at(context, state);
    pin::aba(c.model, c.data, c.q, c.v, c.u, convention);
}

void aba_derivatives(void *context, const double *state) {
    auto &c = at(context, state);
    pin::computeABADerivatives(c.model, c.data, c.q, c.v, c.u);
}

void minverse(void *context, const double *state) {
    auto &c = at(context, state);
    pin::computeMinverse(c.model, c.data, c.q);
}

template <pin::Convention convention> void crba(void *context, const double *state) {
    auto &c = at(context, state);
    pin::crba(c.model, c.data, c.q, convention);
}

void rnea(void *context, const double *state) {
    auto &c = at(context, state);
    pin::rnea(c.model, c.data, c.q, c.v, c.a);
}

void rnea_derivatives(void *context, const double *state) {
    auto &c = at(context, state);
    pin::computeRNEADerivatives(c.model, c.data, c.q, c.v, c.a);
}

void second_order_rnea(void *context, const double *state) {
    auto &c = at(context, state);
    // It adds to these four: its documentation asks for zeros.
    c.data.d2tau_dqdq.setZero();
    c.data.d2tau_dvdv.setZero();
    c.data.d2tau_dqdv.setZero();
    c.data.d2tau_dadq.setZero();
    pin::ComputeRNEASecondOrderDerivatives(c.model, c.data, c.q, c.v, c.a);
}

void accelerations(void *context, double *out) { put(out, of(context).data.ddq); }

// da/d(q, v, u), n x 3n.
void acceleration_jacobian(void *context, double *out) {
    auto &c = of(context);
    Eigen::MatrixXd all(c.n, 3 * c.n), inverse = c.data.Minv;
    inverse.triangularView<Eigen::StrictlyLower>() = inverse.transpose().triangularView<Eigen::StrictlyLower>();
    all << c.data.ddq_dq, c.data.ddq_dv, inverse;
    put(out, all);
}

void inverse_mass_matrix(void *context, double *out) {
    Eigen::MatrixXd inverse = of(context).data.Minv;
    inverse.triangularView<Eigen::StrictlyLower>() = inverse.transpose().triangularView<Eigen::StrictlyLower>();
    put(out, inverse);
}

void mass_matrix(void *context, double *out) {
    Eigen::MatrixXd m = of(context).data.M;
    m.triangularView<Eigen::StrictlyLower>() = m.transpose().triangularView<Eigen::StrictlyLower>();
    put(out, m);
}

void torques(void *context, double *out) { put(out, of(context).data.tau); }

// d tau/d(q, v, a), n x 3n.
void torque_jacobian(void *context, double *out) {
    auto &c = of(context);
    Eigen::MatrixXd all(c.n, 3 * c.n), m = c.data.M;
    m.triangularView<Eigen::StrictlyLower>() = m.transpose().triangularView<Eigen::StrictlyLower>();
    all << c.data.dtau_dq, c.data.dtau_dv, m;
    put(out, all);
}

// sum_k w_k d2 tau_k / d(q, v, a)2 with w the first half of y, 3n x 3n.
void contracted_torque_hessian(void *context, double *out) {
    auto &c = of(context);
    const int n = c.n;
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (int k = 0; k < n; k++)
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                // Of a free flyer they are the derivatives one after the other, in the frame that has moved: symmetric up to
                // the commutator of its axes. The Hessian along exp(xi) is the symmetric part.
                h(i, j) += 0.5 * c.y[k] * (c.data.d2tau_dqdq(k, i, j) + c.data.d2tau_dqdq(k, j, i));
                h(n + i, n + j) += c.y[k] * c.data.d2tau_dvdv(k, i, j);
                const double mixed = c.y[k] * c.data.d2tau_dqdv(k, i, j);
                h(i, n + j) += mixed;
                h(n + j, i) += mixed;
                const double along = c.y[k] * c.data.d2tau_dadq(k, i, j);
                h(2 * n + i, j) += along;
                h(j, 2 * n + i) += along;
            }
    put(out, h);
}

} // namespace

extern "C" const peer *peer_open(const char *file, int n) try {
    std::ifstream in(file);
    if (!in) throw std::runtime_error(std::string("cannot read ") + file);
    const Model model = read_model(in);
    if (model.nv != n) throw std::runtime_error("another number of coordinates");
    static std::vector<quantity> quantities;
    quantities = {
        {"a:aba(world)", n, aba<pin::Convention::WORLD>, accelerations},
        {"a:aba(local)", n, aba<pin::Convention::LOCAL>, accelerations},
        {"a_z:computeABADerivatives", 3 * n * n, aba_derivatives, acceleration_jacobian},
        {"Minv:computeMinverse", n * n, minverse, inverse_mass_matrix},
        {"M:crba(world)", n * n, crba<pin::Convention::WORLD>, mass_matrix},
        {"M:crba(local)", n * n, crba<pin::Convention::LOCAL>, mass_matrix},
        {"tau:rnea", n, rnea, torques},
        {"tau_z:computeRNEADerivatives", 3 * n * n, rnea_derivatives, torque_jacobian},
        {"w_tau_zz:ComputeRNEASecondOrderDerivatives", 9 * n * n, second_order_rnea, contracted_torque_hessian},
    };
    static peer result;
    result = {new Context(model), static_cast<int>(quantities.size()), quantities.data()};
    return &result;
} catch (const std::exception &error) {
    std::cerr << "pinocchio: " << error.what() << "\n";
    return nullptr;
}
