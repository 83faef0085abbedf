/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/bodies.h - rigid bodies with shapes, in a plane or in space: they collide, rub, stack, and
 * sleep. Experimental.
 *
 *     fp3_error error;
 *     fp3_bodies_def def = fp3_bodies_default();
 *     def.error = &error;
 *     fp3_bodies *world = NULL;
 *     fp3_body_def ground = fp3_body_default(), box = fp3_body_default();
 *     ground.type = FP3_STATIC;
 *     box.x[1] = 4;
 *     fp3_shape_def floor = fp3_shape_box(50, 1, 0), cube = fp3_shape_box(0.5, 0.5, 0);
 *     uint64_t ids[2];
 *     if (fp3_bodies_open(&def, &world) || fp3_bodies_add(world, &ground, 1, &ids[0]) ||
 *         fp3_bodies_add(world, &box, 1, &ids[1]) ||
 *         fp3_bodies_attach(world, &ids[0], 1, &floor, NULL) ||
 *         fp3_bodies_attach(world, &ids[1], 1, &cube, NULL) || fp3_bodies_step(world, 60))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_bodies_close(&world);
 *
 * The laws of contacts are models (programs/bodies/), and the bits of a step depend on the numbers
 * of bodies and shapes alone: not on the engine, the processor or the number of threads.
 * docs/bodies.md is an introduction. Lengths are in m, masses in kg, times in s; any other units
 * fit, if `size` says how large a typical body is.
 *
 * Threads: only one thread at a time may use an fp3_bodies; different threads may use different
 * ones.
 */
#ifndef FP3_BODIES_H
#define FP3_BODIES_H

#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

typedef struct fp3_bodies fp3_bodies;

#define FP3_SUBSTEPS 64 /* of a step, at most */

/* What to open. Always start from fp3_bodies_default(). */
typedef struct {
    uint32_t cookie;  /* set by fp3_bodies_default(): headers and library belong together */
    fp3_error *error; /* receives the message when a call fails; or NULL. Must outlive the bodies */
    uint32_t dimensions; /* 2 (default): a plane, x and y; 3: space */
    double gravity[3];
    double h;          /* of a step: 2^-20 to 1; default 1/60 */
    uint32_t substeps; /* of a step: 1 to FP3_SUBSTEPS; default 4 */
    /* That take part in a step, the caller's among them, at most 1024. 0: one for each processor.
     * Default 1: a game has its own work for the others. What is too small for several is done by
     * one. The number changes no bit. With an engine 1 only. */
    uint32_t threads;
    double size; /* of a typical body, 2^-20 to 2^20; default 1. Gaps and speeds that count as
                  * small are shares of it */
    /* NULL (default): laws are built in. "isa", "fast" or "rtl": that engine executes their
     * programs, contact by contact, with the same bits; for checks. */
    const char *engine;
    const char *config; /* with an engine: of docs/configurations.md; NULL (default): "world" */
    int may_compile;    /* with "fast": native code; the first world starts a C compiler for it */
    /* With an engine: a folder whose texts replace those of programs/bodies/ of the same name; NULL
     * (default): none. */
    const char *laws;
    /* Speeds, in sizes per time: the fastest at which overlaps are pushed apart, default 3;
     * contacts slower than this do not bounce, default 1. */
    double push, bounce;
    /* A body that is slower than this (in sizes per time, default 0.05) for `rest_time` (default
     * 0.5) falls asleep with all that it touches, until something touches or changes one of them.
     * rest_speed 0: nobody sleeps. */
    double rest_speed, rest_time;
} fp3_bodies_def;

/* For fp3_bodies_default() only. size is that of fp3_bodies_def in the calling program. */
void fp3_bodies_set_default(fp3_bodies_def *def, size_t size);
static inline fp3_bodies_def fp3_bodies_default(void) {
    fp3_bodies_def def;
    fp3_bodies_set_default(&def, sizeof def);
    return def;
}

/* Opens a world without bodies. FP3_E_ARGUMENT: a value is out of its range; the message names it.
 * The caller closes *bodies, which is NULL on failure. */
fp3_status fp3_bodies_open(const fp3_bodies_def *def, fp3_bodies **bodies);
/* Closes *bodies and sets it to NULL. *bodies may be NULL already. */
void fp3_bodies_close(fp3_bodies **bodies);

/* ---- bodies ----
 *
 * A body has a handle, which no other body ever has; no handle is 0. FP3_E_ARGUMENT, of all calls
 * below: a handle whose body was removed, or a number that is not finite; nothing is changed.
 */

