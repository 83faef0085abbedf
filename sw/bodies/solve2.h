/* SPDX-License-Identifier: Apache-2.0 */
/* solve2.h - passes over the contacts of a colour in a plane, eight contacts at a time.
 *
 * Contacts of a colour share no body that moves, so those of a block, and blocks, may go in any
 * order, or at once. Laws and their bits: laws.h.
 */
#ifndef FP3_BODIES_SOLVE2_H
#define FP3_BODIES_SOLVE2_H

#include "laws.h"
#include "touch2.h"

#include <fp3/status.h>
#include <stdint.h>

/* What a body has side by side: its speed v_x, v_y, w, or its way d_x, d_y, q since the step began.
 */
typedef float fp3_four __attribute__((vector_size(16), may_alias));

/* Of each contact of a block, where its bodies stand. A lane without a contact has twice
 * the body that never moves. */
typedef struct {
    uint32_t a[FP3_WIDE], b[FP3_WIDE];
} fp3_ends2;

/* Rows of a law. */
typedef struct {
    fp3_four *speed;
    fp3_four *way; /* turn3 alone writes it */
    /* Of joints: what they do is none of what contacts give, so it goes here, too; NULL: contacts.
     */
    fp3_four *base;
    uint32_t movable; /* only bodies before this one are written */
    void *row;
    const fp3_ends2 *ends;
} fp3_work2;

#define X(name, row, speed, way, point, integrator) FP3_LAW_##name,
typedef enum { FP3_LAWS2(X) FP3_LAWS } fp3_law;
#undef X
/* What all rows of a pass have: FP3_SHARED_WORDS. */
enum { FP3_PUSH, FP3_INVERSE, FP3_LEAST, FP3_WARM, FP3_PACE, FP3_FAR, FP3_SHARED };

/* What gravity, forces and damping do in a substep: v = damp (v + pull), lane by lane, and the way
 * is h v - drop. Of a body that nothing touches drop is half of what `pull` adds, so it follows its
 * parabola exactly; else 0, as what rests has to stay. */
typedef struct {
    fp3_four pull, damp, drop;
} fp3_pull2;

/* A spring or a contact, as laws have it. Of `hertz` and `damping` (of critical damping), in one
 * implicit step of length h (rows.c). */
typedef struct {
    float rate, soft, fade;
} fp3_softness;

/* What rows of contacts are made of. */
typedef struct {
    fp3_touch2 *touch;
    const uint32_t *of, *at;  /* of each lane the contact; of each contact its touch */
    const fp3_four *heft;     /* of each slot: over mass, over inertia */
    fp3_softness softness[2]; /* between bodies that move; against one that does not */
} fp3_making2;

/* What guesses of joints are checked by (guess.h): of each body its slot, its speed before them,
 * and the masses of its numbers; `fours` of speed, of which the first counts. */
typedef double fp3_masses __attribute__((vector_size(32)));
typedef struct {
    const fp3_four *speed, *before;
    const uint32_t *slot;
    const fp3_masses *mass;
    uint32_t fours;
} fp3_guessed;
/* Kinetic energy of speeds before; what their change adds, in both orders. */
typedef struct {
    double before, first, second;
} fp3_energy;

typedef struct {
    const char *name;
    /* Makes rows of contacts, blocks first .. end - 1, and how fast their bodies come together. */
    void (*prepare)(const fp3_work2 *, const fp3_making2 *, uint32_t first, uint32_t end);
    /* Impulses of rows go back to their touches. */
    void (*keep)(const fp3_work2 *, const fp3_making2 *, uint32_t first, uint32_t end);
    /* Blocks first .. end - 1, an even number of them, make a pass. */
    void (*law[FP3_LAWS])(const fp3_work2 *, uint32_t first, uint32_t end,
                          const float shared[FP3_SHARED]);
    /* Masses that contacts feel anew, at their arms now, of bodies whose heft[2] is 1. */
    void (*renew)(const fp3_work2 *, const fp3_four *heft, uint32_t first, uint32_t end);
    /* gap2, then contact2. */
    void (*moved)(const fp3_work2 *, uint32_t first, uint32_t end, const float shared[FP3_SHARED]);
    /* A substep begins for bodies 0 .. count-1. base: the speed without what contacts give, which
     * they give again: speed - base before the call. is_first: they have given nothing yet. */
    void (*speed)(fp3_four *speed, fp3_four *base, const fp3_pull2 *pull, uint32_t count,
                  int is_first);
    void (*place)(const fp3_four *speed, fp3_four *way, const fp3_pull2 *pull, uint32_t count,
                  float h);
    /* Of bodies first .. end - 1. */
    void (*energy)(const fp3_guessed *, uint32_t first, uint32_t end, fp3_energy *to);
} fp3_solver2;

#endif
