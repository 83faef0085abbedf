/* SPDX-License-Identifier: Apache-2.0 */
/* field.h - the names of a program's values, and where each value is kept.
 *
 * A compiled model has its params, its states, h and, if it counts steps, `steps`; any other image
 * the names that it declares for the host.
 */
#ifndef FP3_BATCH_FIELD_H
#define FP3_BATCH_FIELD_H

#include <fp3/compile.h>
#include <fp3/engine.h>

/* All of it must outlive the fields. */
typedef struct {
    fp3_engine *engine;           /* the program is loaded; it tells where its definition says */
    size_t group, first, objects; /* of the engine */
    size_t number;                /* that messages give the first of them */
    const fp3_image *image;
    const fp3_compiled *compiled; /* whose image it is; NULL: no model's */
    double h;                     /* of a model */
} fp3_fields_def;

typedef enum {
    FP3_FIELD_STATE,
    FP3_FIELD_PARAM,
    FP3_FIELD_STEP,  /* h */
    FP3_FIELD_COUNT, /* `steps` */
    FP3_FIELD_SLEPT  /* of an image: the number of a step, as bits */
} fp3_field_kind;

typedef struct {
    const char *name; /* belongs to the model or the image */
    fp3_field_kind kind;
    uint32_t index; /* of the model's params or states */
    int is_shared;  /* one for all objects */
    int place;     /* the register, or shared constant, that holds it as it is; -1: there is none */
    int low, lost; /* of a state: registers of its second word, of what updates lose; -1: none */
    int is_kept;   /* the values are kept here, since inputs are computed from them */
    int is_pending;    /* not kept, and `uniform` is not in the engine yet */
    double usual;      /* the model's default; of an image: 0 */
    double uniform;    /* the value of all objects, unless there is a column */
    double *column;    /* of each object; NULL: all have the same */
    uint64_t follows;  /* of a state: the params in its start, a bit each; 0: the start is written,
                          or a number */
    uint64_t followed; /* ... at first, and of an object that is born */
    unsigned char *is_given; /* of a start that follows params: the objects whose start is written;
                                NULL: none */
} fp3_field;

typedef struct {
    fp3_field *list;
    uint32_t count;
    const fp3_model *model; /* NULL: of an image */
    int needs_finite;       /* of a model, or of a configuration that has no infinity */
    int has_before;         /* objects keep where they were one step ago */
    int has_count;          /* the program counts steps, of which t is made */
} fp3_field_table;

/* compiled: whose image it is, or NULL. The caller closes, after a failure too. */
fp3_status fp3_field_list(const fp3_image *image, const fp3_compiled *compiled, double h,
                          fp3_field_table *table, fp3_error *error);
void fp3_field_close(fp3_field_table *table);

/* NULL, with an error that has the nearest name: there is none. */
fp3_field *fp3_field_find(const fp3_field_table *table, const char *name, fp3_error *error);

static inline double fp3_field_at(const fp3_field *q, size_t object) {
    return q->column ? q->column[object] : q->uniform;
}

/* The word of a value. NULL, or what is expected instead of the value. */
const char *fp3_field_word(const fp3_field_table *table, const fp3_field *q, double value,
                           float *word);

#endif
