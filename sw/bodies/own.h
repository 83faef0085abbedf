/* SPDX-License-Identifier: Apache-2.0 */
/* own.h - what an fp3_bodies is made of. */
#ifndef FP3_BODIES_OWN_H
#define FP3_BODIES_OWN_H

#include "pairs.h"
#include "programs.h"
#include "shapes/collide2.h"
#include "shapes/shape2.h"
#include "solve2.h"
#include "touch2.h"

#include "base/colours.h"
#include "base/laps.h"
#include "base/room.h"
#include "base/threads.h"

#include <fp3/bodies.h>
#include <math.h>

#define FP3_NOBODY UINT32_MAX
#define FP3_JOINT_LAWS (FP3_LAWS - FP3_LAW_twist2)

typedef struct fp3_space fp3_space;       /* own3.h */
typedef struct fp3_form3 fp3_form3;       /* form3.h */
typedef struct fp3_heavy fp3_heavy;       /* heavy.h */
typedef struct fp3_guess fp3_guess;       /* guess.h */
typedef struct fp3_substeps fp3_substeps; /* substeps.c */
typedef struct fp3_share fp3_share;       /* share.h */

typedef struct {
    /* What each step goes over. */
    double at[3];  /* of the centre of mass */
    float turn[2]; /* its cosine and sine, of length 1 */
    float v[3], w; /* of the centre of mass */
    float rest;    /* for how long it has been slow; -1: it sleeps */
    uint32_t slot; /* where it stands in a step (step.c) */
    uint8_t type, is_fast, may_not_turn, may_not_sleep, is_marked;
    double boxed[3];     /* where it was when its shapes' boxes were made, */
    float boxed_turn[2]; /* and how it was turned */
    float extent;        /* the largest one of its shapes */
    float inner;         /* the smallest one of theirs */
    float gravity;
    double angle; /* as the caller reads it, in turns too */
    float force[3], torque;
    float mass, inertia; /* 0 unless dynamic */
    float centre[3];     /* of mass, from the origin, in the body's axes */
    float damping, spin_damping;
    uint32_t generation;  /* of its number; odd: a body lives there */
    uint32_t first_shape; /* of its chain; FP3_NOBODY: none */
    uint32_t next_asleep; /* asleep: a ring of all that fell asleep together */
} fp3_body;

typedef struct {
    fp3_shape2 given, shape;    /* in the body's axes, from its origin; from its centre of mass */
    fp3_link2 given_link, link; /* likewise, of an edge of a chain, whose shape is the segment */
    fp3_mass2 mass;             /* of the given shape */
    fp3_form3 *form;            /* in space, instead of all these */
    float extent;               /* from the centre of mass to the farthest point */
    float inner;                /* from the middle of its corners to the nearest side */
    float friction, restitution, rolling, belt;
    float surface[3], density; /* in space */
    uint32_t category, mask;
    uint32_t body, next; /* of the body's chain */
    uint32_t generation;
    uint8_t is_sensor, is_link;
} fp3_attached;

/* What every step looks at first: joints are many. */
typedef struct {
    uint32_t a, b; /* bodies */
    uint32_t generation;
    uint8_t laws;                   /* bit FP3_LAW_.. - FP3_LAW_twist2: which it is made of */
    uint8_t is_heavy;               /* in this step: heavy.h */
    float anchor_a[2], anchor_b[2]; /* in the bodies' axes, from their origins */
    float axis[2];
    float point[2], rod[4], slide[5], twist[4]; /* impulses, as their rows have them */
    float force[2], torque;                     /* on b, in the last substep */
    double from;       /* what the angle of b and `ratio` times that of a had when it was made */
    fp3_joint_def def; /* rest is a number */
} fp3_joint;

/* The rows of a law, colour by colour, and whose they are. */
typedef struct {
    void *row;
    fp3_ends2 *ends;
    uint32_t *lane;   /* of each: block * 8 + lane */
    uint32_t *of;     /* of each: a contact or a joint */
    uint32_t *a, *b;  /* of each: slots of its bodies */
    uint32_t *at;     /* of each lane: which; FP3_NOBODY: none */
    uint32_t *colour; /* of each, while rows are laid */
    uint32_t count;
    uint32_t blocks; /* of all colours, and behind them those of rows that other ranks pass over */
    /* Slots are those of the last time: their colours and lanes stay. Whoever does not ask for it
     * leaves it 0. */
    int is_same;
    uint32_t laid, laid_movable, laid_share;
    uint32_t layings; /* how often they were laid anew */
    /* Blocks that each thread has of a colour: thread t of colour k from cut[k * threads + t] on
     * (cuts.c). */
    uint32_t *cut;
    uint32_t cut_room, cut_version;
    int is_cut;   /* since they were laid */
    int is_whole; /* whoever fills rows writes all words of a block: none is set to 0 before */
    fp3_colours colours;
    uint32_t row_room, end_room, lane_room, of_room, a_room, b_room, at_room, colour_room;
} fp3_law_rows;

