/* SPDX-License-Identifier: Apache-2.0 */
/* values_own.h - what fp3_params is inside: values by name, and links. */
#ifndef FP3_SCENE_VALUES_OWN_H
#define FP3_SCENE_VALUES_OWN_H

#include "linked.h"

#include <fp3/model.h>
#include <fp3/program.h>

/* Where a value was set. */
typedef struct {
    const char *path; /* one of the files of the params; NULL: nowhere */
    unsigned line;
} fp3_value_place;

typedef struct {
    char name[FP3_NAME_SIZE];
    char *formula;       /* what it is computed from, or NULL */
    fp3_formula *parsed; /* NULL, too, of a formula that cannot be read */
    int has_number;      /* given besides a formula, which must agree; always without one */
    double value, last;  /* of the first object and, if that is another one, of the last */
    int is_spread;
    double *column; /* one number for each of `count` objects; NULL: as above */
    size_t count;
    fp3_value_place at;
} fp3_value;

typedef struct fp3_value_file {
    struct fp3_value_file *next;
    char path[];
} fp3_value_file;

struct fp3_params {
    fp3_value *list;
    size_t count;
    fp3_value_file *files;
    fp3_value_place at; /* of values that have none */
    fp3_linked *linked;
    double skin; /* of lists of near objects, as a share of the reach; below 0: not given */
};

/* NULL: there is none of this name. */
fp3_value *fp3_values_find(const fp3_params *params, const char *name);

#endif
