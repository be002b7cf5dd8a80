/*
 * costate: robot dynamics with exact first and second derivatives.
 *
 * Robots, dynamics, steps and frames are handles, made by *_new or costate_robot_from_* and deleted by *_delete
 * (NULL is allowed). Every other function returns a code of enum costate_status; COSTATE_OK is 0. After
 * another code costate_last_error() says what was wrong; results are then not to be read. A handle that could not
 * be made is NULL. A failed call leaves its handle usable.
 *
 * Units are rad, m, kg, s, N m, N. q, v and tau have n entries in the order of costate_robot_joint_name, which is
 * that of Pinocchio for most robots. x = (q, v), or (q, p) with conjugate momenta p = M v: then give p for v.
 * z = (q, v, tau). f = dx/dt has 2n entries; y, the costate of f, has 2n. Matrices lie row by row: a Jacobian
 * has a row for each result, a Hessian is contracted with y and symmetric. Arrays may overlap; n is checked
 * against the robot, and arrays must have the sizes that their declarations show.
 *
 * Threads: any handle can be used from any thread. Calls on one dynamics, step or frame handle wait for each
 * other, so give each thread its own (costate_dynamics_clone shares the machine code). Deleting is the
 * exception: nobody may use the handle then. The text of the last error belongs to the thread.
 *
 * The first call of each quantity records it and makes machine code, which takes milliseconds and memory; later
 * calls do not allocate.
 */
#ifndef COSTATE_H
#define COSTATE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum costate_status {
    COSTATE_OK = 0,
    COSTATE_NULL = 1,        /* a pointer that must not be NULL is */
    COSTATE_ARGUMENT = 2,    /* no value of its enum, or text that is not UTF-8 */
    COSTATE_SIZE = 3,        /* n is not that of the robot */
    COSTATE_FILE = 4,        /* a file that cannot be read */
    COSTATE_ROBOT = 5,       /* a robot that cannot be built, or a name that it does not have */
    COSTATE_NON_FINITE = 6,  /* an argument is infinite or not a number */
    COSTATE_SINGULAR = 7,    /* the mass matrix has no inverse */
    COSTATE_STEP = 8,        /* an implicit step was not solved: take a shorter one */
    COSTATE_EVALUATION = 9,  /* anything else that an evaluation refuses */
    COSTATE_INTERNAL = 10    /* a defect of costate */
};

/* The state: (q, v) or (q, p). */
enum costate_coordinates { COSTATE_QV = 0, COSTATE_QP = 1 };

/* Steps: classical Runge-Kutta; implicit midpoint; Stoermer-Verlet (QP); v first, then q with the new v (QV). */
enum costate_scheme { COSTATE_RK4 = 0, COSTATE_MIDPOINT = 1, COSTATE_VERLET = 2, COSTATE_SEMI_IMPLICIT_EULER = 3 };

/* Axes and point of six-vectors, as in Pinocchio. */
enum costate_axes { COSTATE_LOCAL_WORLD_ALIGNED = 0, COSTATE_LOCAL = 1, COSTATE_WORLD = 2 };

/* Options of robots: load <dynamics damping friction> of a URDF; refuse what suggests a mistake. */
enum costate_load { COSTATE_LOAD_FRICTION = 1, COSTATE_LOAD_STRICT = 2 };

typedef struct costate_robot costate_robot;
typedef struct costate_dynamics costate_dynamics;
typedef struct costate_step costate_step;
typedef struct costate_frame costate_frame;

/* What was wrong with the last call of this thread that failed; valid until the next one that fails. */
const char *costate_last_error(void);

/* The version of the library, such as "0.1.0". */
const char *costate_version(void);

/* ---- Robots ---- */

/* Reads a .urdf or .toml file; options are values of enum costate_load added up, or 0. */
int costate_robot_from_file(const char *path, unsigned int options, costate_robot **robot);

/* Reads the text of a URDF or of a robot in TOML. */
int costate_robot_from_text(const char *description, unsigned int options, costate_robot **robot);

void costate_robot_delete(costate_robot *robot);

/* Number of joints that mimic no other one: the length of q, v and tau. */
int costate_robot_n(const costate_robot *robot, size_t *n);