struct fp3_bodies {
    fp3_bodies_def def;
    fp3_error *error;
    const fp3_solver2 *solver;
    fp3_laws *laws;       /* NULL: those that are built in */
    fp3_space *space;     /* NULL: a plane */
    fp3_threads *threads; /* NULL: the caller's alone */
    fp3_laps laps;
    uint32_t *cut; /* the first slot of each thread of the crew (cuts.c), and the end */
    uint32_t cut_room, cuts, cut_movable, cut_slots, cut_version;
    fp3_substeps *substeps; /* substeps.c */
    uint32_t alone, pause;  /* steps that the caller will make alone; that he did the last time */
    fp3_threads *crew;      /* those of this step: NULL if there is too little to do */
    uint32_t *identity; /* how many hold it: the world and what was saved of it, so that no other
                         * world gets its place in memory */
    double time;
    uint64_t steps;

    fp3_body *body;
    uint32_t body_count, body_room, living;
    fp3_attached *shape;
    uint32_t shape_count, shape_room;
    uint32_t free_body, free_shape; /* no free number is below */

    fp3_joint *joint;
    uint32_t joint_count, joint_room, joints, free_joint;
    fp3_heavy *heavy; /* NULL: there was no step yet */
    fp3_guess *guess; /* NULL: there was no joint in a plane yet */
    fp3_share *share; /* NULL: one process steps the world */
    int is_apart_stale;
    uint64_t *apart; /* (lower body) << 32 | higher, ascending: joined, and they do not collide */
    uint32_t *apart_first; /* where those of each lower one begin */
    uint32_t apart_count, apart_room, apart_first_room, apart_bodies;

    fp3_boxes boxes;    /* of each shape, as pairs.h has them */
    int is_bouncy;      /* some shape has had a restitution */
    int is_changed;     /* shapes came or went: pairs are looked for again */
    fp3_touch2 *touch;  /* ascending by a, then b */
    fp3_touch2 *merged; /* room for the next ones */
    uint8_t *near;      /* of each, in a step: what it does (touch.c) */
    uint32_t touch_count, touch_room, merged_room, near_room;
    uint64_t *key; /* room for the pairs that are found */
    size_t key_room;

    /* Of a step: bodies in slots. First those that move by forces, ascending; then one that never
     * moves; then those that the caller moves. */
    uint32_t *in_slot, slot_room;
    uint32_t movable, slots;
    /* heft: over mass and over inertia; in a plane then 1 if the body has turned far in this step,
     * and how soon it does (turned.c). */
    fp3_four *speed, *way, *base, *heft;
    fp3_pull2 *pull;
    uint8_t *is_held; /* by a row: it does not follow its parabola */
    int has_turned;   /* a body has turned far in this step (turned.c) */
    fp3_four *before; /* speeds, while some are given again */
    uint32_t before_room;
    fp3_law_rows contacts, joined[FP3_JOINT_LAWS];
    fp3_contact *change[3], *now; /* by fp3_contact_change; room for fp3_bodies_contacts */
    uint32_t change_count[3], change_room[3], now_room, told,
        ended_before; /* told: ended, up to the last step */
    int may_bounce;   /* a contact of this step has a restitution */
    uint32_t awake, touching;
    int is_still; /* all sleep, and nothing is moved by the caller: a step changes nothing */
};

/* Calls part(of, from, to) for ranges of 0 .. count-1, by several threads if these have `least`
 * each; returns when all is done. Parts write what no other part reads or writes. */
static inline void fp3_bodies_share(const fp3_bodies *bodies,
                                    void (*part)(void *of, uint32_t from, uint32_t to), void *of,
                                    uint32_t count, uint32_t least) {
    fp3_threads_share(bodies->crew,
                      (fp3_lap){part, of, 0, count, fp3_threads_parts(bodies->crew, count, least)});
}
/* So many of each are worth a thread: one takes 20 to 100 ns, to have help 200 ns. */
enum { FP3_LEAST_BODIES = 64, FP3_LEAST_PAIRS = 32, FP3_LEAST_BLOCKS = 8 };

/* The last one to hold it frees it; NULL: nobody. */
void fp3_identity_give_back(uint32_t *identity);

/* base/room.h */
static inline fp3_status fp3_bodies_room(void **array, uint32_t *room, size_t size, size_t wanted,
                                         fp3_error *error) {
    return fp3_room(array, room, size, wanted, error);
}

/* A number of the caller's, and between which it must lie; both 0: it does not count in these
 * dimensions, and must be 0. */
