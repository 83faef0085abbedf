/* SPDX-License-Identifier: Apache-2.0 */
/* solve3.h - passes over the contacts of a colour in space, eight contacts at a time, as solve2.h
 * has them in a plane.
 *
 * A body has two fours: of speed v and w, of way d, e and q (laws3.h).
 */
#ifndef FP3_BODIES_SOLVE3_H
#define FP3_BODIES_SOLVE3_H

#include "laws3.h"
#include "patch3.h"
#include "solve2.h"

enum { FP3_FOURS3 = 2, FP3_POINTS3 = 4 };

#define X(name, row, speed, way, point, integrator) FP3_LAW_##name,
typedef enum { FP3_LAWS3(X) FP3_LAWS_IN_SPACE } fp3_law3;
#undef X

/* What rows of contacts are made of. */
typedef struct {
    fp3_patch3 *patch;
    const uint32_t *of, *at; /* of each contact its patch; of each lane the contact */
    const fp3_four
        *heft; /* of each slot two: 1/mass and the inverse inertia, as solve3.c has them */
    fp3_softness softness[2]; /* between bodies that move; against one that does not */
    /* Of each block: how many its contacts have, at most; and FP3_HAS_TURNED where its rows are
     * renewed behind gap3, because a body of theirs has turned far. */
    uint8_t *points;
} fp3_making3;
enum { FP3_HAS_TURNED = 8 };

typedef struct {
    const char *name;
    /* Makes rows of contacts, blocks first .. end - 1, and their `points`. */
    void (*prepare)(const fp3_work2 *, const fp3_making3 *, uint32_t first, uint32_t end);
    /* What the rows of a block answer with, as arms and inverse inertias are now. */
    void (*renew)(const fp3_work2 *, const fp3_making3 *, uint32_t block);
    /* Impulses of rows go back to their patches. */
    void (*keep)(const fp3_work2 *, const fp3_making3 *, uint32_t first, uint32_t end);
    /* Blocks first .. end - 1 make a pass: each point of theirs, then friction where it acts.
     * is_rolling: some contact has rolling resistance; has_moved: gaps first. */
    void (*pass)(const fp3_work2 *, const fp3_making3 *, uint32_t first, uint32_t end,
                 const float shared[FP3_SHARED], int is_rolling, int has_moved);
    /* A pass of a law of joints: law - FP3_LAW_pin3. */
    void (*joint[FP3_LAWS_IN_SPACE - FP3_LAW_pin3])(const fp3_work2 *, uint32_t first, uint32_t end,
                                                    const float shared[FP3_SHARED]);
    /* Bodies turn. Rows are of the bodies that `ends` has as a. */
    void (*turn)(const fp3_work2 *, uint32_t first, uint32_t end, const float shared[FP3_SHARED]);
} fp3_solver3;

/* Those that suit this processor and the variable FP3_FAST. All have the same bits.
 * FP3_E_ARGUMENT: the variable asks for what is not there. */
fp3_status fp3_solvers_choose(const fp3_solver2 **plane, const fp3_solver3 **space,
                              fp3_error *error);

/* Friction acts in passes that mend speeds, and at the impulses that a step begins with. In passes
 * that push overlaps apart it would hold what these speeds move aside, and give it back later: a
 * wide wall of bricks came to wave. */
static inline int fp3_has_friction3(const float shared[FP3_SHARED]) {
    return shared[FP3_PUSH] == 0 || shared[FP3_WARM] != 0;
}

#endif
