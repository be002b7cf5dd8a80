// How an error at the start spreads while an arm swings freely: the covariance of its state, carried along by the
// Jacobians of time steps, beside 300 motions from random starts. Writes a picture, docs/capi.svg, to standard output.
#include <costate.hpp>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <random>
#include <vector>

namespace {

const char *const ARM = R"(
name = "arm"
[[joint]]
name = "shoulder"
axis = [0, 1, 0]
mass = 2.0
com = [0.0, 0.0, -0.5]
inertia = { xx = 0.17, yy = 0.17 }
[[joint]]
name = "elbow"
parent = "shoulder"
placement = { xyz = [0.0, 0.0, -1.0] }
axis = [0, 1, 0]
mass = 1.0
com = [0.0, 0.0, -0.5]
inertia = { xx = 0.08, yy = 0.08 }
[[frame]]
name = "hand"
parent = "elbow"
placement = { xyz = [0.0, 0.0, -1.0] }
)";

const double PI = 3.14159265358979323846;
const double DT = 0.01;                      // s
const double SIGMA_Q = 0.04, SIGMA_V = 0.05; // standard deviations at the start (rad, rad/s)
const costate::Vector FREE{0, 0};            // torques (N m)

struct State {
    costate::Vector q, v;
};

State after(costate::Step &step, const State &x) {
    const costate::Vector next = step.f(x.q, x.v, FREE, DT);
    return {{next[0], next[1]}, {next[2], next[3]}};
}

// J P J', J being the rows of a Jacobian from this one on and its columns of P.
costate::Matrix carried(const costate::Matrix &jacobian, std::size_t row, std::size_t rows, const costate::Matrix &P,
                        std::size_t columns) {
    costate::Matrix result(rows, rows);
    for (std::size_t i = 0; i < rows; i++)
        for (std::size_t j = 0; j < rows; j++)
            for (std::size_t k = 0; k < columns; k++)
                for (std::size_t l = 0; l < columns; l++)
                    result.data()[rows * i + j] += jacobian(row + i, k) * P(k, l) * jacobian(row + j, l);
    return result;
}

// A normal deviate, the same with every compiler.
double normal(std::mt19937 &random) {
    const double a = (random() + 0.5) / 4294967296.0, b = (random() + 0.5) / 4294967296.0;
    return std::sqrt(-2 * std::log(a)) * std::cos(2 * PI * b);
}

// The picture: 170 pixels for a metre.
double at_x(double x) { return 320 + 170 * x; }
double at_z(double z) { return 40 - 170 * z; }

void point(const char *command, double x, double z) { std::printf("%s%.1f %.1f", command, at_x(x), at_z(z)); }
void point(const char *command, const costate::Frame::Pose &pose) {
    point(command, pose.position[0], pose.position[2]);
}

void begin() {
    std::puts("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 390\" width=\"640\" height=\"390\">\n<style>\n"
              ":root { --ground: #fff; --ink: #1b1f24; --arm: #8a949e; --dots: #c85000; --line: #005aa0; }\n"
              "@media (prefers-color-scheme: dark) {\n"
              "  :root { --ground: #12161c; --ink: #e6edf3; --arm: #76828e; --dots: #ff9a55; --line: #5fb0f5; }\n}\n"
              "rect { fill: var(--ground); }\ntext { font: 14px sans-serif; fill: var(--ink); text-anchor: middle; }\n"
              "path { fill: none; stroke-linejoin: round; stroke-linecap: round; }\n"
              ".arm { stroke: var(--arm); stroke-width: 3; }\n.ellipse { stroke: var(--line); stroke-width: 2; }\n"
              ".dots { stroke: var(--dots); stroke-width: 3; opacity: 0.6; }\n"
              "</style>\n<rect width=\"640\" height=\"390\"/>");
}

// The arm, where the samples have their hands, and the ellipse of two standard deviations; the share of samples in it.
double draw(double t, const State &mean, const costate::Matrix &P, const std::vector<State> &samples,
            costate::Frame &elbow, costate::Frame &hand) {
    // Covariance of the position of the hand: the linear rows of its Jacobian, the angles' part of P.
    const costate::Matrix S = carried(hand.jacobian(mean.q), 3, 3, P, 2);
    const double xx = S(0, 0), xz = S(0, 2), zz = S(2, 2), det = xx * zz - xz * xz;
    const costate::Frame::Pose pose = hand.pose(mean.q);
    const double x = pose.position[0], z = pose.position[2];

    point("<path class=\"arm\" d=\"M", 0, 0);
    point("L", elbow.pose(mean.q));
    point("L", pose);
    std::printf("\"/>\n<path class=\"dots\" d=\"");
    int inside = 0;
    for (const State &sample : samples) {
        const costate::Frame::Pose found = hand.pose(sample.q);
        const double dx = found.position[0] - x, dz = found.position[2] - z;
        inside += zz * dx * dx - 2 * xz * dx * dz + xx * dz * dz <= 4 * det;
        point("M", found);
        std::printf("h0");
    }
    std::printf("\"/>\n<path class=\"ellipse\" d=\"");
    for (int i = 0; i < 60; i++) {
        const double c = 2 * std::cos(PI / 30 * i), s = 2 * std::sin(PI / 30 * i);
        point(i == 0 ? "M" : "L", x + std::sqrt(xx) * c, z + (xz * c + std::sqrt(det) * s) / std::sqrt(xx));
    }
    const bool beside = x > 0.5;  // Elsewhere the text is below the hand.
    const double share = static_cast<double>(inside) / static_cast<double>(samples.size());
    std::printf("Z\"/>\n<text x=\"%.0f\" y=\"%.0f\">%.1f s: %.0f %%</text>\n", at_x(x + (beside ? 0.5 : 0)),
                at_z(z - (beside ? 0 : 0.36)), t, 100 * share);
    return share;
}

}  // namespace

int main() try {
    const costate::Robot robot = costate::Robot::from_text(ARM);
    costate::Step step(robot, COSTATE_RK4);
    costate::Frame elbow(robot, "elbow"), hand(robot, "hand");

    State mean{{-1.3, 1.3}, {0, 0}};
    costate::Matrix P(4, 4);
    for (std::size_t i = 0; i < 4; i++) P.data()[5 * i] = i < 2 ? SIGMA_Q * SIGMA_Q : SIGMA_V * SIGMA_V;
    std::mt19937 random(1);
    std::vector<State> samples(300, mean);
    for (State &sample : samples) {
        for (double &q : sample.q) q += SIGMA_Q * normal(random);
        for (double &v : sample.v) v += SIGMA_V * normal(random);
    }

    bool good = true;
    begin();
    for (int k = 0; k <= 90; k++) {
        if (k % 30 == 0) {
            const double share = draw(k * DT, mean, P, samples, elbow, hand);
            good = good && share > 0.8 && share < 0.95;
        }
        // Rows of the next state (q, v), columns of (q, v, tau): P becomes A P A', A the first four columns.
        P = carried(step.jacobian(mean.q, mean.v, FREE, DT), 0, 4, P, 4);
        mean = after(step, mean);
        for (State &sample : samples) sample = after(step, sample);
    }
    std::puts("</svg>");
    return good ? 0 : 1;
} catch (const costate::Error &error) {
    std::cerr << "error " << error.code() << ": " << error.what() << "\n";
    return 1;
}