typedef struct {
    const char *name;
    double value, least, most;
} fp3_bodies_range;
/* FP3_E_ARGUMENT, with the name of the first that lies outside, behind `of` ("joint 3: "). */
fp3_status fp3_ranges_check(const fp3_bodies_range *ranges, size_t count, const char *of,
                            int is_space, fp3_error *error);

/* The number of a handle's body. FP3_E_ARGUMENT: it was removed, or never there. */
fp3_status fp3_bodies_numbered(const fp3_bodies *bodies, const uint64_t *handles, size_t which,
                               uint32_t *number);
static inline uint64_t fp3_bodies_handle(const fp3_bodies *bodies, uint32_t number) {
    return (uint64_t)bodies->body[number].generation << 32 | number;
}
static inline int fp3_body_lives(const fp3_body *body) { return body->generation & 1; }
static inline int fp3_body_moves(const fp3_body *body) {
    return body->type == FP3_DYNAMIC && body->rest >= 0;
}

/* Where a body stands in a step; `movable`: among those that never move. */
static inline uint32_t fp3_slot_of(const fp3_bodies *bodies, uint32_t body) {
    return bodies->body[body].slot == FP3_NOBODY ? bodies->movable : bodies->body[body].slot;
}

/* Whether it has a speed or a spin. */
int fp3_body_goes(const fp3_bodies *bodies, uint32_t number);

static inline float fp3_inverse_mass(float mass) { return mass > 0 ? 1 / mass : 0; }

fp3_softness fp3_soften(double hertz, double damping, double h);
/* Of contacts: between bodies that move (times 1), against one that does not (times 2). */
fp3_softness fp3_contact_softness(const fp3_bodies *bodies, double h, double times);

/* Room for the slots of `count` contacts or joints in rows->a and rows->b. */
fp3_status fp3_rows_make_room(const fp3_bodies *bodies, fp3_law_rows *rows, size_t count);
/* Whether slots were the same ones. */
__attribute__((warn_unused_result)) static inline int fp3_rows_put(fp3_law_rows *rows, uint32_t i,
                                                                   uint32_t a, uint32_t b) {
    const int is_same = (rows->a[i] == a) & (rows->b[i] == b);
    rows->a[i] = a;
    rows->b[i] = b;
    return is_same;
}
/* Rows of a law for rows->of[0 .. count-1], whose bodies stand in slots a and b: colours and
 * lanes. size: of a block. */
fp3_status fp3_rows_lay(const fp3_bodies *bodies, fp3_law_rows *rows, const uint32_t *a,
                        const uint32_t *b, size_t size);
void fp3_rows_free(fp3_law_rows *rows);
static inline void fp3_put(fp3_wide *word, uint32_t lane, float value) { (*word)[lane] = value; }

/* substeps.c: of a step in a plane, behind rows of contacts and joints. */
fp3_status fp3_substeps_make(fp3_bodies *bodies);
fp3_status fp3_substeps_do(fp3_bodies *bodies, double h);

/* cuts.c: who has what. A thread has the same bodies and their contacts in all that a step does, so
 * that it finds them in its caches. */
/* Of bodies: halves, or as contacts have it. */
fp3_status fp3_cut_bodies(fp3_bodies *bodies);
/* By rows of contacts; then of the rows of a law, which have been laid. */
void fp3_cut_by_contacts(fp3_bodies *bodies, const fp3_law_rows *rows);
fp3_status fp3_cut_rows(const fp3_bodies *bodies, fp3_law_rows *rows);
/* part(of, from, to) for ranges of slots: each thread's own. */
void fp3_bodies_share_slots(fp3_bodies *bodies, void (*part)(void *of, uint32_t from, uint32_t to),
                            void *of);
/* Likewise of the blocks of rows, colour by colour: of threads from .. to - 1; of all. */
void fp3_rows_of(const fp3_bodies *bodies, const fp3_law_rows *rows, uint32_t from, uint32_t to,
                 void (*part)(void *of, uint32_t from, uint32_t to), void *of);
void fp3_bodies_share_rows(const fp3_bodies *bodies, const fp3_law_rows *rows,
                           void (*part)(void *of, uint32_t from, uint32_t to), void *of);
/* A pass takes so many blocks at a time. */
static inline uint32_t fp3_blocks_together(const fp3_bodies *bodies) {
    return bodies->space ? 1 : 2;
}

/* contacts.c, joints.c: rows for a step, with substeps of h, and what they have learned. */
fp3_status fp3_contacts_begin(fp3_bodies *bodies, double h);
/* A point of contact i does nothing in this step. */
void fp3_contact_leave(fp3_bodies *bodies, uint32_t i, uint32_t point);
/* Gaps, after impacts have moved bodies. */
void fp3_contacts_follow(fp3_bodies *bodies);
void fp3_contacts_end(fp3_bodies *bodies, double h);
/* Impacts of this step, behind fp3_contacts_begin; whether there was any, so that bodies have
 * moved. */
