/* SPDX-License-Identifier: Apache-2.0 */
/* candidate.c - see candidate.h. */
#include "candidate.h"

#include "machine/config.h"
#include "meter.h"

#include <fp3/compile.h>
#include <math.h>
#include <string.h>

void fp3_candidate_free(fp3_candidate *c) {
    if (c->measured != c->timed)
        fp3_compiled_free(&c->measured);
    fp3_compiled_free(&c->timed);
    fp3_integrator_free(&c->integrator);
    fp3_model_free(&c->adapted);
    c->measured = NULL;
}

static fp3_status compile(const fp3_candidate *c, const fp3_model *model, const char *config,
                          fp3_compiled **compiled, fp3_error *error) {
    fp3_compile_def def = fp3_compile_default();
    def.config = config;
    def.arithmetic = c->arithmetic;
    return fp3_compile(model, c->integrator, &def, compiled, error);
}

/* What the numbers of adaptive steps are is told before each run. */
static fp3_status adapt(fp3_candidate *c, const fp3_model *model, fp3_error *error) {
    fp3_adaptive_def def = fp3_adaptive_default();
    if (c->is_cut)
        def.tolerance = 0;
    else
        def.maxstep = c->maxstep;
    fp3_status status = fp3_model_copy(model, &c->adapted, error);
    if (!status)
        status = fp3_model_adapt(c->adapted, &def, error);
    if (!status && c->is_adaptive && c->maxstep == 0 &&
        fp3_model_param(c->adapted, "maxstep") != FP3_NONE)
        status = fp3_fail(error, FP3_E_PROGRAM,
                          "conditions in t change at times that are not known before the run: "
                          "adaptive steps need --set maxstep=...");
    return status;
}

fp3_status fp3_candidate_compile(fp3_candidate *c, const fp3_model *model, const char *config,
                                 fp3_error *error) {
    const int is_adapted = c->is_adaptive || c->is_cut;
    fp3_status status = is_adapted ? adapt(c, model, error) : FP3_OK;
    if (is_adapted)
        model = c->adapted;
    if (!status)
        status = compile(c, model, config, &c->timed, error);
    if (status || strcmp(config, fp3_meter_config(config)) == 0) {
        c->measured = c->timed;
        return status;
    }
    return compile(c, model, fp3_meter_config(config), &c->measured, error);
}

double fp3_candidate_cycles(const fp3_candidate *c, const char *config, double steps) {
    const fp3_config *machine = fp3_config_find(config);
    const double objects = machine->contexts * machine->lanes, whole = floor(steps);
    const double cycles = (double)fp3_compiled_cycles(c->timed, (uint64_t)whole);
    if (steps == whole)
        return cycles / objects;
    const double more = (double)fp3_compiled_cycles(c->timed, (uint64_t)whole + 1);
    return (cycles + (steps - whole) * (more - cycles)) / objects;
}
