/**
 * @file
 * costate: robot dynamics with exact first and second derivatives.
 *
 * Robots, dynamics, steps and frames are handles, made by `costate_*_new` or `costate_robot_from_*` and deleted by
 * `costate_*_delete` (NULL is allowed). Every other function returns a code of costate_status; COSTATE_OK is 0.
 * After another code costate_last_error() says what was wrong; results are then not to be read. A handle that
 * could not be made is NULL. A failed call leaves its handle usable.
 *
 * Units are rad, m, kg, s, N m, N. q, v and tau have n entries in the order of costate_robot_joint_name, which is
 * that of Pinocchio for most robots. x = (q, v), or (q, p) with conjugate momenta p = M v: then give p for v.
 * z = (q, v, tau). f = dx/dt has 2n entries; y, the costate of f, has 2n. Matrices lie row by row: a Jacobian
 * has a row for each result, a Hessian is contracted with y and symmetric. Numbers in brackets are sizes.
 * Arrays may overlap; n is checked against the robot, and arrays must have their sizes. Pointers must not be
 * NULL where it is not said that they may be.
 *
 * Threads: any handle can be used from any thread. Calls on one handle wait for each other, so give each thread
 * its own dynamics (costate_dynamics_clone shares the machine code), steps and frames. Deleting is the
 * exception: nobody may use the handle then. The text of the last error belongs to the thread.
 *
 * The first call of each quantity records it and makes machine code, which takes milliseconds and memory; later
 * calls do not allocate.
 */
#ifndef COSTATE_H
#define COSTATE_H

/* Made by cbindgen of capi/src and capi/cbindgen.toml. */

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * What functions return.
 */
typedef enum {
    /**
     * Results are written.
     */
    COSTATE_OK = 0,
    /**
     * A pointer that must not be NULL is.
     */
    COSTATE_NULL = 1,
    /**
     * No value of its enum, no such index, or text that is not UTF-8.
     */
    COSTATE_ARGUMENT = 2,
    /**
     * n is not that of the robot.
     */
    COSTATE_SIZE = 3,
    /**
     * A file that cannot be read.
     */
    COSTATE_FILE = 4,
    /**
     * A robot that cannot be built, or a name that it does not have.
     */
    COSTATE_ROBOT = 5,
    /**
     * An argument is infinite or not a number.
     */
    COSTATE_NON_FINITE = 6,
    /**
     * The mass matrix has no inverse.
     */
    COSTATE_SINGULAR = 7,
    /**
     * An implicit step was not solved: take a shorter one.
     */
    COSTATE_STEP = 8,
    /**
     * Anything else that an evaluation refuses.
     */
    COSTATE_EVALUATION = 9,
    /**
     * A defect of costate.
     */
    COSTATE_INTERNAL = 10,
} costate_status;

/**
 * The state x.
 */
typedef enum {
    /**
     * x = (q, v).
     */
    COSTATE_QV = 0,
    /**
     * x = (q, p), p = M v: functions take p in the place of v.
     */
    COSTATE_QP = 1,
} costate_coordinates;

/**
 * Schemes of time steps.
 */
typedef enum {
    /**
     * The classical method of Runge and Kutta, of order four.
     */
    COSTATE_RK4 = 0,
    /**
     * The implicit midpoint rule, of order two.
     */
    COSTATE_MIDPOINT = 1,
    /**
     * Stoermer-Verlet, of order two, with COSTATE_QP.
     */
    COSTATE_VERLET = 2,
    /**
     * v first, then q with the new v, of order one, with COSTATE_QV.
     */
    COSTATE_SEMI_IMPLICIT_EULER = 3,
} costate_scheme;

/**
 * Axes and point of six-vectors, as in Pinocchio.
 */
typedef enum {
    /**
     * Axes of the world, velocity of the origin of the frame.
     */
    COSTATE_LOCAL_WORLD_ALIGNED = 0,
    /**
     * Axes of the frame, velocity of its origin.
     */
    COSTATE_LOCAL = 1,
    /**
     * Axes of the world, velocity of the point of the body at the origin of the world.
     */
    COSTATE_WORLD = 2,
} costate_axes;

/**
 * Options of robots, which can be added up.
 */
typedef enum {
    /**
     * Load `<dynamics damping friction>` of a URDF as viscous and smooth Coulomb friction.
     */
    COSTATE_LOAD_FRICTION = 1,
    /**
     * Refuse what suggests a mistake, such as an inertia that no rigid body has.
     */
    COSTATE_LOAD_STRICT = 2,
} costate_load;

/**
 * Dynamics of a robot in one of costate_coordinates, on machine code.
 */
typedef struct costate_dynamics costate_dynamics;

/**
 * A frame of a robot. Its six-vectors are (angular, linear); Pinocchio has the linear part first.
 */
typedef struct costate_frame costate_frame;

/**
 * A robot: joints, masses, limits, frames.
 *
 * It may be deleted before what was made from it.
 */
typedef struct costate_robot costate_robot;

/**
 * A time step: x after dt seconds under constant tau.
 */
typedef struct costate_step costate_step;

/**
 * What was wrong with the last call of this thread that failed, in UTF-8; valid until the next one that
 * fails.
 */
const char *costate_last_error(void);

/**
 * The version of the library, such as "0.1.0".
 */
const char *costate_version(void);

/**
 * Reads a robot from a .urdf or .toml file; options are values of costate_load added up, or 0.
 */
int costate_robot_from_file(const char *path, unsigned int options, costate_robot **robot);

