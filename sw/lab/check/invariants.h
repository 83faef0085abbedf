/* SPDX-License-Identifier: Apache-2.0 */
/* invariants.h - invariants of all objects together, in double: what a model sums over its objects
 * and over the pairs of a relation. Groups that see each other add up the invariants of one name.
 *
 *     fp3_invariants *of = NULL;
 *     fp3_invariant found[2];
 *     if (!fp3_invariants_open(groups, count, &of, error) && fp3_invariants_count(of) <= 2 &&
 *         !fp3_invariants_find(of, found, error))
 *         printf("%s: %g\n", fp3_invariants_name(of, 0), found[0].value);
 *     fp3_invariants_close(&of);
 *
 * It shares no code with the compiler.
 */
#ifndef FP3_CHECK_INVARIANTS_H
#define FP3_CHECK_INVARIANTS_H

#include <fp3/program.h>

/* The objects of one group, at some time. */
typedef struct {
    const char *name; /* what a kind of another group's model calls it, or NULL */
    const fp3_program *program;
    const fp3_params *params;
    size_t objects;
    const double *columns; /* states, of `objects` each */
    double t;
} fp3_invariant_group;

typedef struct {
    double value;
    double size; /* the magnitudes of its terms, added up */
} fp3_invariant;

typedef struct fp3_invariants fp3_invariants;

/* The groups, and all that they point to, must outlive it; states and t may change. A group that
 * is no model has none. FP3_E_ARGUMENT: groups give one name to values in different units. The
 * caller closes *of, which is NULL on failure. */
fp3_status fp3_invariants_open(const fp3_invariant_group *groups, size_t count, fp3_invariants **of,
                               fp3_error *error);
/* Sets *of to NULL, which it may be already. */
void fp3_invariants_close(fp3_invariants **of);

size_t fp3_invariants_count(const fp3_invariants *of);
const char *fp3_invariants_name(const fp3_invariants *of, size_t number);

/* How many terms the sums over pairs have at most. */
double fp3_invariants_work(const fp3_invariants *of);

/* Finds the values of all, with the pairs that there are now. */
fp3_status fp3_invariants_find(fp3_invariants *of, fp3_invariant *found, fp3_error *error);

/* The change from one to the other, relative to the larger size. NaN: one of them has no value. */
double fp3_invariant_change(const fp3_invariant *first, const fp3_invariant *last);

#endif