typedef enum {
    FP3_DYNAMIC,   /* moved by forces and contacts */
    FP3_KINEMATIC, /* moves with the velocity that the caller gives it, and pushes others */
    FP3_STATIC     /* never moves */
} fp3_body_type;

/* Start from fp3_body_default(): a dynamic body at rest at the origin. */
typedef struct {
    fp3_body_type type;
    double x[3];                  /* of the body's origin, to which its shapes are relative */
    double v[3];                  /* of its centre of mass */
    double angle;                 /* in a plane: in radians, anticlockwise */
    double w;                     /* and its spin, in radians per time */
    double q[4];                  /* in space: its turn, a quaternion (w, x, y, z) of any length */
    double spin[3];               /* in the world's axes */
    double damping, spin_damping; /* speed that is lost per speed and time, 1/s; default 0 */
    double gravity;               /* share of gravity; default 1 */
    int may_not_turn;
    int may_not_sleep;
    int is_fast; /* it must not pass through anything, however fast it is; nobody passes through
                  * what is not dynamic */
} fp3_body_def;

void fp3_body_set_default(fp3_body_def *def, size_t size);
static inline fp3_body_def fp3_body_default(void) {
    fp3_body_def def;
    fp3_body_set_default(&def, sizeof def);
    return def;
}

/* Adds `count` bodies; handles[i] receives the handle of each. They get the lowest numbers that are
 * free, in ascending order. After an error none was added. */
fp3_status fp3_bodies_add(fp3_bodies *bodies, const fp3_body_def *defs, size_t count,
                          uint64_t *handles);
/* Removes bodies with their shapes. What they touched wakes. A handle that occurs twice is
 * FP3_E_ARGUMENT. */
fp3_status fp3_bodies_remove(fp3_bodies *bodies, const uint64_t *handles, size_t count);
size_t fp3_bodies_count(const fp3_bodies *bodies);
/* 2: a plane; 3: space. */
uint32_t fp3_bodies_dimensions(const fp3_bodies *bodies);
/* The handles of all bodies, in the order of their numbers; room for fp3_bodies_count. */
void fp3_bodies_handles(const fp3_bodies *bodies, uint64_t *handles);

/* ---- shapes ---- */

typedef enum {
    FP3_CIRCLE, /* in a plane alone */
    FP3_CAPSULE,
    FP3_BOX,
    FP3_POLYGON, /* in a plane alone */
    FP3_SPHERE,  /* these are in space alone */
    FP3_HULL,
    FP3_PLANE /* all points below a plane, as ground */
} fp3_shape_type;
#define FP3_CORNERS 8       /* of a polygon, at most */
#define FP3_HULL_CORNERS 32 /* of a hull */

/* Start from one of the functions below. */
typedef struct {
    fp3_shape_type type;
    double centre[3]; /* of a circle, a sphere, a box; a point of a plane */
    double angle;     /* of a box in a plane */
    double q[4];      /* of a box in space: its turn, as of a body */
    double half[3];   /* of a box */
    double normal[3]; /* of a plane: upwards; default (0, 1, 0) */
    /* Of a capsule 2; of a polygon or a hull, in any order: what is inside does not count. */
    double corner[FP3_HULL_CORNERS][3];
    uint32_t corners;
    double radius;           /* of a circle, a sphere, a capsule; others are rounded by it */
    double density;          /* kg/m^2 or kg/m^3, 0 or 1e-12 to 1e12; default 1 */
    double friction;         /* default 0.6; of two shapes the root of the product counts */
    double restitution;      /* 0 to 1, default 0; of two the larger */
    double rolling;          /* torque over normal force, in m; default 0; of two the larger */
    double belt;             /* in a plane: speed of the surface, anticlockwise around the shape */
    double surface[3];       /* in space: velocity of the surface, in the body's axes */
    uint32_t category, mask; /* shapes collide if each one's mask has a bit of the other's category;
                              * default 1 and all */
    int is_sensor;           /* tells contacts and has no forces */
} fp3_shape_def;