/* Names live as long as the robot. */
int costate_robot_name(const costate_robot *robot, const char **name);

/* The joint of q[k]. */
int costate_robot_joint_name(const costate_robot *robot, size_t k, const char **name);

/* Number of frames, and their names: the world, then those of joints, of links, and added ones. */
int costate_robot_frames(const costate_robot *robot, size_t *count);
int costate_robot_frame_name(const costate_robot *robot, size_t k, const char **name);

/* ---- Dynamics ---- */

int costate_dynamics_new(const costate_robot *robot, int coordinates, costate_dynamics **dynamics);

/* The same dynamics, for another thread. */
int costate_dynamics_clone(const costate_dynamics *dynamics, costate_dynamics **copy);

void costate_dynamics_delete(costate_dynamics *dynamics);

/* f = dx/dt [2n]. */
int costate_f(costate_dynamics *dynamics, size_t n, const double *q, const double *v, const double *tau, double *f);

/* f [2n], which may be NULL, and df/dz [2n * 3n]. */
int costate_jacobian(costate_dynamics *dynamics, size_t n, const double *q, const double *v, const double *tau,
                     double *f, double *jacobian);

/* d2(y'f)/dz2 [3n * 3n]. */
int costate_hessian(costate_dynamics *dynamics, size_t n, const double *q, const double *v, const double *tau,
                    const double *y, double *hessian);

/* f and df/dz, which may be NULL, and d2(y'f)/dz2 from one sweep. */
int costate_contract(costate_dynamics *dynamics, size_t n, const double *q, const double *v, const double *tau,
                     const double *y, double *f, double *jacobian, double *hessian);

/* Forward dynamics: accelerations a [n], for velocities v in either coordinates. */
int costate_aba(costate_dynamics *dynamics, size_t n, const double *q, const double *v, const double *tau, double *a);

/* Inverse dynamics: tau [n] for velocities and accelerations, in either coordinates. */
int costate_rnea(costate_dynamics *dynamics, size_t n, const double *q, const double *v, const double *a, double *tau);

/* d tau/d(q, v, a) [n * 3n]. */
int costate_rnea_jacobian(costate_dynamics *dynamics, size_t n, const double *q, const double *v, const double *a,
                          double *jacobian);

/* The mass matrix [n * n], armature included. */
int costate_crba(costate_dynamics *dynamics, size_t n, const double *q, double *m);

/* ---- Time steps: x after dt seconds under constant tau ---- */

int costate_step_new(const costate_robot *robot, int coordinates, int scheme, costate_step **step);
void costate_step_delete(costate_step *step);

/* The next state [2n]. */
int costate_step_f(costate_step *step, size_t n, const double *q, const double *v, const double *tau, double dt,
                   double *next);

/* The next state, which may be NULL, and its Jacobian in z [2n * 3n]. */
int costate_step_jacobian(costate_step *step, size_t n, const double *q, const double *v, const double *tau, double dt,
                          double *next, double *jacobian);

/* Both, which may be NULL, and the second derivatives of y' next in z [3n * 3n]. */
int costate_step_contract(costate_step *step, size_t n, const double *q, const double *v, const double *tau, double dt,
                          const double *y, double *next, double *jacobian, double *hessian);

/* ---- Frames ---- */

/* Six-vectors are (angular, linear) in these axes; Pinocchio has the linear part first. */
int costate_frame_new(const costate_robot *robot, const char *name, int axes, costate_frame **frame);
void costate_frame_delete(costate_frame *frame);

/* Orientation [9], whose columns are the axes of the frame, and position [3], in the world; either may be NULL. */
int costate_frame_pose(costate_frame *frame, size_t n, const double *q, double *rotation, double *position);

/* J [6 * n]: twist = J v. */
int costate_frame_jacobian(costate_frame *frame, size_t n, const double *q, double *jacobian);

/* Second derivatives [n * n] of w'x, x the position in the world and w [3]. */
int costate_frame_position_hessian(costate_frame *frame, size_t n, const double *q, const double *w, double *hessian);

#ifdef __cplusplus
}
#endif

#endif
