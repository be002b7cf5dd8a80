// A model of Pinocchio from a text file that harness/describe.py writes of what Pinocchio's own URDF reader has made.
#ifndef MODEL_HPP
#define MODEL_HPP

#include "joints.hpp"

#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace pin = pinocchio;
using Vector = Eigen::VectorXd;

#ifdef ALL_JOINTS
using Joint = pin::JointModel;
using Model = pin::Model;
using Data = pin::Data;
#else
using Joint = pin::JointModelTpl<double, 0, pin::FewJointsTpl>;
using Model = pin::ModelTpl<double, 0, pin::FewJointsTpl>;
using Data = pin::DataTpl<double, 0, pin::FewJointsTpl>;
#endif

namespace {

struct Context {
    Model model;
    Data data;
    int n;
    Vector q, v, u, a, y;

    explicit Context(const Model &m)
        : model(m), data(m), n(m.nv), q(m.nq), v(n), u(n), a(n), y(2 * n) {}

    void load(const double *state) {
        q = Eigen::Map<const Vector>(state, model.nq);
        const double *rest = state + model.nq;
        v = Eigen::Map<const Vector>(rest, n);
        u = Eigen::Map<const Vector>(rest + 2 * n, n);
        a = Eigen::Map<const Vector>(rest + 3 * n, n);
        y = Eigen::Map<const Vector>(rest + 4 * n, 2 * n);
    }
};

// RX, RY, RZ, PX, PY, PZ where the axis is one of the frame's, as Pinocchio's URDF reader chooses them.
Joint joint(const std::string &kind, const Eigen::Vector3d &axis) {
    if (kind == "JointModelRX") return Joint(pin::JointModelRX());
    if (kind == "JointModelRY") return Joint(pin::JointModelRY());
    if (kind == "JointModelRZ") return Joint(pin::JointModelRZ());
    if (kind == "JointModelPX") return Joint(pin::JointModelPX());
    if (kind == "JointModelPY") return Joint(pin::JointModelPY());
    if (kind == "JointModelPZ") return Joint(pin::JointModelPZ());
    if (kind == "JointModelRevoluteUnaligned") return Joint(pin::JointModelRevoluteUnaligned(axis));
    if (kind == "JointModelFreeFlyer") return Joint(pin::JointModelFreeFlyer());
    if (kind == "JointModelPrismaticUnaligned") return Joint(pin::JointModelPrismaticUnaligned(axis));
    throw std::runtime_error("no joint of the kind " + kind + " here");
}

template <typename Matrix> void read(std::istream &in, Matrix &m) {
    for (int i = 0; i < m.rows(); i++)
        for (int j = 0; j < m.cols(); j++) in >> m(i, j);
}

Model read_model(std::istream &in) {
    int joints = 0;
    Eigen::Vector3d gravity;
    in >> joints;
    read(in, gravity);
    Model model;
    model.gravity.linear() = gravity;
    for (int i = 1; i <= joints; i++) {
        std::string kind;
        int parent = 0;
        double mass = 0.0;
        Eigen::Vector3d axis, translation, lever;
        Eigen::Matrix3d rotation, inertia;
        in >> kind >> parent;
        read(in, axis);
        read(in, rotation);
        read(in, translation);
        in >> mass;
        read(in, lever);
        read(in, inertia);
        if (!in) throw std::runtime_error("the model is too short");
        model.addJoint(parent, joint(kind, axis), pin::SE3(rotation, translation), "joint" + std::to_string(i));
        model.inertias[i] = pin::Inertia(mass, lever, inertia);
    }
    return model;
}

// Row by row.
template <typename Matrix> double *put(double *out, const Matrix &m) {
    for (Eigen::Index i = 0; i < m.rows(); i++)
        for (Eigen::Index j = 0; j < m.cols(); j++) *out++ = m(i, j);
    return out;
}

} // namespace

#endif
