/* SPDX-License-Identifier: Apache-2.0 */
/* tune_machines.h - fp3 tune --arithmetic: the same for configurations that compute in other ways,
 * and the one that costs least. */
#ifndef FP3_CLI_TUNE_MACHINES_H
#define FP3_CLI_TUNE_MACHINES_H

#include "lab/tune/placed.h"

#include <fp3/tune.h>
#include <jansson.h>

#define FP3_TUNE_MACHINES_MOST 32

typedef struct {
    const char *config;
    const fp3_placed *hardware; /* NULL: not known; only if it is the one machine */
    fp3_tuning *tuning;         /* NULL: it is left out ... */
    fp3_error why;              /* ... and this is why */
    double cost; /* LUT ns of an object over the span; infinite: the tolerance is not met */
} fp3_tune_machine;

typedef struct {
    fp3_tune_machine list[FP3_TUNE_MACHINES_MOST];
    size_t count, best; /* best: the first one, if none meets the tolerance */
} fp3_tune_machines;

/* The configuration alone, or with others: asked are names, or "all". FP3_E_ARGUMENT: there is no
 * such configuration, it computes as the first one, or a figure of it is not known. */
fp3_status fp3_tune_machines_find(fp3_tune_machines *machines, const char *config,
                                  const char *const *asked, size_t count, fp3_error *error);
/* Tunes for each; def->config becomes that of the best. One that cannot run the model, or keep the
 * tolerance by its bits, is left out, unless it is the first. */
fp3_status fp3_tune_machines_tune(fp3_tune_machines *machines, fp3_tune_def *def, fp3_error *error);
void fp3_tune_machines_free(fp3_tune_machines *machines);

/* What each came to, and why the best one is that; nothing, if there is one. */
void fp3_tune_machines_print(const fp3_tune_machines *machines);
json_t *fp3_tune_machines_json(const fp3_tune_machines *machines);

#endif
