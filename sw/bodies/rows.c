/* SPDX-License-Identifier: Apache-2.0 */
/* rows.c - rows of a law: their colours, their lanes. */
#include "own.h"
#include "share.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

fp3_softness fp3_soften(double hertz, double damping, double h) {
    if (!(hertz > 0))
        return (fp3_softness){0, 0, 0};
    const double omega = 2 * PI * hertz, a1 = 2 * damping + h * omega, a2 = h * omega * a1,
                 a3 = 1 / (1 + a2);
    return (fp3_softness){(float)(omega / a1), (float)(a2 * a3), (float)a3};
}

/* Contacts are springs and dampers that a substep can resolve (docs/bodies.md): no stiffer than
 * this share of the substeps' rate, in turns of the spring; nor than what carries a stack of boxes.
 * Their depth is as g/size over the square of this, so it grows where that is more than usual. */
#define STIFFNESS 30.0 /* Hz, for g/size of up to 10/s^2 */
#define RESOLVED 0.25
#define DAMPING 10.0 /* of critical damping */
#define USUAL 1.1    /* up to so many times STIFFNESS it stays as it is */

fp3_softness fp3_contact_softness(const fp3_bodies *bodies, double h, double times) {
    const double *g = bodies->def.gravity;
    const double pull = sqrt(g[0] * g[0] + g[1] * g[1] + (bodies->space ? g[2] * g[2] : 0)),
                 carries = STIFFNESS * sqrt(pull / (10 * bodies->def.size));
    const double hertz = fmin(carries > USUAL * STIFFNESS ? carries : STIFFNESS, RESOLVED / h);
    return fp3_soften(times * hertz, DAMPING, h);
}

fp3_status fp3_rows_make_room(const fp3_bodies *bodies, fp3_law_rows *rows, size_t count) {
    fp3_status status = fp3_bodies_room((void **)&rows->a, &rows->a_room, sizeof *rows->a,
                                        count + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&rows->b, &rows->b_room, sizeof *rows->b, count + 1u,
                                 bodies->error);
    return status;
}

/* Whose each lane is. */
static void give_lanes(const fp3_bodies *bodies, fp3_law_rows *rows, const uint32_t *a,
                       const uint32_t *b, uint32_t blocks) {
    memset(rows->at, -1, blocks * FP3_WIDE * sizeof *rows->at);
    for (uint32_t i = 0; i < rows->count; i++)
        rows->at[rows->lane[i]] = i;
    for (uint32_t k = 0; k < blocks; k++) {
        const uint32_t *at = &rows->at[k * FP3_WIDE];
        for (uint32_t lane = 0; lane < FP3_WIDE; lane++) {
            rows->ends[k].a[lane] = at[lane] == FP3_NOBODY ? bodies->movable : a[at[lane]];
            rows->ends[k].b[lane] = at[lane] == FP3_NOBODY ? bodies->movable : b[at[lane]];
        }
    }
}

/* Rows that other ranks pass over stand behind all colours. */
static fp3_status find_own(const fp3_bodies *bodies, fp3_law_rows *rows, const uint32_t *a,
                           const uint32_t *b, uint32_t together) {
    const uint32_t count = rows->count;
    uint32_t *of = NULL, room = 0, own = 0, others = 0;
    fp3_status status =
        fp3_bodies_room((void **)&of, &room, 4 * sizeof *of, count + 1u, bodies->error);
    if (status)
        return status;
    uint32_t *own_a = of + count, *own_b = own_a + count, *lane = own_b + count;
    for (uint32_t i = 0; i < count; i++) {
        if (!fp3_share_has(bodies, a[i], b[i]))
            continue;
        own_a[own] = a[i];
        own_b[own] = b[i];
        of[own++] = i;
    }
    status = fp3_colours_find(&rows->colours, own_a, own_b, own, bodies->movable, FP3_WIDE,
                              together, rows->colour, lane, bodies->error);
    rows->blocks = status ? 0 : rows->colours.first[rows->colours.count];
    for (uint32_t i = 0; i < count; i++)
        rows->lane[i] = FP3_NOBODY;
    for (uint32_t i = 0; !status && i < own; i++)
        rows->lane[of[i]] = lane[i];
    for (uint32_t i = 0; i < count; i++)
        if (rows->lane[i] == FP3_NOBODY)
            rows->lane[i] = rows->blocks * FP3_WIDE + others++;
    rows->blocks += (others + together * FP3_WIDE - 1) / (together * FP3_WIDE) * together;
    free(of);
    return status;
}

static fp3_status find_colours(const fp3_bodies *bodies, fp3_law_rows *rows, const uint32_t *a,
                               const uint32_t *b) {
    const uint32_t together = fp3_blocks_together(bodies);
    if (bodies->share)
        return find_own(bodies, rows, a, b, together);
    const fp3_status status =
        fp3_colours_find(&rows->colours, a, b, rows->count, bodies->movable, FP3_WIDE, together,
                         rows->colour, rows->lane, bodies->error);
    rows->blocks = status ? 0 : rows->colours.first[rows->colours.count];
    return status;
}

fp3_status fp3_rows_lay(const fp3_bodies *bodies, fp3_law_rows *rows, const uint32_t *a,
                        const uint32_t *b, size_t size) {
    if (rows->ends && rows->is_same && rows->laid == rows->count &&
        rows->laid_movable == bodies->movable && rows->laid_share == fp3_share_number(bodies)) {
        if (!rows->is_whole)
            memset(rows->row, 0, rows->blocks * size);
        return FP3_OK;
    }
    rows->laid = FP3_NOBODY;
    rows->layings++;
    rows->is_cut = 0;
    fp3_status status = fp3_bodies_room((void **)&rows->colour, &rows->colour_room,
                                        sizeof *rows->colour, rows->count + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&rows->lane, &rows->lane_room, sizeof *rows->lane,
                                 rows->count + 1u, bodies->error);
    if (!status)
        status = find_colours(bodies, rows, a, b);
    if (status)
        return status;
    const uint32_t blocks = rows->blocks;
    status = fp3_bodies_room(&rows->row, &rows->row_room, size, blocks + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&rows->ends, &rows->end_room, sizeof *rows->ends,
                                 blocks + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&rows->at, &rows->at_room, sizeof *rows->at,
                                 (size_t)blocks * FP3_WIDE + 1u, bodies->error);
    if (status)
        return status;
    if (!rows->is_whole)
        memset(rows->row, 0, blocks * size);
    give_lanes(bodies, rows, a, b, blocks);
    rows->laid = rows->count;
    rows->laid_movable = bodies->movable;
    rows->laid_share = fp3_share_number(bodies);
    return FP3_OK;
}

void fp3_rows_free(fp3_law_rows *rows) {
    free(rows->row);
    free(rows->ends);
    free(rows->lane);
    free(rows->of);
    free(rows->a);
    free(rows->b);
    free(rows->at);
    free(rows->cut);
    free(rows->colour);
    fp3_colours_free(&rows->colours);
    *rows = (fp3_law_rows){0};
}
