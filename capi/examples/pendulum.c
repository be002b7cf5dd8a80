/* A point mass of 2 kg, 0.7 m below a hinge: everything that the library computes of it is known. */
#include <costate.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const TEXT =
    "name = 'pendulum'\n[[joint]]\nname = 'hinge'\naxis = [0, 1, 0]\nmass = 2.0\ncom = [0.0, 0.0, -0.7]\n"
    "[[frame]]\nname = 'bob'\nparent = 'hinge'\nplacement = { xyz = [0.0, 0.0, -0.7] }\n";

static int failures = 0;

static void expect(int holds, const char *what) {
    if (!holds) {
        failures++;
        printf("failed: %s (%s)\n", what, costate_last_error());
    }
}

static int near(double found, double expected) { return fabs(found - expected) <= 1e-12 * (1 + fabs(expected)); }

int main(void) {
    const double g = 9.81, m = 2, l = 0.7, q = 0.3, v = -0.8, tau = 0.5, y[2] = {0.4, -1.5};
    double f[2], jacobian[6], hessian[9], a, back, inertia, rotation[9], position[3], frame_jacobian[6], curvature;
    const double w[3] = {1, 0, 0};
    costate_robot *robot = NULL, *none = NULL;
    costate_dynamics *dynamics = NULL, *copy = NULL;
    costate_step *step = NULL;
    costate_frame *bob = NULL;
    const char *name = NULL;
    size_t n = 0, frames = 0;

    expect(costate_robot_from_text(TEXT, 0, &robot) == COSTATE_OK, "the robot is read");
    expect(costate_robot_n(robot, &n) == COSTATE_OK && n == 1, "it has one joint");
    expect(costate_robot_joint_name(robot, 0, &name) == COSTATE_OK && strcmp(name, "hinge") == 0, "its name");
    expect(costate_robot_frames(robot, &frames) == COSTATE_OK && frames >= 2, "its frames");
    expect(costate_dynamics_new(robot, COSTATE_QV, &dynamics) == COSTATE_OK, "its dynamics");
    expect(costate_dynamics_clone(dynamics, &copy) == COSTATE_OK, "a copy");
    expect(costate_step_new(robot, COSTATE_QV, COSTATE_SEMI_IMPLICIT_EULER, &step) == COSTATE_OK, "a step");
    expect(costate_frame_new(robot, "bob", COSTATE_LOCAL_WORLD_ALIGNED, &bob) == COSTATE_OK, "a frame");
    costate_robot_delete(robot); /* The others keep what they need. */

    expect(costate_contract(dynamics, 1, &q, &v, &tau, y, f, jacobian, hessian) == COSTATE_OK, "everything");
    expect(near(f[0], v) && near(f[1], tau / (m * l * l) - g / l * sin(q)), "f");
    expect(near(jacobian[0], 0) && near(jacobian[1], 1) && near(jacobian[3], -g / l * cos(q)), "df/dx");
    expect(near(jacobian[2], 0) && near(jacobian[5], 1 / (m * l * l)), "df/dtau");
    expect(near(hessian[0], y[1] * g / l * sin(q)) && near(hessian[4], 0) && near(hessian[8], 0), "d2(y'f)/dz2");
    expect(costate_aba(copy, 1, &q, &v, &tau, &a) == COSTATE_OK && near(a, f[1]), "forward dynamics");
    expect(costate_rnea(copy, 1, &q, &v, &a, &back) == COSTATE_OK && near(back, tau), "inverse dynamics");
    expect(costate_crba(copy, 1, &q, &inertia) == COSTATE_OK && near(inertia, m * l * l), "the mass matrix");
    expect(costate_step_f(step, 1, &q, &v, &tau, 0.1, f) == COSTATE_OK && near(f[1], v + 0.1 * a), "the next velocity");
    expect(near(f[0], q + 0.1 * (v + 0.1 * a)), "the next position");
    expect(costate_frame_pose(bob, 1, &q, rotation, position) == COSTATE_OK && near(position[0], -l * sin(q)), "a pose");
    expect(near(rotation[0], cos(q)) && near(rotation[2], sin(q)), "an orientation");
    expect(costate_frame_jacobian(bob, 1, &q, frame_jacobian) == COSTATE_OK && near(frame_jacobian[1], 1), "angular rows");
    expect(near(frame_jacobian[3], -l * cos(q)) && near(frame_jacobian[5], l * sin(q)), "linear rows");
    expect(costate_frame_position_hessian(bob, 1, &q, w, &curvature) == COSTATE_OK && near(curvature, l * sin(q)), "x_qq");

    expect(costate_f(NULL, 1, &q, &v, &tau, f) == COSTATE_NULL, "a handle that is NULL");
    expect(costate_f(dynamics, 1, &q, NULL, &tau, f) == COSTATE_NULL, "an argument that is NULL");
    expect(strcmp(costate_last_error(), "v is NULL") == 0, "which one");
    expect(costate_f(dynamics, 1, &q, &v, &tau, NULL) == COSTATE_NULL, "a result that is NULL");
    expect(costate_f(dynamics, 6, &q, &v, &tau, f) == COSTATE_SIZE, "a size of another robot");
    a = NAN;
    expect(costate_f(dynamics, 1, &a, &v, &tau, f) == COSTATE_NON_FINITE, "a state that is not finite");
    expect(strstr(costate_last_error(), "hinge") != NULL, "which joint");
    expect(costate_f(dynamics, 1, &q, &v, &tau, f) == COSTATE_OK, "the handle remains usable");
    expect(costate_robot_from_file("nowhere.urdf", 0, &none) == COSTATE_FILE && none == NULL, "a missing file");
    expect(costate_robot_from_text("<robot", 0, &none) == COSTATE_ROBOT && none == NULL, "text that is no robot");
    expect(costate_robot_from_text(TEXT, 0, NULL) == COSTATE_NULL, "no place for the robot");

    costate_dynamics_delete(dynamics);
    costate_dynamics_delete(copy);
    costate_dynamics_delete(NULL);
    costate_step_delete(step);
    costate_frame_delete(bob);
    printf("costate %s: %s\n", costate_version(), failures == 0 ? "all is as expected" : "FAILED");
    return failures;
}
