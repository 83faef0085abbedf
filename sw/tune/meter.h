/* meter.h - how large the error of a program is on a sample. */
#ifndef FP3_TUNE_METER_H
#define FP3_TUNE_METER_H

#include "sample.h"

/* The machine whose bits the errors are of; all configurations with its roundings have the same. */
#define FP3_METER_CONFIG "many_full"

typedef struct {
    fp3_engine *engine; /* of `objects`; NULL at first */
    size_t objects;
    float *room;   /* of two numbers for each object */
    fp3_error why; /* where the engine tells */
} fp3_meter;

void fp3_meter_close(fp3_meter *meter);

/* compiled: for FP3_METER_CONFIG. steps: over the span, a multiple of FP3_TUNE_LOOKS. *worst is the error as
 * fp3/tune.h defines it: infinite where a number of the program has no room in FP32, too. */
fp3_status fp3_meter_read(fp3_meter *meter, const fp3_sample *sample, const fp3_compiled *compiled,
                          uint64_t steps, double *worst, fp3_error *error);

/* h of so many steps. */
float fp3_meter_h(const fp3_sample *sample, uint64_t steps);

/* ---- parts, for who runs the objects otherwise ---- */

/* Objects as a program's model has them: a row of params and of starts for each. */
typedef struct {
    size_t objects, param_count, state_count;
    const double *params, *initial;
    double h;
} fp3_meter_rows;

/* Gives an engine the program and its objects. *has_room: all their numbers have room in FP32; else nothing
 * is loaded. */
fp3_status fp3_meter_start(fp3_meter *meter, const fp3_compiled *compiled,
                           const fp3_meter_rows *rows, int *has_room, fp3_error *error);

/* The error at one look, of objects first .. first+sample->count-1 of the engine, which are those of the
 * sample `late` behind it; *worst grows to it. What the engine refuses is told in meter->why alone. */
fp3_status fp3_meter_look(fp3_meter *meter, const fp3_sample *sample, const fp3_compiled *compiled,
                          unsigned look, size_t first, double late, double *worst);

/* What the engine has told becomes the error. */
fp3_status fp3_meter_judge(const fp3_meter *meter, fp3_status status, fp3_error *error);

#endif
