/* Accelerations of a UR5 that is let go, and how they change with the angle of their own joint. */
#include <costate.h>
#include <stdio.h>

#define N 6

int main(void) {
    const double q[N] = {0.3, -1.2, 1.4, 0.1, 0.5, 0.0}, v[N] = {0}, tau[N] = {0};
    double f[2 * N], jacobian[2 * N * 3 * N]; /* f = (v, a); its derivatives in (q, v, tau), row by row */
    costate_robot *robot = NULL;
    costate_dynamics *dynamics = NULL;
    const char *name = NULL;
    size_t k;
    int code = costate_robot_from_file("robots/ur5.urdf", 0, &robot);

    if (code == COSTATE_OK) code = costate_dynamics_new(robot, COSTATE_QV, &dynamics);
    if (code == COSTATE_OK) code = costate_jacobian(dynamics, N, q, v, tau, f, jacobian);
    for (k = 0; k < N && code == COSTATE_OK; k++) {
        code = costate_robot_joint_name(robot, k, &name);
        if (code != COSTATE_OK) break;
        printf("%-20s %8.3f rad/s^2 %8.3f per rad\n", name, f[N + k], jacobian[(N + k) * 3 * N + k]);
    }
    if (code != COSTATE_OK) fprintf(stderr, "error %d: %s\n", code, costate_last_error());
    costate_dynamics_delete(dynamics);
    costate_robot_delete(robot);
    return code;
}
