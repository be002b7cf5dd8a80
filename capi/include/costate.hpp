// costate for C++17: handles that delete themselves, vectors, exceptions. costate.h has the conventions.
#ifndef COSTATE_HPP
#define COSTATE_HPP

#include <array>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "costate.h"

namespace costate {

using Vector = std::vector<double>;

// What costate refuses: its code, and what was wrong.
class Error : public std::runtime_error {
public:
    Error(int code, const char *text) : std::runtime_error(text), code_(static_cast<costate_status>(code)) {}
    costate_status code() const noexcept { return code_; }

private:
    costate_status code_;
};

namespace detail {

inline void check(int code) {
    if (code != COSTATE_OK) throw Error(code, costate_last_error());
}

// The vector must have as many entries: C cannot see how long it is.
inline const double *sized(const Vector &of, std::size_t length, const char *name) {
    if (of.size() != length) {
        const std::string text = std::string(name) + " has " + std::to_string(of.size()) + " entries, not " + std::to_string(length);
        throw Error(COSTATE_SIZE, text.c_str());
    }
    return of.data();
}

template <class T, void (*Delete)(T *)>
struct Deleter {
    void operator()(T *handle) const noexcept { Delete(handle); }
};

template <class T, void (*Delete)(T *)>
using Handle = std::unique_ptr<T, Deleter<T, Delete>>;

}  // namespace detail

// A matrix, row by row.
class Matrix {
public:
    Matrix(std::size_t rows, std::size_t columns) : rows_(rows), columns_(columns), entries_(rows * columns) {}
    std::size_t rows() const noexcept { return rows_; }
    std::size_t columns() const noexcept { return columns_; }
    double operator()(std::size_t i, std::size_t j) const { return entries_.at(i * columns_ + j); }
    double *data() noexcept { return entries_.data(); }
    const double *data() const noexcept { return entries_.data(); }

private:
    std::size_t rows_, columns_;
    Vector entries_;
};

// A robot. Any number of threads may use it.
class Robot {
public:
    static Robot from_file(const std::string &path, unsigned options = 0) {
        costate_robot *robot = nullptr;
        detail::check(costate_robot_from_file(path.c_str(), options, &robot));
        return Robot(robot);
    }
    static Robot from_text(const std::string &description, unsigned options = 0) {
        costate_robot *robot = nullptr;
        detail::check(costate_robot_from_text(description.c_str(), options, &robot));
        return Robot(robot);
    }

    std::size_t n() const { return n_; }
    std::string name() const {
        const char *name = nullptr;
        detail::check(costate_robot_name(get(), &name));
        return name;
    }
    std::vector<std::string> joint_names() const { return names(n_, costate_robot_joint_name); }
    std::vector<std::string> frame_names() const {
        std::size_t count = 0;
        detail::check(costate_robot_frames(get(), &count));
        return names(count, costate_robot_frame_name);
    }
    const costate_robot *get() const noexcept { return handle_.get(); }

private:
    explicit Robot(costate_robot *robot) : handle_(robot) { detail::check(costate_robot_n(robot, &n_)); }
    std::vector<std::string> names(std::size_t count, int (*of)(const costate_robot *, std::size_t, const char **)) const {
        std::vector<std::string> all;
        for (std::size_t k = 0; k < count; k++) {
            const char *name = nullptr;
            detail::check(of(get(), k, &name));
            all.emplace_back(name);
        }
        return all;
    }

    detail::Handle<costate_robot, costate_robot_delete> handle_;
    std::size_t n_ = 0;
};

// f (or the next state), its Jacobian, and the Hessian of y'f.
struct Contraction {
    Vector f;
    Matrix jacobian, hessian;
};

// Dynamics in (q, v), or in (q, p) with p in the place of v. A copy is for another thread.
class Dynamics {
public:
    explicit Dynamics(const Robot &robot, costate_coordinates coordinates = COSTATE_QV) : n_(robot.n()) {
        costate_dynamics *dynamics = nullptr;
        detail::check(costate_dynamics_new(robot.get(), coordinates, &dynamics));
        handle_.reset(dynamics);
    }
    Dynamics(const Dynamics &other) : n_(other.n_) {
        costate_dynamics *copy = nullptr;
        detail::check(costate_dynamics_clone(other.handle_.get(), &copy));
        handle_.reset(copy);
    }
    Dynamics(Dynamics &&) noexcept = default;
    Dynamics &operator=(Dynamics other) noexcept {
        handle_.swap(other.handle_);
        n_ = other.n_;
        return *this;
    }

