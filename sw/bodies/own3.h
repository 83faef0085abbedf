/* SPDX-License-Identifier: Apache-2.0 */
/* own3.h - what bodies in space have besides (own.h). */
#ifndef FP3_BODIES_OWN3_H
#define FP3_BODIES_OWN3_H

#include "form3.h"
#include "own.h"
#include "solve3.h"

typedef struct {
    double q[4];               /* of the body's axes, of length 1 */
    double boxed_turn[4];      /* as it was when its shapes' boxes were made */
    float spin[3], torque[3];  /* in the world's axes */
    float moment[3];           /* about its axes of inertia; 0: it does not turn */
    double axes[4];            /* the turn from those axes to the body's */
    float inertia[6], back[6]; /* of this step, in the world's axes: xx, yy, zz, xy, xz, yz; and
                                * its inverse. Unit if it does not turn: then `back` counts as 0 */
} fp3_body3;

typedef struct {
    double q[4];                     /* b's turn as a had it when it was made */
    double anchor_a[3], anchor_b[3]; /* which its rows hold */
    double axis_b[3], axle_b[3];     /* a's axis and axle as b had them then, of length 1 */
    float pin[3], spin[3], line[4], twist[4]; /* impulses, as their rows have them */
    float force[3], torque[3];                /* on b, in the last substep */
} fp3_joint3;

/* Where a joint is in a step, in the world's axes. */
typedef struct {
    fp3_point3 arm_a, arm_b; /* of its points, from the centres of mass */
    fp3_point3 gap;          /* from a's point to b's */
    fp3_point3 axis, axle;   /* of a, of length 1 */
    fp3_point3 error;    /* about this, of length its angle, b has turned from where it was made */
    fp3_point3 lean;     /* likewise, b's axis (of a wheel: axle) from a's */
    double about, swing; /* the angle about the axis (axle), and that between both axes */
    float back_a[6], back_b[6]; /* inverse inertias now */
} fp3_stance3;

#define FP3_JOINT_LAWS3 (FP3_LAWS_IN_SPACE - FP3_LAW_pin3)
_Static_assert(FP3_JOINT_LAWS == FP3_JOINT_LAWS3, "a plane and space have as many laws of joints");

/* The arms of both surfaces at a point midway between them: with that of the point itself a ball
 * that is still far away would be rubbed at the end of a lever. */
static inline fp3_point3 fp3_arm_a3(const fp3_patch3 *p, fp3_point3 arm, float gap) {
    return fp3_along3(arm, -0.5f * gap, p->m.normal);
}
static inline fp3_point3 fp3_arm_b3(const fp3_patch3 *p, fp3_point3 arm, float gap) {
    return fp3_subtract3(fp3_along3(arm, 0.5f * gap, p->m.normal), p->from);
}

/* A form in a file: what it was made of. */
typedef struct {
    uint32_t type;               /* of its definition; FP3_KEPT_MESH: points and triangles */
    uint32_t corners, triangles; /* how many of those that follow are its own */
    double radius, centre[3], half[3], q[4], normal[3];
} fp3_kept_form;
#define FP3_KEPT_MESH 100u

typedef struct {
    fp3_kept_form *form;
    double (*corner)[3];
    uint32_t (*triangle)[3];
    uint32_t *of; /* the form of each shape; FP3_NOBODY: it is not there */
    uint32_t forms, corners, triangles;
    uint32_t form_room, corner_room, triangle_room, of_room;
} fp3_kept_forms;

struct fp3_space {
    const fp3_solver3 *solver;
    fp3_body3 *body; /* of each body */
    uint32_t body_room;
    fp3_patch3 *patch, *old; /* of all pairs: fp3_touch2.first_patch; room for the next ones */
    uint32_t patch_count, patch_room, old_room;
    fp3_pose3 *pose; /* of each body's shapes, from its centre of mass, when a step begins */
    uint32_t pose_room;
    uint8_t *points; /* of each block of contacts */
    uint32_t points_room;
    fp3_making3 making;        /* of the rows of this step */
    fp3_law_rows contacts;     /* of: patches */
    fp3_turning3_row *turning; /* of slots, eight by eight */
    fp3_ends2 *turning_ends;
    uint32_t turning_room, turning_end_room;
    fp3_joint3 *joint; /* of each joint */
    uint32_t joint_room;
    fp3_stance3 *stance;                  /* of each joint, in a substep */
    fp3_law_rows joined[FP3_JOINT_LAWS3]; /* by law - FP3_LAW_pin3 */
    uint32_t stance_room;
    fp3_mesh_touch3 *meeting;
    uint32_t meeting_room;
    int is_rolling,
        has_belts;       /* a contact of this step has rolling resistance, a surface that moves */
    fp3_kept_forms kept; /* while a checkpoint is written or read (fields.h) */
};