/* Whatever is not said: a circle of radius 0.5 at the body's origin. */
void fp3_shape_set_default(fp3_shape_def *def, size_t size);
static inline fp3_shape_def fp3_shape_circle(double radius) {
    fp3_shape_def def;
    fp3_shape_set_default(&def, sizeof def);
    def.radius = radius;
    return def;
}
/* A box by half its sides, its corners rounded by a radius that comes on top. */
static inline fp3_shape_def fp3_shape_box(double half_x, double half_y, double radius) {
    fp3_shape_def def = fp3_shape_circle(radius);
    def.type = FP3_BOX;
    def.half[0] = half_x;
    def.half[1] = half_y;
    return def;
}
static inline fp3_shape_def fp3_shape_sphere(double radius) {
    fp3_shape_def def = fp3_shape_circle(radius);
    def.type = FP3_SPHERE;
    return def;
}
/* A box in space, likewise. */
static inline fp3_shape_def fp3_shape_box3(double half_x, double half_y, double half_z,
                                           double radius) {
    fp3_shape_def def = fp3_shape_box(half_x, half_y, radius);
    def.half[2] = half_z;
    return def;
}
/* From one end to the other; a segment if the radius is 0. */
static inline fp3_shape_def fp3_shape_capsule(double ax, double ay, double bx, double by,
                                              double radius) {
    fp3_shape_def def = fp3_shape_circle(radius);
    def.type = FP3_CAPSULE;
    def.corners = 2;
    def.corner[0][0] = ax;
    def.corner[0][1] = ay;
    def.corner[1][0] = bx;
    def.corner[1][1] = by;
    return def;
}

/* Gives each of these bodies this shape; shapes (may be NULL) receives the handle of each. The
 * body's mass, centre and inertia are those of all its shapes. FP3_E_ARGUMENT: also what is no
 * shape, such as corners on a line; the message says why. */
fp3_status fp3_bodies_attach(fp3_bodies *bodies, const uint64_t *handles, size_t count,
                             const fp3_shape_def *shape, uint64_t *shapes);

/* Gives a body that is not dynamic a chain of edges as ground, to the left of the way along its
 * corners (x and y of each): a floor runs from right to left. What slides over its inner corners
 * does not catch there. is_loop: from the last corner back to the first. surface: friction and
 * whatever else is not the shape; its radius rounds the edges, and its density does not count, as
 * the body is not dynamic. */
fp3_status fp3_bodies_attach_chain(fp3_bodies *bodies, uint64_t handle, const double *corners,
                                   size_t count, int is_loop, const fp3_shape_def *surface);
/* Gives a body in space that is not dynamic a mesh of triangles as ground: points (x, y and z of
 * each), and three of their numbers for each triangle, anticlockwise as seen from outside. What
 * slides over an edge between two triangles does not catch there. surface: as of a chain, without a
 * radius. FP3_E_ARGUMENT: also numbers beyond 1e6, or corners of a triangle on a line. */
fp3_status fp3_bodies_attach_mesh(fp3_bodies *bodies, uint64_t handle, const double *points,
                                  size_t count, const uint32_t *triangles, size_t triangle_count,
                                  const fp3_shape_def *surface);
/* The same of heights on a grid: the point of column i and row j is at (i dx, j dy, heights[j
 * columns + i]) in the body's axes. From 2 to 10,000 columns and rows. */
fp3_status fp3_bodies_attach_heights(fp3_bodies *bodies, uint64_t handle, size_t columns,
                                     size_t rows, double dx, double dy, const double *heights,
                                     const fp3_shape_def *surface);

/* ---- joints ----
 *
 * A joint has a handle, as a body has. It goes when one of its bodies is removed, or when it
 * breaks.
 */

typedef enum {
    FP3_ROD,    /* two points at a distance: rigid; with `hertz` a spring; with limits a rope */
    FP3_HINGE,  /* a point of b stays at a point of a; in space b turns about the axis */
    FP3_SLIDER, /* a point of b stays on a line of a, and b does not turn against a */
    FP3_WHEEL,  /* a point of b stays on a line of a, with a spring; b turns, with a motor */
    FP3_WELD,   /* b stays where it is, as seen from a; with `hertz` it may turn, with a spring */
    FP3_GEAR,   /* in a plane: the angle of b and `ratio` times that of a keep their sum */
    FP3_BALL /* in space: a point of b stays at a point of a, and b turns in any way; with `hertz` a
              * spring turns it back, with limits its axis leaves that of a by at most `high` */
} fp3_joint_type;

/* Start from fp3_joint_default(). */
typedef struct {
    fp3_joint_type type;
    uint64_t a; /* both handles; one of the bodies must be dynamic */
    uint64_t b;
    double anchor_a[3]; /* where the joint is, in the axes of each body, from its origin */
    double anchor_b[3];
    double axis[3]; /* of a slider or a wheel: the line, in a's axes; default (1, 0, 0). In space of
                     * a hinge, too: it turns about this axis; and of a ball with limits */
    double axle[3]; /* in space, of a wheel: b turns about it, in a's axes; default (0, 0, 1) */
    double ratio;   /* of a gear; default 1 */
    int has_limits; /* of the distance, the way along the axis, or the angle from the start */
    double low;     /* of a ball 0 */
    double high;
    double speed;   /* of a motor, 1/s or m/s; it has none (default) if `most` is 0 */
    double most;    /* its largest torque or force */
    double hertz;   /* of a spring; default 0: there is none */
    double damping; /* of the spring, as a share of critical damping; default 0.7 */
    double rest;    /* where the spring or rod rests; NaN (default): where it is when it is made. In
                     * space a weld and a ball have NaN alone */
    double force;   /* at which the joint breaks; default 0: never */
    double torque;
    int may_collide; /* whether the two bodies collide; default 0 */
} fp3_joint_def;

