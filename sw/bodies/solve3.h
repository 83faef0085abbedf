/* SPDX-License-Identifier: Apache-2.0 */
/* solve3.h - passes over the contacts of a colour in space, eight contacts at a time, as solve2.h
 * has them in a plane.
 *
 * A body has two fours: of speed v and w, of way d, e and q (laws3.h).
 */
#ifndef FP3_BODIES_SOLVE3_H
#define FP3_BODIES_SOLVE3_H

#include "laws3.h"
#include "solve2.h"

enum { FP3_FOURS3 = 2, FP3_POINTS3 = 4 };

#define X(name, row, speed, way, point, integrator) FP3_LAW_##name,
typedef enum { FP3_LAWS3(X) FP3_LAWS_IN_SPACE } fp3_law3;
#undef X

typedef struct {
    const char *name;
    /* A row has normals, tangents, arms, masses and inertias, `radius` as the mean distance of the
     * points from the middle, and in j of a point 1 if it is there, else 0. Makes the row of it. */
    void (*prepare)(const fp3_work2 *, uint32_t first, uint32_t end);
    /* Blocks first .. end - 1 make a pass: each point of theirs, then friction where it acts.
     * points: of each block, fp3_points_of3. is_rolling: some contact has rolling resistance;
     * has_moved: gaps first. */
    void (*pass)(const fp3_work2 *, const uint8_t *points, uint32_t first, uint32_t end,
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

/* How many points the contacts of a block have, at most: behind them none has any. */
static inline uint32_t fp3_points_of3(const fp3_contact3_row *row) {
    uint32_t count = 0;
    for (uint32_t k = 0; k < FP3_POINTS3; k++)
        for (uint32_t lane = 0; lane < FP3_WIDE; lane++)
            if (row->point[k].j[lane] > 0)
                count = k + 1;
    return count;
}

#endif
