/* meter_adaptive.h - how large the error of adaptive steps is on a sample, and how many they are. */
#ifndef FP3_TUNE_METER_ADAPTIVE_H
#define FP3_TUNE_METER_ADAPTIVE_H

#include "meter.h"

typedef struct {
    double tolerance, absolute; /* of a step, as in docs/adaptive.md */
    double most;                /* attempts of an object, as the mean of the sample */
} fp3_meter_control;

typedef struct {
    double
        worst; /* error as of fp3_meter_read; infinite: also if an object does not reach its end */
    double
        attempts; /* of an object from the start to the end of the span, accepted or not: the mean */
    int is_out; /* not run to the end: it takes more than the most attempts, or no program takes the tolerance */
} fp3_meter_found;

/* compiled: of an adapted model like that of the sample, for FP3_METER_CONFIG. */
fp3_status fp3_meter_adaptive(fp3_meter *meter, const fp3_sample *sample,
                              const fp3_compiled *compiled, const fp3_meter_control *control,
                              fp3_meter_found *found, fp3_error *error);

#endif