void fp3_joint_set_default(fp3_joint_def *def, size_t size);
static inline fp3_joint_def fp3_joint_default(fp3_joint_type type, uint64_t a, uint64_t b) {
    fp3_joint_def def;
    fp3_joint_set_default(&def, sizeof def);
    def.type = type;
    def.a = a;
    def.b = b;
    return def;
}

/* Joins bodies; joints[i] receives the handle of each joint. FP3_E_ARGUMENT: no such type, a body
 * twice, none that is dynamic, an axis of length 0, low above high; limits, a motor, a spring or a
 * ratio of a type that has none (a weld has a spring alone, a ball no motor, a gear a ratio alone,
 * and nobody else a ratio); nothing is joined. */
fp3_status fp3_bodies_join(fp3_bodies *bodies, const fp3_joint_def *defs, size_t count,
                           uint64_t *joints);
fp3_status fp3_bodies_unjoin(fp3_bodies *bodies, const uint64_t *joints, size_t count);
size_t fp3_bodies_joints(const fp3_bodies *bodies);
/* Whether there is such a joint: it may have broken. */
int fp3_bodies_is_joined(const fp3_bodies *bodies, uint64_t joint);
/* at: the distance, way or angle from the start, which in space is from -pi to pi; force_x,
 * force_y, torque (in space force_z, torque_x, torque_y, torque_z): what the joint did to b in the
 * last substep; speed, most, low, high, rest as in fp3_joint_def. */
fp3_status fp3_bodies_joint_read(fp3_bodies *bodies, const char *name, const uint64_t *joints,
                                 size_t count, double *values);
/* speed, most, low, high, rest. Wakes the joint's bodies. */
fp3_status fp3_bodies_joint_write(fp3_bodies *bodies, const char *name, const uint64_t *joints,
                                  size_t count, const double *values);

/* ---- steps ---- */

/* Each step lasts h. FP3_E_FAILED: the position or speed of a body, or of several that touch, would
 * not be finite, and the message names the first; they stay where they are, and all others have
 * made their steps. */
fp3_status fp3_bodies_step(fp3_bodies *bodies, uint64_t steps);
double fp3_bodies_time(const fp3_bodies *bodies);
/* Bodies that do not sleep, and contacts that touch, after the last step. */
size_t fp3_bodies_awake(const fp3_bodies *bodies);
size_t fp3_bodies_touching(const fp3_bodies *bodies);

/* ---- contacts ----
 *
 * Shapes touch while a gap between them is below 0.005 size, or something pushes.
 */

typedef enum {
    FP3_CONTACT_BEGAN,
    FP3_CONTACT_ENDED, /* also where a body was removed, or moved away by the caller */
    FP3_CONTACT_HIT    /* began, and faster than `bounce` */
} fp3_contact_change;

typedef struct {
    uint64_t body_a, body_b; /* a's shape has the lower number */
    uint64_t shape_a, shape_b;
    double point[3];  /* where they touch, in the world: the deepest point */
    double normal[3]; /* from a to b */
    double speed;     /* with which they came together; of a contact that ended 0 */
    double impulse; /* the largest along the normal that a substep gave, summed over its points, and
                     * those of its impacts; of sensors 0 */
} fp3_contact;

/* What changed in the last call of fp3_bodies_step, step by step, in each by the numbers of shapes;
 * and what the caller's changes since the call before ended. *list belongs to the bodies until the
 * next call that changes them. */
fp3_status fp3_bodies_changes(fp3_bodies *bodies, fp3_contact_change change,
                              const fp3_contact **list, size_t *count);
/* All that touches now, by the numbers of shapes; likewise. */
fp3_status fp3_bodies_contacts(fp3_bodies *bodies, const fp3_contact **list, size_t *count);

/* ---- questions ----
 *
 * About all shapes as they are now, sensors and sleepers too, whose category has a bit of `mask`.
 * Of several that are as near the one with the lowest number is found. FP3_E_ARGUMENT: also a
 * number beyond 1e9, or what is no shape. A question looks at each shape.
 */

