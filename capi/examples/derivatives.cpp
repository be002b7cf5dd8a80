// Accelerations of a UR5 that is let go, how they change with the angle of their own joint, and where it is then.
#include <costate.hpp>

#include <iomanip>
#include <iostream>

int main() try {
    const auto robot = costate::Robot::from_file("robots/ur5.urdf");
    costate::Dynamics dynamics(robot);  // x = (q, v); COSTATE_QP for (q, p)
    const costate::Vector q{0.3, -1.2, 1.4, 0.1, 0.5, 0.0}, v(6), tau(6), y(12, 1.0);
    const auto [f, jacobian, hessian] = dynamics.contract(q, v, tau, y);
    const auto next = costate::Step(robot, COSTATE_RK4).f(q, v, tau, 0.01);
    std::cout << std::fixed << std::setprecision(3);
    for (std::size_t k = 0; k < robot.n(); k++) {
        std::cout << robot.joint_names()[k] << ": " << f[6 + k] << " rad/s^2, " << jacobian(6 + k, k)
                  << " per rad, q = " << next[k] << " rad after 10 ms\n";
    }
    std::cout << "d2(y'f)/dq1 dq2 = " << hessian(1, 2) << "\n";
    return 0;
} catch (const costate::Error &error) {
    std::cerr << "error " << error.code() << ": " << error.what() << "\n";
    return 1;
}