static inline fp3_point3 fp3_point3_of(const float x[3]) { return (fp3_point3){x[0], x[1], x[2]}; }

/* space.c */
fp3_status fp3_space_open(const fp3_solver3 *solver, fp3_space **space, fp3_error *error);
void fp3_space_close(fp3_space **space);
/* A point of the body's axes, from its origin, as seen from its centre of mass in the world. */
void fp3_space_arm(const fp3_bodies *bodies, uint32_t body, const float at[3], double arm[3]);
/* The pose of a body's shapes, its centre of mass at `at`. */
fp3_pose3 fp3_space_pose(const fp3_bodies *bodies, uint32_t body, fp3_point3 at);
/* Mass, centre and inertia of a body, from its shapes. */
void fp3_space_weigh(fp3_bodies *bodies, uint32_t number);
/* Whether it may have this shape, too: FP3_E_ARGUMENT, a mass or an inertia would be no float, or
 * its inverse none. */
fp3_status fp3_space_may_weigh(const fp3_bodies *bodies, uint32_t number, const fp3_attached *more);

/* touch3.c: of touch.c's work, what is different in space. */
fp3_box fp3_space_box(const fp3_bodies *bodies, uint32_t shape, double margin);
/* Its turn is that of its boxes now; how far it has turned since, at most. */
void fp3_space_boxed(fp3_bodies *bodies, uint32_t body);
double fp3_space_turned(const fp3_bodies *bodies, uint32_t body);
double fp3_space_speed(const fp3_bodies *bodies, uint32_t body, float extent);
fp3_status fp3_space_touch_begin(fp3_bodies *bodies);
/* After a failure: what was found of all pairs counts no more. */
void fp3_space_forget(fp3_bodies *bodies);
/* Behind a new list of pairs: where their patches are. */
fp3_status fp3_space_lay_patches(fp3_bodies *bodies);
/* Whether both have hardly moved since they were looked at: gaps follow. */
int fp3_space_follow(fp3_bodies *bodies, fp3_touch2 *touch);
/* Looks at them: points of contact within `reach`. In place: several threads may do it; 0: there
 * are more than they have had room for, and nothing is done. */
int fp3_space_collide_in_place(fp3_bodies *bodies, fp3_touch2 *touch, float reach);
fp3_status fp3_space_collide(fp3_bodies *bodies, fp3_touch2 *touch, float reach);

/* The touch of a row of contacts; how many there are. */
static inline fp3_touch2 *fp3_row_touch(const fp3_bodies *bodies, uint32_t row) {
    const fp3_space *s = bodies->space;
    return &bodies->touch[s ? s->patch[s->contacts.of[row]].touch : bodies->contacts.of[row]];
}
/* The rows of a law of joints. */
static inline const fp3_law_rows *fp3_joint_rows(const fp3_bodies *bodies, uint32_t law) {
    return bodies->space ? &bodies->space->joined[law] : &bodies->joined[law];
}
static inline uint32_t fp3_rows_count(const fp3_bodies *bodies) {
    return bodies->space ? bodies->space->contacts.count : bodies->contacts.count;
}

/* A symmetric tensor (xx, yy, zz, xy, xz, yz) times a vector. */
static inline fp3_point3 fp3_tensor3(const float t[6], fp3_point3 v) {
    return (fp3_point3){t[0] * v.x + t[3] * v.y + t[4] * v.z, t[3] * v.x + t[1] * v.y + t[5] * v.z,
                        t[4] * v.x + t[5] * v.y + t[2] * v.z};
}

/* The vector about which a body has turned in a step, of length its angle: to the first order,
 * which gaps follow. */
static inline fp3_point3 fp3_turn_of_way(const fp3_four way[2]) {
    const float sign = way[0][3] < 0 ? -2 : 2;
    return (fp3_point3){sign * way[1][0], sign * way[1][1], sign * way[1][2]};
}

/* contacts3.c, as contacts.c */
void fp3_space_contact_leave(fp3_bodies *bodies, uint32_t i, uint32_t point);
void fp3_space_contacts_follow(fp3_bodies *bodies);
/* The speed of b against a at which their surfaces do not slide. */
fp3_point3 fp3_space_belt(const fp3_bodies *bodies, const fp3_attached *a, const fp3_attached *b);
fp3_status fp3_space_contacts_begin(fp3_bodies *bodies, double h);
/* Slots first .. end - 1 of bodies that have turned so far in this step that they would answer
 * otherwise: their heft is as they are turned, and fp3_bodies.has_turned is set. */
