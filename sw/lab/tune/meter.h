/* SPDX-License-Identifier: Apache-2.0 */
/* meter.h - how large the error of a program is on a sample. */
#ifndef FP3_TUNE_METER_H
#define FP3_TUNE_METER_H

#include "sample.h"

/* The configuration on which errors of another are measured: many_full, if that has the same bits,
 * else itself. */
const char *fp3_meter_config(const char *config);

typedef struct {
    const char *config; /* by fp3_meter_config */
    fp3_engine *engine; /* of `objects`; NULL at first */
    size_t objects;
    float *column; /* a number for each object */
    fp3_error why; /* where the engine tells */
} fp3_meter;

void fp3_meter_close(fp3_meter *meter);

/* How objects come from the start to the end of the span. */
typedef struct {
    uint64_t steps;             /* fixed ones; 0: adaptive ones ... */
    double tolerance, absolute; /* ... with these, as in docs/adaptive.md */
    double most; /* attempts of an object, as the mean of the sample: what takes more is not run to
                    the end */
    double maxstep; /* as of the candidate */
    int is_cut;     /* fixed ones that end at events, and with the span: then `most` counts, too */
} fp3_stepping;

typedef struct {
    double worst; /* the error as fp3/tune.h defines it; infinite: also if an object does not reach
                     its end */
    double made;  /* steps of an object, or attempts, accepted or not: the mean */
    int is_out; /* adaptive or cut: it takes more than the most attempts, or a number of the program
                   has no room in FP32 */
} fp3_meter_found;

/* compiled: for the meter's configuration; adaptive or cut: of the sample's model, adapted. */
fp3_status fp3_meter_read(fp3_meter *meter, const fp3_sample *sample, const fp3_compiled *compiled,
                          const fp3_stepping *how, fp3_meter_found *found, fp3_error *error);

/* h of so many steps. Rounded, they end a little beside the span; those that are cut end with it,
 * and h is long enough for that. */
float fp3_meter_h(const fp3_sample *sample, uint64_t steps, int is_cut);

#endif
