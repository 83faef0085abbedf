/* SPDX-License-Identifier: Apache-2.0 */
/* compile.c - runs the passes; their schedule becomes an image, and a text for people. */
#include <fp3/compile.h>

#include <fp3/isa.h>
#include <machine/operation.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/definition.h"
#include "base/host.h"
#include "compiled.h"
#include "compiler/integrate/integrate.h"
#include "compiler/schedule/cost.h"
#include "compiler/schedule/schedule.h"
#include "emit.h"
#include "image.h"
#include "inputs.h"
#include "savings.h"

void fp3_compile_set_default(fp3_compile_def *def, size_t size) {
    if (!fp3_definition_begin(def, size, sizeof *def))
        return;
    def->config = "single_full";
    def->passes = fp3_passes_that(0);
}

/* ---- the program ---- */

static fp3_status write_program(fp3_compilation *k, const char *integrator, fp3_compiled *made,
                                fp3_error *error) {
    const fp3_title title = {.integrator = integrator, .order = k->p.fit.order};
    fp3_status status = fp3_names_make(&k->p.step, &k->p.code, k->p.schedule, &k->names, error);
    if (!status)
        status = fp3_compiler_image(&k->p.step, &k->p.code, k->p.schedule, &k->names, &made->image,
                                    error);
    if (!status)
        status = fp3_emit(&k->p.step, &k->p.code, k->p.schedule, &k->names, &k->options, &title,
                          &made->assembly, error);
    return status;
}

static void fill(const fp3_compilation *k, fp3_compiled *made) {
    const fp3_schedule *s = k->p.schedule;
    made->operations = k->p.code.operations;
    made->instructions = s->step_count;
    made->registers = s->registers;
    made->constants = s->constants;
    made->ahead = s->ahead;
    made->copies = s->copies;
    made->spills = s->spills;
    made->cycles = s->cycles;
    made->bound = s->bound;
    made->bound_issue = s->bound_issue;
    made->bound_path = s->bound_path;
    made->passes = k->options.passes;
    made->order = k->p.fit.order;
    made->arithmetic = k->options.arithmetic;
    const fp3_step *step = &k->p.step;
    made->looks = step->looks;
    made->phases = step->phases;
    memcpy(made->phase, step->phase, sizeof made->phase);
    made->compares = step->compares;
    memcpy(made->behind, step->behind, sizeof made->behind);
    if (!step->coupling)
        return;
    made->shows = step->is_still ? step->coupling->looked : step->shown;
    for (uint32_t i = 0; step->is_still && i < FP3_PLACES; i++)
        if (made->shows & ~made->looks & UINT64_C(1) << i)
            made->phase[i] = step->coupling->phase[i];
}

/* The model, with an expression for each param that others read. */
static fp3_status extend(fp3_compilation *k, const fp3_model **model, fp3_error *error) {
    const fp3_model *from = *model;
    uint64_t missing = k->coupling.params;
    uint32_t count = from->expr_count;
    for (uint32_t i = 0; i < count; i++)
        missing &= from->exprs[i].op == FP3_EXPR_PARAM ? ~(UINT64_C(1) << from->exprs[i].index)
                                                       : UINT64_MAX;
    if (!missing)
        return FP3_OK;
    k->seen = *from;
    k->seen.exprs = k->seen_exprs = calloc(count + from->param_count, sizeof *k->seen_exprs);
    if (!k->seen_exprs)
        return fp3_no_memory(error);
    memcpy(k->seen_exprs, from->exprs, count * sizeof *k->seen_exprs);
    for (uint32_t p = 0; p < from->param_count; p++)
        if (missing >> p & 1)
            k->seen_exprs[count++] = (fp3_expr){.op = FP3_EXPR_PARAM,
                                                .operand = {FP3_NONE, FP3_NONE, FP3_NONE},
                                                .index = p,
                                                .line = from->params[p].line,
                                                .column = 1,
                                                .is_known = 1};
    k->seen.expr_count = count;
    *model = &k->seen;
    return FP3_OK;
}

/* ---- all of it ---- */

static unsigned asked(const fp3_compile_def *def) {
    return def->passes | fp3_arithmetic_of(def->arithmetic)->passes;
}

