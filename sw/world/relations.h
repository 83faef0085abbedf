/* SPDX-License-Identifier: Apache-2.0 */
/* relations.h - relations of a program's objects: given links; `all` and `near` need no values.
 *
 *     fp3_relations r = {.to = ..., .linked = links};
 *     if (fp3_relations_load(&r, error) || fp3_relations_reach(&r, params, error) ||
 *         fp3_relations_check(&r, "fp3_batch_link gives them", error)) ...
 */
#ifndef FP3_BATCH_RELATIONS_H
#define FP3_BATCH_RELATIONS_H

#include "field.h"
#include "linked.h"

#define FP3_WORLD                                                                                  \
    "world" /* the configuration for objects that see each other, unless another is named */
#define FP3_NEAR_SKIN 0.3 /* of the reach: how much farther lists of those near go */

typedef struct {
    fp3_fields_def to;  /* the program is loaded */
    fp3_linked *linked; /* by relation of the model, or by list of the image */
    double skin;        /* of the reach; default FP3_NEAR_SKIN */
    /* Of the model's relations, that the engine knows; radii of objects are added to it. */
    double reach[FP3_RELATIONS_MAX];
    int is_given[FP3_RELATIONS_MAX];
} fp3_relations;

/* After a load: gives the engine all links, and the lists of `all` and `near`. FP3_E_ARGUMENT:
 * links of a name that is no relation of links; unknown objects or fields. If the engine refuses a
 * call, the message is in the error of its definition. */
fp3_status fp3_relations_load(fp3_relations *r, fp3_error *error);
/* The links alone. */
fp3_status fp3_relations_link(const fp3_relations *r, fp3_error *error);
/* Which of the lists of the engine's group it is; -1: the program has none of this name. */
int fp3_relations_list(const fp3_relations *r, const char *name);
/* Gives the engine the reaches of `near` if params, as many as the model has, change them. Does
 * nothing for an image. */
fp3_status fp3_relations_reach(fp3_relations *r, const double *params, fp3_error *error);
/* FP3_E_ARGUMENT: a list is missing. how: what gives it, for the message. */
fp3_status fp3_relations_check(const fp3_relations *r, const char *how, fp3_error *error);

#endif
