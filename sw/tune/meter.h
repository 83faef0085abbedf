/* meter.h - how large the error of a program is on a sample. */
#ifndef FP3_TUNE_METER_H
#define FP3_TUNE_METER_H

#include "sample.h"

/* The machine whose bits the errors are of; all configurations with its roundings have the same. */
#define FP3_METER_CONFIG "many_full"

typedef struct {
    fp3_engine *engine; /* of `objects`; NULL at first */
    size_t objects;
    fp3_error why; /* where the engine tells */
} fp3_meter;

void fp3_meter_close(fp3_meter *meter);

/* compiled: for FP3_METER_CONFIG. steps: over the span, a multiple of FP3_TUNE_LOOKS. *worst is the error as
 * fp3/tune.h defines it: infinite where a number of the program has no room in FP32, too. */
fp3_status fp3_meter_read(fp3_meter *meter, const fp3_sample *sample, const fp3_compiled *compiled,
                          uint64_t steps, double *worst, fp3_error *error);

/* h of so many steps. */
float fp3_meter_h(const fp3_sample *sample, uint64_t steps);

#endif