/* The step that the equations mean: no pass that keeps the bits, except that dead states stay dead,
 * and a coefficient 0 has no term. */
static fp3_status make_reference(fp3_compilation *k, const fp3_model *model,
                                 const fp3_integrator *integrator, unsigned passes,
                                 fp3_error *error) {
    fp3_fit fit;
    fp3_options options = k->options;
    options.passes =
        (passes & (fp3_passes_that(1) | FP3_PASS(FP3_PASS_DEAD))) | FP3_PASS(FP3_PASS_ZERO);
    options.has_notes = 0;
    static const fp3_coupling together = {.is_common = 1};
    options.coupling = k->coupling.is_common ? &together : NULL;
    fp3_status status = fp3_fit_find(model, integrator, &options, &fit, error);
    if (!status)
        status = fp3_integrate(model, integrator, &options, &fit, &k->reference, error);
    return status;
}

static int has_carried(const fp3_step *step) {
    int has = 0;
    for (uint32_t i = 0; i < step->variable_count; i++)
        has |= step->variables[i].role == ROLE_CARRIED;
    return has;
}

/* A value that is carried from step to step needs a register all the way: a program that does not
 * fit with such values may fit if each step computes them again, with the same bits. */
static fp3_status run_pipeline(fp3_compilation *k, const fp3_model *model,
                               const fp3_integrator *integrator, fp3_error *error) {
    const fp3_status status = fp3_pipeline_run(&k->p, model, integrator, &k->options, error);
    fp3_options without = k->options;
    without.passes &= ~FP3_PASS(FP3_PASS_CARRY);
    if (status != FP3_E_LIMIT || !has_carried(&k->p.step))
        return status;
    const int lacked = k->p.lacks_registers;
    fp3_error why;
    fp3_pipeline_close(&k->p);
    if (!fp3_pipeline_run(&k->p, model, integrator, &without, &why)) {
        k->options = without;
        return FP3_OK;
    }
    if (error && lacked && k->p.lacks_registers)
        *error = why; /* it needs fewer */
    k->p.lacks_registers |= lacked;
    return status;
}

/* If even that does not fit, values spill into the object's record, with carried values or without,
 * whichever takes fewer instructions. The error is the caller's, unless the words are now too few.
 */
static fp3_status run_spilling(fp3_compilation *k, const fp3_model *model,
                               const fp3_integrator *integrator, fp3_error *error) {
    fp3_options options[2] = {k->options, k->options};
    fp3_pipeline p[2];
    fp3_error why[2];
    fp3_status status[2];
    options[1].passes &= ~FP3_PASS(FP3_PASS_CARRY);
    for (int i = 0; i < 2; i++) {
        options[i].may_spill = 1;
        status[i] = fp3_pipeline_run(&p[i], model, integrator, &options[i], &why[i]);
    }
    const int is_fewer =
        !status[1] && !status[0] && p[1].schedule->step_count < p[0].schedule->step_count;
    const int best = is_fewer || (status[0] && !status[1]);
    fp3_pipeline_close(&p[!best]);
    if (status[best]) {
        fp3_pipeline_close(&p[best]);
        if (error && status[1] != FP3_E_LIMIT)
            *error = why[1];
        return FP3_E_LIMIT;
    }
    fp3_pipeline_close(&k->p);
    k->p = p[best];
    k->options = options[best];
    return FP3_OK;
}

/* Elimination multiplies by reciprocals of pivots. If subnormal numbers are flushed, the
 * reciprocals of large pivots are 0, without a flag. */
static fp3_status warn_flushed(const fp3_config *config, fp3_compiled *made, fp3_error *error) {
    static const char text[] = "configuration '%s' flushes numbers below 2^-126 to 0: a derivative "
                               "of the equations that is 2^126 or more counts as infinite";
    char *fit = made->warning, *all = NULL, own[256];
    snprintf(own, sizeof own, text, config->name);
    if (asprintf(&all, "%s%s%s", fit ? fit : "", fit ? "; " : "", own) < 0)
        return fp3_no_memory(error);
    free(fit);
    made->warning = all;
    return FP3_OK;
}

