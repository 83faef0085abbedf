/* SPDX-License-Identifier: Apache-2.0 */
/* column.h - the values that a recording observes: which they are, and what they are for a block of
 * objects.
 */
#ifndef FP3_OUTPUT_COLUMN_H
#define FP3_OUTPUT_COLUMN_H

#include "evaluator.h"

typedef enum {
    FP3_COLUMN_STATE,    /* float */
    FP3_COLUMN_SLEPT,    /* uint32_t: the step in which the object fell asleep */
    FP3_COLUMN_LIFE,     /* uint32_t: an fp3_life_stage */
    FP3_COLUMN_SUM,      /* double: a state in double-single */
    FP3_COLUMN_COMPUTED, /* double: a definition or an invariant of the model */
} fp3_column_kind;

typedef struct {
    char name[FP3_NAME_SIZE];
    const char *unit, *doc; /* the model's, or "" */
    fp3_column_kind kind;
    uint32_t reg;  /* of a register */
    uint32_t low;  /* SUM: of the second word */
    uint32_t expr; /* of what is computed: in the model */
    void *values;  /* of the block that was read last */
} fp3_column;

typedef struct {
    fp3_column *list;
    size_t count;
    size_t room;              /* objects of a block at most */
    fp3_evaluator *evaluator; /* NULL: nothing is computed */
    float *words;             /* of a block, first and second; NULL: there are no sums */
} fp3_columns;

static inline int fp3_column_is_wide(const fp3_column *column) {
    return column->kind == FP3_COLUMN_SUM || column->kind == FP3_COLUMN_COMPUTED;
}

/* names: NULL for the states. has_lives: objects are born and gone, so the last column says who
 * lives. Room for blocks of at most `objects` objects, fewer where there are many columns. The
 * caller frees *columns, after a failure too. FP3_E_ARGUMENT: no such name, twice the same, or one
 * that stands for a column of its own. */
fp3_status fp3_columns_open(const fp3_program *program, const char *const *names, size_t count,
                            size_t objects, int has_lives, fp3_columns *columns, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_columns_free(fp3_columns *columns);

/* Once before the first block, with the values that objects were given. */
fp3_status fp3_columns_begin(fp3_columns *columns, const fp3_source *source, fp3_error *error);

/* Fills the values of objects first .. first+count-1, after `step` steps of the run. What goes
 * wrong the engine tells. */
fp3_status fp3_columns_read(fp3_columns *columns, const fp3_source *source, uint64_t step,
                            size_t first, size_t count);

#endif
