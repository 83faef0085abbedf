/* SPDX-License-Identifier: Apache-2.0 */
/* rows.c - rows of a law: their colours, their lanes. */
#include "own.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

fp3_softness fp3_soften(double hertz, double damping, double h) {
    const double omega = 2 * PI * hertz, a1 = 2 * damping + h * omega, a2 = h * omega * a1,
                 a3 = 1 / (1 + a2);
    if (!(hertz > 0))
        return (fp3_softness){0, 0, 0};
    return (fp3_softness){(float)(omega / a1), (float)(a2 * a3), (float)a3};
}

fp3_status fp3_rows_lay(const fp3_bodies *bodies, fp3_law_rows *rows, const uint32_t *a,
                        const uint32_t *b, size_t size) {
    uint32_t *colour = NULL, room = 0;
    fp3_status status =
        fp3_bodies_room((void **)&colour, &room, sizeof *colour, rows->count + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&rows->lane, &rows->lane_room, sizeof *rows->lane,
                                 rows->count + 1u, bodies->error);
    if (!status)
        status = fp3_colours_find(&rows->colours, a, b, rows->count, bodies->movable, FP3_WIDE, 2,
                                  colour, rows->lane, bodies->error);
    free(colour);
    if (status)
        return status;
    const uint32_t blocks = rows->colours.first[rows->colours.count];
    status = fp3_bodies_room(&rows->row, &rows->row_room, size, blocks + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&rows->ends, &rows->end_room, sizeof *rows->ends,
                                 blocks + 1u, bodies->error);
    if (status)
        return status;
    memset(rows->row, 0, blocks * size);
    for (uint32_t i = 0; i < blocks; i++)
        for (uint32_t lane = 0; lane < FP3_WIDE; lane++)
            rows->ends[i].a[lane] = rows->ends[i].b[lane] = bodies->movable;
    for (uint32_t i = 0; i < rows->count; i++) {
        fp3_ends2 *ends = &rows->ends[rows->lane[i] / FP3_WIDE];
        ends->a[rows->lane[i] % FP3_WIDE] = a[i];
        ends->b[rows->lane[i] % FP3_WIDE] = b[i];
    }
    return FP3_OK;
}

void fp3_rows_free(fp3_law_rows *rows) {
    free(rows->row);
    free(rows->ends);
    free(rows->lane);
    free(rows->of);
    fp3_colours_free(&rows->colours);
    *rows = (fp3_law_rows){0};
}