static fp3_status compile(fp3_compilation *k, const fp3_model *model,
                          const fp3_integrator *integrator, const fp3_compile_def *def,
                          fp3_compiled *made, fp3_error *error) {
    fp3_status status =
        fp3_options_observe(model, def->observed, def->observed_count, &k->options.observed, error);
    const int has_partial = integrator->kind == FP3_ROSENBROCK;
    k->options.observed |= k->coupling.seen;
    if (!status)
        status = extend(k, &model, error);
    if (!status && (has_partial || model->event_count)) {
        status = fp3_differentiate(model, has_partial, &k->differentiated, error);
        model = &k->differentiated.model;
        k->options.partial = has_partial ? k->differentiated.partial : NULL;
        k->options.rate = k->differentiated.rate;
    }
    if (!status)
        status = run_pipeline(k, model, integrator, error);
    if (status == FP3_E_LIMIT && k->p.lacks_registers && k->options.config->interleave)
        status = run_spilling(k, model, integrator, error);
    if (!status)
        status = make_reference(k, model, integrator, asked(def), error);
    if (status)
        return status;
    fill(k, made);
    status = fp3_fit_warn(&k->p.fit, model, integrator, &made->warning, error);
    if (!status)
        status = write_program(k, integrator->name, made, error);
    if (!status)
        status = fp3_inputs_make(&k->p.step, &k->p.code, &k->names, &made->inputs,
                                 &made->input_count, error);
    if (!status && integrator->kind == FP3_ROSENBROCK && !k->options.config->subnormal)
        status = warn_flushed(k->options.config, made, error);
    if (!status && def->finds_savings)
        fp3_savings(&k->p, integrator, &k->options, made->saved);
    return status;
}

fp3_status fp3_compile(const fp3_model *model, const fp3_integrator *integrator,
                       const fp3_compile_def *def, fp3_compiled **compiled, fp3_error *error) {
    FP3_HOST;
    *compiled = NULL;
    const fp3_config *config = NULL;
    fp3_status status = fp3_definition_check(def, sizeof *def, "fp3_compile_def", error);
    if (!status)
        status = fp3_config_choose(def->config, &config, error);
    if (status)
        return status;
    fp3_compiled *made = calloc(1, sizeof *made);
    fp3_compilation *k = calloc(1, sizeof *k);
    if (!made || !k) {
        free(made);
        free(k);
        return fp3_no_memory(error);
    }
    k->config = *config;
    if (def->is_for_host)
        k->config.program_words = FP3_IMAGE_CODE_LIMIT;
    k->options = (fp3_options){.config = &k->config,
                               .passes = fp3_options_usable(asked(def), config),
                               .arithmetic = def->arithmetic,
                               .has_notes = 1};
    if (def->coupling) {
        k->coupling = *def->coupling;
        k->options.coupling = &k->coupling;
    }
    made->self = k;
    status = compile(k, model, integrator, def, made, error);
    if (status == FP3_E_LIMIT)
        status = FP3_E_PROGRAM; /* what is too large for a machine is a wrong program for it */
    if (status)
        fp3_compiled_free(&made);
    *compiled = made;
    return status;
}

void fp3_compiled_free(fp3_compiled **compiled) {
    fp3_compiled *made = *compiled;
    if (!made)
        return;
    fp3_compilation *k = made->self;
    fp3_pipeline_close(&k->p);
    fp3_step_close(&k->reference);
    fp3_differentiated_close(&k->differentiated);
    fp3_names_close(&k->names);
    free(k->seen_exprs);
    free(k);
    fp3_image_free(&made->image);
    free(made->assembly);
    free(made->warning);
    fp3_inputs_free(made->inputs, made->input_count);
    free(made);
    *compiled = NULL;
}

int fp3_compiled_low(const fp3_compiled *compiled, uint32_t state) {
    for (uint32_t i = 0; i < compiled->input_count; i++)
        if (compiled->inputs[i].low_of == state && state != FP3_NONE)
            return (int)fp3_image_find(compiled->image, compiled->inputs[i].name,
                                       FP3_CLASS(FP3_SYMBOL_STATE))
                ->index;
    return -1;
}

uint64_t fp3_compiled_cycles(const fp3_compiled *compiled, uint64_t steps) {
    const fp3_compilation *k = compiled->self;
    return fp3_cost_cycles(k->p.schedule, k->options.config, steps);
}
