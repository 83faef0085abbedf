/* SPDX-License-Identifier: Apache-2.0 */
/* heavy.h - what heavy bodies do to light ones by joints and contacts, all at once.
 *
 * Passes go from one contact or joint to the next, so what a heavy body does comes only slowly
 * through light ones. Bodies that touch or are joined, and of which one weighs more than 50 times
 * as much as another, are a heavy set, as are the bodies of a tree of joints that together weigh
 * more than 250 times the lightest. Of such sets the impulses of joints, of contacts and of their
 * friction are found at once, in double: each body has its equation, each row pulls at two of them
 * as a stiff spring that may have limits, and Newton's method finds who is at a limit. Rolling
 * stays with the passes; so do, in a plane, rods, sliders and wheels, in space springs of all three
 * angles. So does a set of more than 50 bodies that is no tree. No engine does it, so
 * all engines have the same bits.
 */
#ifndef FP3_BODIES_HEAVY_H
#define FP3_BODIES_HEAVY_H

#include "base/springs.h"
#include "own3.h"

/* A joint or a contact. */
typedef struct {
    uint32_t a, b;    /* numbers of both bodies in the set; FP3_NO_SPRING: it does not move */
    uint32_t next;    /* of the set; FP3_NOBODY: none */
    double ratio;     /* of the set */
    uint32_t slot[2]; /* of both bodies */
    uint32_t of;      /* which joint or row */
    int is_contact;
    double arm_a[2], arm_b[2], gap[3]; /* of a joint in a plane, as the step begins */
    double arm[2][4];            /* of a contact when the substep began: of both points; in space
                                  * of its middle, at a and at b */
    double stiff, rate, mass[4]; /* of a contact: its spring; what its points feel */
    double mu;                   /* in space: its friction */
    double held[4];              /* in the substep before, by the point or points; in space [3]:
                                  * along the line */
    float rub[3];                /* friction */
    int8_t was[14];              /* of its rows, of which there are no more: at which limit */
} fp3_heavy_link;

typedef struct {
    uint32_t bodies, first_body, last_body; /* slots */
    uint32_t links, first_link, last_link;
    double ratio;   /* the heaviest over the lightest */
    double hardest; /* the spring of what does not yield */
} fp3_heavy_set;

/* heavy2.c, heavy3.c: of a link its rows; of a body its mass, its speed and how that changes. */
typedef struct {
    int (*holds)(const fp3_joint *);
    int (*is_moving)(const fp3_bodies *, uint32_t slot);
    int (*has_pushed)(const fp3_bodies *, uint32_t contact); /* in the step before */
    void (*begin)(fp3_bodies *, fp3_heavy_link *);           /* of a step */
    void (*forget)(fp3_bodies *, fp3_heavy_link *);
    void (*weigh)(const fp3_bodies *, uint32_t slot, double *mass);
    void (*speed)(const fp3_bodies *, uint32_t slot, double *speed);
    void (*fill)(fp3_bodies *, fp3_heavy_link *, int push);
    void (*move)(fp3_bodies *, uint32_t slot, const double *change);
    void (*end)(fp3_bodies *, const fp3_heavy_link *);
} fp3_heavy_laws;
extern const fp3_heavy_laws fp3_heavy_laws2, fp3_heavy_laws3;

struct fp3_heavy {
    const fp3_heavy_laws *laws;
    uint32_t sets, links;
    fp3_heavy_set *set;
    fp3_heavy_link *link;
    struct fp3_heavy_place *place; /* of each body that moves */
    double rate;                   /* how fast what is apart comes together */
    fp3_springs springs;           /* of one set after another */
    int is_calm;                   /* joints do nothing by which they could make energy */
    double *other;                 /* speeds and impulses when they did */
    uint32_t set_room, link_room, place_room, other_room;
};

/* Behind the rows of contacts, before those of joints: finds sets, marks their joints (is_heavy),
 * which have no rows for what is found here, and makes contacts as firm as the heaviest body needs
 * it. rate: how fast joints pull what is apart together. */
fp3_status fp3_heavy_find(fp3_bodies *bodies, const fp3_heavy_laws *laws, float rate);
/* Bodies of their joints fall along no parabola. */
void fp3_heavy_hold(fp3_bodies *bodies);
/* A substep begins: what points did in the one before is no guess of what they do. */
void fp3_heavy_forget(fp3_bodies *bodies);
/* In a substep, where bodies are now. push: what is apart comes together; else speeds alone. */
fp3_status fp3_heavy_solve(fp3_bodies *bodies, int push);
/* Behind the last substep: rows of contacts have their friction again. */
void fp3_heavy_end(fp3_bodies *bodies);
void fp3_heavy_free(fp3_bodies *bodies);

/* What a body that may not turn resists, of its mass. */
#define FP3_HEAVY_STANDS 1e12

/* Of a link, row `which`: a spring k, or the hardest if that is less, between these speeds; `want`
 * is what they should have. keeps_before: it goes on from the impulse that there is. */
typedef struct {
    int which;
    float *word;
    const double *of_a, *of_b;
    double k, want;
    int keeps_before;
} fp3_heavy_row;
fp3_spring *fp3_heavy_put(fp3_bodies *bodies, fp3_heavy_link *link, const fp3_heavy_row *row);
/* Of a contact, a point that pushes at this gap: of the row k, want and keeps_before are found. */
fp3_spring *fp3_heavy_push(fp3_bodies *bodies, fp3_heavy_link *link, fp3_heavy_row row, double gap,
                           int push);

/* As twist2.ode, line3.ode and twist3.ode: a lock or a spring, a motor, limits, whose rows are from
 * `which` on and whose impulses stand in `words`. of_a, of_b: the speed that they are of. */
void fp3_heavy_drive(fp3_bodies *bodies, fp3_heavy_link *link, const fp3_drive3 *drive, int which,
                     float words[4], const double *of_a, const double *of_b, int push);

#endif
