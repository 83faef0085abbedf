/* SPDX-License-Identifier: Apache-2.0 */
/* fields.h - the values of a group of an engine's objects, by the names of its program.
 *
 * Inputs of the engine are computed as by fp3_compiled_inputs. Before the next step, only inputs
 * whose values have changed are computed again, and only for the objects concerned.
 *
 *     if (fp3_fields_open(&def, &fields, error) ||
 *         fp3_fields_set(fields, "m", 2, error) || fp3_fields_settle(fields, error) ||
 *         fp3_engine_run(engine, 100, NULL)) ...
 *     fp3_fields_moved(fields);
 */
#ifndef FP3_BATCH_FIELDS_H
#define FP3_BATCH_FIELDS_H

#include "field.h"

typedef struct fp3_fields fp3_fields;

/* Values of a column, one of the two. */
typedef struct {
    const float *single;
    const double *wide;
} fp3_numbers;

static inline fp3_numbers fp3_numbers_from(fp3_numbers values, size_t i) {
    return (fp3_numbers){.single = values.single ? values.single + i : NULL,
                         .wide = values.single ? NULL : values.wide + i};
}

/* With a model all objects have the defaults; with an image the values in the engine. The caller
 * closes *fields, which is NULL on failure. */
fp3_status fp3_fields_open(const fp3_fields_def *def, fp3_fields **fields, fp3_error *error);
/* Sets *fields to NULL, which it may be already. */
void fp3_fields_close(fp3_fields **fields);

/* FP3_E_ARGUMENT: there are no such objects. */
fp3_status fp3_fields_check(const fp3_fields *q, size_t first, size_t count, fp3_error *error);

/* As of fp3_batch_set, fp3_batch_write and fp3_batch_read. */
fp3_status fp3_fields_set(fp3_fields *q, const char *name, double value, fp3_error *error);
fp3_status fp3_fields_write(fp3_fields *q, const char *name, size_t first, size_t count,
                            fp3_numbers values, fp3_error *error);
fp3_status fp3_fields_read(fp3_fields *q, const char *name, size_t first, size_t count,
                           float *single, double *wide, fp3_error *error);
/* Of a model: as of fp3_batch_write_rows. */
fp3_status fp3_fields_write_rows(fp3_fields *q, size_t first, size_t count, const double *params,
                                 const double *initial, fp3_error *error);
/* As of fp3_batch_column. */
fp3_status fp3_fields_column(fp3_fields *q, const char *name, const float **values,
                             fp3_error *error);
/* The value of the first object. */
fp3_status fp3_fields_get(fp3_fields *q, const char *name, double *value, fp3_error *error);

/* Writes the changed values to the engine. FP3_E_ARGUMENT: as of fp3_compiled_inputs, with the
 * object in front. */
fp3_status fp3_fields_settle(fp3_fields *q, fp3_error *error);
/* A step was made: states are where it has left them. */
void fp3_fields_moved(fp3_fields *q);
/* These objects have the defaults, and have made no step; the caller has wiped them. */
fp3_status fp3_fields_born(fp3_fields *q, size_t first, size_t count, fp3_error *error);
/* Back to the starts. The program is loaded again. */
void fp3_fields_restart(fp3_fields *q);

#endif
