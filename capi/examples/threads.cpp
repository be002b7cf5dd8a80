// Dynamics of a robot file on two threads, each with its own copy; prints tau' a of both.
#include <costate.hpp>

#include <cmath>
#include <iostream>
#include <thread>

int main(int argc, char **argv) {
    if (argc != 2) {
        std::cerr << "usage: threads ROBOT\n";
        return 2;
    }
    try {
        const auto robot = costate::Robot::from_file(argv[1]);
        const std::size_t n = robot.n();
        costate::Dynamics dynamics(robot);
        const costate::Vector q(n, 0.3), v(n, -0.2), tau(n, 1.0), y(2 * n, 1.0);
        double sums[2] = {0, 0};
        const auto work = [&](costate::Dynamics own, double *sum) {
            for (int k = 0; k < 1000; k++) {
                const auto all = own.contract(q, v, tau, y);
                *sum = 0;
                for (std::size_t i = 0; i < n; i++) *sum += all.f[n + i] * tau[i];
            }
        };
        std::thread first(work, dynamics, &sums[0]), second(work, dynamics, &sums[1]);
        first.join();
        second.join();
        const auto step = costate::Step(robot, COSTATE_RK4).f(q, v, tau, 1e-3);
        if (sums[0] != sums[1] || std::abs(step[0] - q[0] - 1e-3 * v[0]) > 1e-2) return 1;
        std::cout << robot.name() << ": " << robot.joint_names().front() << ", tau' a = " << sums[0] << "\n";
        try {
            dynamics.f({0.0}, v, tau);
            return 1;
        } catch (const costate::Error &error) {
            if (error.code() != COSTATE_SIZE) return 1;
        }
        try {
            costate::Frame(robot, "no such frame");
            return 1;
        } catch (const costate::Error &error) {
            return error.code() == COSTATE_ROBOT ? 0 : 1;
        }
    } catch (const costate::Error &error) {
        std::cerr << "error " << error.code() << ": " << error.what() << "\n";
        return 1;
    }
}