    Vector f(const Vector &q, const Vector &v, const Vector &tau) {
        Vector f(2 * n_);
        detail::check(costate_f(handle_.get(), n_, sized(q, "q"), sized(v, "v"), sized(tau, "tau"), f.data()));
        return f;
    }
    Matrix jacobian(const Vector &q, const Vector &v, const Vector &tau) {
        Matrix jacobian(2 * n_, 3 * n_);
        detail::check(costate_jacobian(handle_.get(), n_, sized(q, "q"), sized(v, "v"), sized(tau, "tau"), nullptr, jacobian.data()));
        return jacobian;
    }
    Matrix hessian(const Vector &q, const Vector &v, const Vector &tau, const Vector &y) {
        return contract(q, v, tau, y).hessian;
    }
    Contraction contract(const Vector &q, const Vector &v, const Vector &tau, const Vector &y) {
        Contraction all{Vector(2 * n_), Matrix(2 * n_, 3 * n_), Matrix(3 * n_, 3 * n_)};
        detail::check(costate_contract(handle_.get(), n_, sized(q, "q"), sized(v, "v"), sized(tau, "tau"),
                                       detail::sized(y, 2 * n_, "y"), all.f.data(), all.jacobian.data(), all.hessian.data()));
        return all;
    }
    Vector aba(const Vector &q, const Vector &v, const Vector &tau) {
        Vector a(n_);
        detail::check(costate_aba(handle_.get(), n_, sized(q, "q"), sized(v, "v"), sized(tau, "tau"), a.data()));
        return a;
    }
    Vector rnea(const Vector &q, const Vector &v, const Vector &a) {
        Vector tau(n_);
        detail::check(costate_rnea(handle_.get(), n_, sized(q, "q"), sized(v, "v"), sized(a, "a"), tau.data()));
        return tau;
    }
    Matrix rnea_jacobian(const Vector &q, const Vector &v, const Vector &a) {
        Matrix jacobian(n_, 3 * n_);
        detail::check(costate_rnea_jacobian(handle_.get(), n_, sized(q, "q"), sized(v, "v"), sized(a, "a"), jacobian.data()));
        return jacobian;
    }
    Matrix crba(const Vector &q) {
        Matrix m(n_, n_);
        detail::check(costate_crba(handle_.get(), n_, sized(q, "q"), m.data()));
        return m;
    }

private:
    const double *sized(const Vector &of, const char *name) const { return detail::sized(of, n_, name); }

    detail::Handle<costate_dynamics, costate_dynamics_delete> handle_;
    std::size_t n_;
};

// Time steps; each thread needs its own.
class Step {
public:
    Step(const Robot &robot, costate_scheme scheme, costate_coordinates coordinates = COSTATE_QV) : n_(robot.n()) {
        costate_step *step = nullptr;
        detail::check(costate_step_new(robot.get(), coordinates, scheme, &step));
        handle_.reset(step);
    }

    Vector f(const Vector &q, const Vector &v, const Vector &tau, double dt) {
        Vector next(2 * n_);
        detail::check(costate_step_f(handle_.get(), n_, sized(q, "q"), sized(v, "v"), sized(tau, "tau"), dt, next.data()));
        return next;
    }
    Matrix jacobian(const Vector &q, const Vector &v, const Vector &tau, double dt) {
        Matrix jacobian(2 * n_, 3 * n_);
        detail::check(costate_step_jacobian(handle_.get(), n_, sized(q, "q"), sized(v, "v"), sized(tau, "tau"), dt, nullptr, jacobian.data()));
        return jacobian;
    }
    Contraction contract(const Vector &q, const Vector &v, const Vector &tau, double dt, const Vector &y) {
        Contraction all{Vector(2 * n_), Matrix(2 * n_, 3 * n_), Matrix(3 * n_, 3 * n_)};
        detail::check(costate_step_contract(handle_.get(), n_, sized(q, "q"), sized(v, "v"), sized(tau, "tau"), dt,
                                            detail::sized(y, 2 * n_, "y"), all.f.data(), all.jacobian.data(), all.hessian.data()));
        return all;
    }

private:
    const double *sized(const Vector &of, const char *name) const { return detail::sized(of, n_, name); }

    detail::Handle<costate_step, costate_step_delete> handle_;
    std::size_t n_;
};

// A frame; each thread needs its own.
class Frame {
public:
    struct Pose {
        std::array<double, 9> rotation;  // row by row; its columns are the axes of the frame
        std::array<double, 3> position;
    };

    Frame(const Robot &robot, const std::string &name, costate_axes axes = COSTATE_LOCAL_WORLD_ALIGNED) : n_(robot.n()) {
        costate_frame *frame = nullptr;
        detail::check(costate_frame_new(robot.get(), name.c_str(), axes, &frame));
        handle_.reset(frame);
    }

    Pose pose(const Vector &q) {
        Pose pose{};
        detail::check(costate_frame_pose(handle_.get(), n_, detail::sized(q, n_, "q"), pose.rotation.data(), pose.position.data()));
        return pose;
    }
    Matrix jacobian(const Vector &q) {
        Matrix jacobian(6, n_);
        detail::check(costate_frame_jacobian(handle_.get(), n_, detail::sized(q, n_, "q"), jacobian.data()));
        return jacobian;
    }
    Matrix position_hessian(const Vector &q, const std::array<double, 3> &w) {
        Matrix hessian(n_, n_);
        detail::check(costate_frame_position_hessian(handle_.get(), n_, detail::sized(q, n_, "q"), w.data(), hessian.data()));
        return hessian;
    }

private:
    detail::Handle<costate_frame, costate_frame_delete> handle_;
    std::size_t n_;
};

}  // namespace costate

#endif
