/* SPDX-License-Identifier: Apache-2.0 */
/* grid.h - objects in a row, a sheet or a block, and which of them are linked.
 *
 * Object number: the first axis runs first.
 */
#ifndef FP3_ARRANGE_GRID_H
#define FP3_ARRANGE_GRID_H

#include <fp3/engine.h>

#define FP3_GRID_AXES 3

typedef struct {
    unsigned axes; /* 1 to 3 */
    uint32_t count[FP3_GRID_AXES];
    double spacing[FP3_GRID_AXES];
} fp3_grid;

typedef enum {
    FP3_GRID_STRUCTURAL, /* the next one along an axis */
    FP3_GRID_SHEAR,      /* the next one along a diagonal, of a square or of a cube */
    FP3_GRID_BENDING,    /* the next but one along an axis */
    FP3_GRID_KINDS
} fp3_grid_kind;

const char *fp3_grid_kind_name(fp3_grid_kind kind);

/* Where an object is along each axis. */
void fp3_grid_at(const fp3_grid *grid, size_t object, uint32_t at[FP3_GRID_AXES]);

typedef struct {
    fp3_links links; /* without fields */
    uint32_t *ends;  /* all a, then all b */
    double *length;  /* of each link */
} fp3_grid_links;

/* Links of these kinds, a set of bits, object by object. The caller frees *made, after a failure
 * too. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_grid_link(const fp3_grid *grid, unsigned kinds, fp3_grid_links *made,
                         fp3_error *error);
void fp3_grid_links_free(fp3_grid_links *made);

#endif