/**
 * Reads a robot from the text of a URDF or of a robot in TOML.
 */
int costate_robot_from_text(const char *description, unsigned int options, costate_robot **robot);

/**
 * Deletes a robot, and with it the names that were read from it.
 */
void costate_robot_delete(costate_robot *robot);

/**
 * Number of joints that mimic no other one: the length of q, v and tau.
 */
int costate_robot_n(const costate_robot *robot, size_t *n);

/**
 * Name of the robot, which lives as long as the handle. So do those of joints and frames.
 */
int costate_robot_name(const costate_robot *robot, const char **name);

/**
 * Name of the joint of q[k], k < n.
 */
int costate_robot_joint_name(const costate_robot *robot, size_t k, const char **name);

/**
 * Number of frames.
 */
int costate_robot_frames(const costate_robot *robot, size_t *count);

/**
 * Name of a frame, k < count: the world, then those of joints, of links, and added ones.
 */
int costate_robot_frame_name(const costate_robot *robot, size_t k, const char **name);

/**
 * Makes dynamics in these coordinates, a value of costate_coordinates.
 */
int costate_dynamics_new(const costate_robot *robot, int coordinates, costate_dynamics **dynamics);

/**
 * Makes a copy for another thread; both share machine code.
 */
int costate_dynamics_clone(const costate_dynamics *dynamics, costate_dynamics **copy);

/**
 * Deletes dynamics.
 */
void costate_dynamics_delete(costate_dynamics *dynamics);

/**
 * f = dx/dt [2n].
 */
int costate_f(costate_dynamics *dynamics, size_t n, const double *q, const double *v, const double *tau, double *f);

/**
 * f [2n], which may be NULL, and df/dz [2n * 3n].
 */
int costate_jacobian(costate_dynamics *dynamics,
                     size_t n,
                     const double *q,
                     const double *v,
                     const double *tau,
                     double *f,
                     double *jacobian);

/**
 * d2(y'f)/dz2 [3n * 3n], y [2n].
 */
int costate_hessian(costate_dynamics *dynamics,
                    size_t n,
                    const double *q,
                    const double *v,
                    const double *tau,
                    const double *y,
                    double *hessian);

/**
 * f [2n] and df/dz [2n * 3n], which may be NULL, and d2(y'f)/dz2 [3n * 3n] from one sweep, y [2n].
 */
int costate_contract(costate_dynamics *dynamics,
                     size_t n,
                     const double *q,
                     const double *v,
                     const double *tau,
                     const double *y,
                     double *f,
                     double *jacobian,
                     double *hessian);

/**
 * Forward dynamics: accelerations a [n], for velocities v in either coordinates.
 */
int costate_aba(costate_dynamics *dynamics, size_t n, const double *q, const double *v, const double *tau, double *a);

/**
 * Inverse dynamics: tau [n] for velocities and accelerations, in either coordinates.
 */
int costate_rnea(costate_dynamics *dynamics,
                 size_t n,
                 const double *q,
                 const double *v,
                 const double *a,
                 double *tau);

/**
 * d tau/d(q, v, a) [n * 3n], for velocities and accelerations, in either coordinates.
 */
int costate_rnea_jacobian(costate_dynamics *dynamics,
                          size_t n,
                          const double *q,
                          const double *v,
                          const double *a,
                          double *jacobian);

/**
 * The mass matrix M [n * n], armature included.
 */
int costate_crba(costate_dynamics *dynamics, size_t n, const double *q, double *m);

/**
 * Makes a step, for values of costate_coordinates and of costate_scheme.
 */
int costate_step_new(const costate_robot *robot, int coordinates, int scheme, costate_step **step);

/**
 * Deletes a step.
 */
void costate_step_delete(costate_step *step);

/**
 * The next state [2n].
 */
int costate_step_f(costate_step *step,
                   size_t n,
                   const double *q,
                   const double *v,
                   const double *tau,
                   double dt,
                   double *next);

/**
 * The next state [2n], which may be NULL, and its Jacobian in z [2n * 3n].
 */
int costate_step_jacobian(costate_step *step,
                          size_t n,
                          const double *q,
                          const double *v,
                          const double *tau,
                          double dt,
                          double *next,
                          double *jacobian);

/**
 * The next state [2n] and its Jacobian in z [2n * 3n], which may be NULL, and the second derivatives of
 * y' next in z [3n * 3n], y [2n].
 */
int costate_step_contract(costate_step *step,
                          size_t n,
                          const double *q,
                          const double *v,
                          const double *tau,
                          double dt,
                          const double *y,
                          double *next,
                          double *jacobian,
                          double *hessian);

/**
 * Makes the frame of this name with a value of costate_axes.
 */
int costate_frame_new(const costate_robot *robot, const char *name, int axes, costate_frame **frame);

/**
 * Deletes a frame.
 */
void costate_frame_delete(costate_frame *frame);

/**
 * Orientation [3 * 3], whose columns are the axes of the frame, and position [3] in the world; either may
 * be NULL.
 */
int costate_frame_pose(costate_frame *frame, size_t n, const double *q, double *rotation, double *position);

/**
 * J [6 * n]: twist = J v.
 */
int costate_frame_jacobian(costate_frame *frame, size_t n, const double *q, double *jacobian);

/**
 * Second derivatives [n * n] of w'x, x the position in the world and w [3].
 */
int costate_frame_position_hessian(costate_frame *frame, size_t n, const double *q, const double *w, double *hessian);

#ifdef __cplusplus
}
#endif

#endif