void fp3_space_find_turned(fp3_bodies *bodies, uint32_t first, uint32_t end);
void fp3_space_contacts_end(fp3_bodies *bodies);

/* stance3.c: after the way that both bodies have come in the step, if `has_way`. */
fp3_stance3 fp3_space_stance(const fp3_bodies *bodies, uint32_t joint, int has_way);
/* A body's inverse inertia, as its words in fp3_body3 are. */
void fp3_space_back(const fp3_bodies *bodies, uint32_t body, int has_way, float back[6]);
/* Its inertia after its way, as exactly as double has it: of a rod a float loses what is about its
 * axis. */
void fp3_space_inertia(const fp3_bodies *bodies, uint32_t body, double inertia[6]);
/* The distance, way or angle that its limits are of. */
double fp3_space_joint_at(const fp3_bodies *bodies, uint32_t joint);
double fp3_stance_at(const fp3_stance3 *stance, fp3_joint_type type);

/* What drives or holds a joint along n or about it, as line3.ode and twist3.ode have it. */
typedef struct {
    fp3_point3 n, arm_a; /* along it: the arm at a */
    float mass;          /* that it feels */
    int is_firm;
    fp3_softness soft;                   /* of the lock or spring; 0: there is none */
    float off, speed, most, over, under; /* over, under: FP3_NO_LIMIT3 where there is none */
} fp3_drive3;
#define FP3_NO_LIMIT3 1e12f
/* All but n, arm_a, mass and is_firm, of a joint that is at `where`. What is beyond a lock or a
 * limit by more than `far` is pulled back no faster. */
void fp3_drive_use(fp3_drive3 *drive, const fp3_joint_def *def, int uses, double where, double far,
                   double h);
fp3_drive3 fp3_space_drive_along(const fp3_bodies *bodies, uint32_t joint, double h);
fp3_drive3 fp3_space_drive_about(const fp3_bodies *bodies, uint32_t joint, double h);
/* Of its point, the line along its axis is free. */
static inline int fp3_is_on_line3(fp3_joint_type type) {
    return type == FP3_SLIDER || type == FP3_WHEEL;
}
/* Whether it holds angles that are not about its axis, and no spring does it. */
static inline int fp3_space_holds_turn(const fp3_joint_def *def) {
    return def->type == FP3_HINGE || def->type == FP3_SLIDER || def->type == FP3_WHEEL ||
           (def->type == FP3_WELD && !(def->hertz > 0));
}

/* Which laws a joint is made of: bits by law - FP3_LAW_pin3. */
int fp3_space_laws_of(const fp3_joint_def *def);
/* All that is of a new joint, from its definition. */
void fp3_space_joint_place(fp3_bodies *bodies, uint32_t number);

/* What is farther apart is pulled no faster: a joint that was made far from where it holds, or was
 * torn, comes together as if this were all. */
#define FP3_FARTHEST3 0.2f      /* share of `size` */
#define FP3_FARTHEST_TURN3 0.2f /* rad */
static inline fp3_point3 fp3_at_most3(fp3_point3 v, float most) {
    const float size = fp3_size3(v);
    return size > most ? fp3_times3(most / size, v) : v;
}

/* joints3.c */
/* The spring of what they hold. */
fp3_softness fp3_space_firm(double h);
/* Behind fp3_heavy_find. */
fp3_status fp3_space_joints_begin(fp3_bodies *bodies);
/* Rows for where bodies are now, with the impulses of the step before. */
void fp3_space_joints_first(fp3_bodies *bodies);
/* Behind the passes, those that other ranks have passed over. */
void fp3_space_joints_stand(fp3_bodies *bodies);
void fp3_space_joints_end(fp3_bodies *bodies, double h);
/* Impulses of a row of a law (- FP3_LAW_pin3), and how many; bits: those of springs and motors. */
typedef struct {
    float *word[4];
    uint32_t count, gives;
} fp3_impulses3;
fp3_impulses3 fp3_space_impulses(const fp3_law_rows *rows, int law, uint32_t row);

/* space.c, in double: a product of quaternions; a vector turned by one of length 1. */
void fp3_multiply3(const double p[4], const double q[4], double to[4]);
void fp3_turned3_by(const double q[4], const double p[3], double to[3]);

/* step3.c: a step, behind fp3_bodies_touch: before its substeps, and behind them. */
fp3_status fp3_space_begin(fp3_bodies *bodies, double h);
fp3_status fp3_space_end(fp3_bodies *bodies, double h);

#endif
