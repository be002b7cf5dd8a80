// Pinocchio's robots on contacts, from its headers alone.
#include "model.hpp"
#include "peer.h"

#include <pinocchio/algorithm/constrained-dynamics-derivatives.hpp>
#include <pinocchio/algorithm/constrained-dynamics.hpp>

namespace {

// Links that stand on the ground.
using Feet = std::vector<pin::RigidConstraintModel>;

struct Standing : Context {
    Feet feet;
    std::vector<pin::RigidConstraintData> feet_data;
    // No regularisation, so one iteration is exact.
    pin::ProximalSettings settings{1e-12, 0.0, 1};

    Standing(const Model &m, const Feet &feet) : Context(m), feet(feet) {
        for (const auto &foot : feet) feet_data.emplace_back(foot);
        pin::initConstraintDynamics(model, data, feet, feet_data);
    }
};

Feet read_feet(std::istream &in, const Model &model) {
    int count = 0;
    in >> count;
    Feet feet;
    for (int i = 0; i < count; i++) {
        int joint = 0;
        in >> joint;
        pin::SE3 placements[2];
        for (auto &placement : placements) {
            read(in, placement.rotation());
            read(in, placement.translation());
        }
        feet.emplace_back(pin::CONTACT_6D, model, joint, placements[0], 0, placements[1], pin::LOCAL);
    }
    if (!in) throw std::runtime_error("the model is too short");
    return feet;
}

void constrained_derivatives(void *context, const double *state) {
    auto &c = *static_cast<Standing *>(context);
    c.load(state);
    pin::constraintDynamics(c.model, c.data, c.q, c.v, c.u, c.feet, c.feet_data, c.settings);
    pin::computeConstraintDynamicsDerivatives(c.model, c.data, c.feet, c.feet_data, c.settings);
}

// a, the forces in the axes of the feet, and their Jacobians in u. (The other Jacobians are at fixed v, not at fixed p.)
void constrained_responses(void *context, double *out) {
    auto &c = *static_cast<Standing *>(context);
    out = put(out, c.data.ddq);
    out = put(out, c.data.lambda_c);
    out = put(out, c.data.ddq_dtau);
    put(out, c.data.dlambda_dtau);
}

} // namespace

extern "C" const peer *peer_open(const char *file, int n) try {
    std::ifstream in(file);
    if (!in) throw std::runtime_error(std::string("cannot read ") + file);
    const Model model = read_model(in);
    const Feet feet = read_feet(in, model);
    if (model.nv != n) throw std::runtime_error("another number of coordinates");
    const int k = 6 * static_cast<int>(feet.size());
    static std::vector<quantity> quantities;
    quantities = {{"contact:computeConstraintDynamicsDerivatives", (n + k) * (n + 1), constrained_derivatives,
                   constrained_responses}};
    static peer result;
    result = {new Standing(model, feet), static_cast<int>(quantities.size()), quantities.data()};
    return &result;
} catch (const std::exception &error) {
    std::cerr << "pinocchio: " << error.what() << "\n";
    return nullptr;
}
