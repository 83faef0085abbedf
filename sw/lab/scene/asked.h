/* SPDX-License-Identifier: Apache-2.0 */
/* asked.h - values of a model's expressions, for many objects at once, with their neighbours.
 *
 *     fp3_asked asked;
 *     fp3_status status = fp3_asked_open(model, exprs, 2, &asked, error);
 *     for (size_t first = 0; first < objects; first += FP3_ASKED_OBJECTS)
 *         ... fp3_asked_values(&asked, &moment, first, count, room);
 *     fp3_asked_close(&asked);
 */
#ifndef FP3_LAB_ASKED_H
#define FP3_LAB_ASKED_H

#include "crowd.h"

#define FP3_ASKED_OBJECTS 64 /* at once */
#define FP3_ASKED_PAIRS 128

/* Sums over the same neighbours, which need nothing of each other; or what entries remember. What
 * their terms read that is the same for all entries of an object, and what is not, each in the
 * order of the expressions. */
typedef struct {
    uint32_t relation;
    uint32_t *outer, *inner, *folds;
    uint32_t outer_count, inner_count, fold_count;
    uint32_t entry; /* what entries remember; FP3_NONE: sums */
} fp3_asked_term;

typedef struct {
    const fp3_model *model;
    /* In the order in which they are computed; of a sum, the number of its term, whose other sums
     * are computed then, too; else FP3_NONE. */
    uint32_t *exprs, *term_of;
    uint32_t count;
    fp3_asked_term *terms;
    uint32_t term_count;
} fp3_asked;

/* These expressions, which are of the object itself; those of `remember` are of its entries, and
 * are asked for one by one: is_of_entries. The caller closes, after a failure too. */
fp3_status fp3_asked_open(const fp3_model *model, const uint32_t *exprs, uint32_t count,
                          fp3_asked *asked, fp3_error *error);
fp3_status fp3_asked_open_entries(const fp3_model *model, uint32_t expr, uint32_t relation,
                                  fp3_asked *asked, fp3_error *error);
void fp3_asked_close(fp3_asked *asked);

/* Where and when. */
typedef struct {
    const fp3_crowd *crowd;
    uint32_t group;
    double *const *states; /* of each group */
    const double *before;  /* of the group, when the step began */
    double t, h;           /* the scene's time; the length of the step */
} fp3_moment;

/* Room for the values of a model: of its expressions, columns of FP3_ASKED_OBJECTS numbers. NULL:
 * no memory. */
double *fp3_asked_room(const fp3_model *model);
static inline const double *fp3_asked_column(const double *room, uint32_t expr) {
    return room + (size_t)expr * FP3_ASKED_OBJECTS;
}

/* Of objects first .. first + count - 1, at most FP3_ASKED_OBJECTS. Returns what it cost: how many
 * numbers were computed. */
uint64_t fp3_asked_values(const fp3_asked *asked, const fp3_moment *m, size_t first, size_t count,
                          double *room);
/* Of the entries of these objects: a number each, from the list's beginning. Entries of objects
 * that do not live are left out. */
uint64_t fp3_asked_entries(const fp3_asked *asked, const fp3_moment *m, size_t first, size_t count,
                           double *room, double *values);

#endif