typedef struct {
    uint64_t body, shape; /* 0: nothing was found; then distance and fraction are infinite */
    double point[3];      /* on the surface of what was found, in the world */
    double normal[3];     /* there, outwards */
    double distance;      /* negative: by how much they overlap */
    double fraction;      /* of the way */
} fp3_hit;

/* What rays meet first: ray i goes from a point along its whole way (x and y of each, in space z,
 * too). From within a shape: fraction 0. */
fp3_status fp3_bodies_ray(fp3_bodies *bodies, const double *from, const double *way, size_t count,
                          uint32_t mask, fp3_hit *hits);
/* What a shape meets first that stands at x, and goes along a way without turning. turn: its angle
 * in a plane, its quaternion in space; NULL: not turned. At the fraction found it is at most 0.001
 * size away. */
fp3_status fp3_bodies_cast(fp3_bodies *bodies, const fp3_shape_def *shape, const double *x,
                           const double *turn, const double *way, uint32_t mask, fp3_hit *hit);
/* All shapes that overlap this one, by their numbers; *count: how many, of which the first `room`
 * are in hits. */
fp3_status fp3_bodies_overlap(fp3_bodies *bodies, const fp3_shape_def *shape, const double *x,
                              const double *turn, uint32_t mask, size_t room, fp3_hit *hits,
                              size_t *count);
/* The shape that is nearest to each point (x and y of each, in space z, too). */
fp3_status fp3_bodies_nearest(fp3_bodies *bodies, const double *points, size_t count, uint32_t mask,
                              fp3_hit *hits);

/* ---- back in time ---- */

/* A copy of all that a world is; a step after fp3_bodies_restore has the bits of one after
 * fp3_bodies_save, and fp3_bodies_changes tells what it told then. */
typedef struct fp3_bodies_state fp3_bodies_state;
/* Copies into *state, which is made if it is NULL, and is used again otherwise; the caller frees
 * it. FP3_E_SYSTEM: out of memory; *state is NULL or as it was. */
fp3_status fp3_bodies_save(const fp3_bodies *bodies, fp3_bodies_state **state);
/* Handles of bodies, shapes and joints that were there then are good again. Those that were given
 * since are not, and may be given again. FP3_E_ARGUMENT: the state was saved of other bodies.
 * FP3_E_SYSTEM: out of memory. Nothing is changed then. */
fp3_status fp3_bodies_restore(fp3_bodies *bodies, const fp3_bodies_state *state);
void fp3_bodies_state_free(fp3_bodies_state **state);

/* Writes all that a world is to a file (docs/checkpoints.md#rigid-bodies), whole or not at all;
 * what the file held before stays as path.1. FP3_E_ARGUMENT: it is no regular file, or another
 * process is writing it. FP3_E_SYSTEM: it cannot be written. */
fp3_status fp3_bodies_checkpoint(fp3_bodies *bodies, const char *path);
/* Opens the world of a checkpoint: it goes on with the same bits, and handles are those of the
 * world that was written; fp3_bodies_changes tells what it told there. Of def it takes error,
 * engine, config, may_compile and laws alone. FP3_E_ARGUMENT: as of fp3_bodies_open; the file is
 * cut off, damaged, of another version or something else; laws are others. The caller closes
 * *bodies, which is NULL on failure. */
fp3_status fp3_bodies_restart(const fp3_bodies_def *def, const char *path, fp3_bodies **bodies);

/* ---- values ----
 *
 * Names: x, angle, v, w as in fp3_body_def; force and torque, which act in the next step alone;
 * mass, inertia (about the centre of mass) and at_rest, the time for which a body has been slow, -1
 * while it sleeps. Of x, v and force each body has two values side by side; x_x, x_y and so on are
 * one of them. In space there are q (four values) and spin instead of angle and w, and of x, v,
 * spin, force, torque and inertia (about the axes of inertia) each body has three. What is written
 * wakes a body. FP3_E_ARGUMENT: no such name (the message suggests the nearest); speeds and forces
 * of static bodies; mass and inertia of bodies that are not dynamic.
 */
fp3_status fp3_bodies_read(fp3_bodies *bodies, const char *name, const uint64_t *handles,
                           size_t count, double *values);
fp3_status fp3_bodies_write(fp3_bodies *bodies, const char *name, const uint64_t *handles,
                            size_t count, const double *values);
/* A hash of where bodies are, how they move, who sleeps, and of the impulses of contacts: FNV-1a
 * over the words, in the order of numbers. */
uint64_t fp3_bodies_hash(const fp3_bodies *bodies);

FP3_API_END

#endif