fp3_status fp3_impacts(fp3_bodies *bodies, int *is_any);
fp3_status fp3_joints_begin(fp3_bodies *bodies, double h);
/* Of a row of a law (- FP3_LAW_twist2): whether a spring or a motor has an impulse; makes its
 * impulses smaller. */
int fp3_joint_gives(const fp3_bodies *bodies, int law, uint32_t row);
void fp3_joint_scale(fp3_bodies *bodies, int law, uint32_t row, float by);
/* What of its definition a joint has. */
enum { FP3_USES_SPRING = 1, FP3_USES_MOTOR = 2, FP3_USES_LIMITS = 4, FP3_USES_ALL = 7 };
/* What is farther apart than this share of `size`, or turned by more than this, joints pull
 * together as if this were all. */
#define FP3_FARTHEST 0.2f
static inline double fp3_within(double x, double most) { return fmin(fmax(x, -most), most); }
/* Behind the step, where bodies are then. Joints that break are gone. */
void fp3_joints_end(fp3_bodies *bodies, double h);
/* Where the two anchors are, from their bodies' centres of mass, in the world's axes; and the way
 * from a's to b's. */
typedef struct {
    double arm_a[2], arm_b[2], gap[2], axis[2];
} fp3_stance;
fp3_stance fp3_joint_stance(const fp3_bodies *bodies, const fp3_joint *joint);
/* The angle of b and `ratio` times that of a, from the start. */
double fp3_joint_angle(const fp3_bodies *bodies, const fp3_joint *joint);
/* The distance, way or angle that its limits are of. */
double fp3_joint_at(const fp3_bodies *bodies, const fp3_joint *joint);
void fp3_joint_drop(fp3_bodies *bodies, uint32_t number);
/* Joints of bodies that are marked, because they are removed. */
void fp3_joints_drop(fp3_bodies *bodies);
/* Who is joined and does not collide, anew where joints have changed. */
fp3_status fp3_joints_find_apart(fp3_bodies *bodies);
/* Whether two bodies are joined and do not collide. */
int fp3_joints_part(const fp3_bodies *bodies, uint32_t a, uint32_t b);

/* Of a definition, about the body's origin. */
fp3_status fp3_shape_make(const fp3_shape_def *def, fp3_shape2 *shape, fp3_error *error);
/* events.c: notes a change of a contact; FP3_E_SYSTEM. */
fp3_status fp3_contact_tell(fp3_bodies *bodies, fp3_contact_change change, const fp3_touch2 *touch);
/* Behind a step: who touches, who no longer does. */
fp3_status fp3_contacts_tell(fp3_bodies *bodies);

/* hash.c: tells the words that fp3_bodies_hash is of, in their order. */
typedef void fp3_words_fn(void *user, const void *data, size_t size);
void fp3_bodies_words(const fp3_bodies *bodies, fp3_words_fn *add, void *user);
/* An fp3_words_fn: adds to a hash, a uint64_t. */
void fp3_words_hash(void *hash, const void *data, size_t size);

/* Wakes a body that sleeps, with its island. */
void fp3_bodies_wake(fp3_bodies *bodies, uint32_t number);
/* Wakes these bodies, whose handles are valid, and whatever touches them or is joined with them.
 * What was found of their contacts is looked at anew. */
void fp3_bodies_wake_around(fp3_bodies *bodies, const uint64_t *handles, size_t count);
/* After a step: who rests long enough falls asleep by islands. */
fp3_status fp3_bodies_rest(fp3_bodies *bodies);
/* Of each slot that moves the lowest one of its island, which touch each other or are joined. */
void fp3_bodies_islands(const fp3_bodies *bodies, uint32_t *root);
/* Finds pairs, manifolds, and which contacts are active. Who is touched by something awake wakes:
 * then wakes is 1, and all has to be done again, with slots for those. */
fp3_status fp3_bodies_touch(fp3_bodies *bodies, int *wakes);
/* near.c: pairs anew where a shape of something that moves has left its box. */
fp3_status fp3_pairs_renew(fp3_bodies *bodies);
/* Share of `size`: how near shapes have points of contact. */
#define FP3_REACH 0.02
/* How far a shape may come in a step, where that counts: of what bounces, so that its impact is
 * found in the step in which it is; of what is marked fast, so that it does not pass through; and
 * of whoever is too fast for ground. */
double fp3_shape_sweep(const fp3_bodies *bodies, const fp3_attached *shape, int is_bouncy,
                       int is_ground);
static inline fp3_pose2 fp3_body_turn(const fp3_body *body) {
    return (fp3_pose2){.c = body->turn[0], .s = body->turn[1]};
}
/* Boxes of a body's shapes, anew. */
void fp3_bodies_place_boxes(fp3_bodies *bodies, uint32_t number);

#endif
