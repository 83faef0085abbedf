/* SPDX-License-Identifier: Apache-2.0 */
/* pipeline.c - passes, and the choice among ways to chain products. */
#include "pipeline.h"

#include "carry.h"
#include "compiler/code/check.h"
#include "compiler/integrate/integrate.h"
#include "compiler/pairs/double_step.h"
#include "compiler/phases/phases.h"
#include "compiler/schedule/schedule.h"
#include "rest.h"

/* Fewer cycles are better, then fewer instructions. */
static int is_better(const fp3_schedule *one, const fp3_schedule *other) {
    if (one->cycles != other->cycles)
        return one->cycles < other->cycles;
    return one->step_count < other->step_count;
}

static fp3_status try_policy(fp3_pipeline *p, const fp3_options *options, chain_policy policy,
                             fp3_chain_nodes chain, fp3_error *error) {
    const fp3_config *config = options->config;
    conversion c;
    fp3_schedule *schedule = NULL;
    fp3_status status = fp3_convert(&p->step, options, policy, chain, &c, error);
    p->lacks_constants |= !status && c.code.constant_count > config->registers;
    if (!status) /* before an order of too many is searched for */
        status = fp3_check_code(&p->step, &c.code, config, error);
    if (!status && p->schedule && c.code.step_count >= p->schedule->cycles) {
        fp3_convert_close(&c); /* no order of this many can be better */
        return FP3_OK;
    }
    const int has_words = !status;
    if (!status)
        status = fp3_schedule_make(&c.code, config, &schedule, error);
    if (!status)
        status = fp3_check_schedule(&c.code, schedule, config, error);
    if (!status && (!p->schedule || is_better(schedule, p->schedule))) {
        fp3_schedule_free(&p->schedule);
        fp3_convert_close(&p->code);
        p->schedule = schedule;
        p->code = c;
        return FP3_OK;
    }
    p->lacks_registers |= has_words && status == FP3_E_LIMIT;
    fp3_schedule_free(&schedule);
    fp3_convert_close(&c);
    return status;
}

/* If contexts hide latency, every product that can be chained is. With one object, takes the best
 * of several ways. */
static fp3_status try_policies(fp3_pipeline *p, const fp3_options *options, fp3_error *error) {
    static const chain_policy order[] = {CHAIN_ALL, CHAIN_EARLY, CHAIN_SLACK, CHAIN_LONG,
                                         CHAIN_NONE};
    const int is_choice = !options->config->interleave && fp3_has_pass(options, FP3_PASS_CHAIN);
    fp3_chain_nodes chain = {FP3_NONE, FP3_NONE};
    fp3_status first = FP3_OK;
    if (is_choice || options->config->dual) {
        chain.one = fp3_dag_number(&p->step.values, 1);
        chain.minus_zero = fp3_dag_number(&p->step.values, -0.0);
    }
    for (size_t i = 0; i < (is_choice ? sizeof order / sizeof *order : 1); i++) {
        fp3_error why;
        const fp3_status status = try_policy(p, options, order[i], chain, &why);
        if (status && !first) {
            first = status;
            if (error)
                *error = why;
        }
    }
    return p->schedule ? FP3_OK : first;
}

/* Whether registers that params have might save cycles. */
static int is_tight(const fp3_pipeline *p, const fp3_config *config, fp3_status status) {
    const fp3_schedule *s = p->schedule;
    return status == FP3_E_LIMIT || (!status && p->code.code.param_count && s->cycles > s->bound &&
                                     s->registers == config->registers);
}

/* With one object a param is the same for all objects, so it can be a constant if registers run
 * short. If constants run short, they become params. In `dual`, copies between banks come from
 * constants. */
static fp3_status schedule(fp3_pipeline *p, const fp3_options *options, fp3_error *error) {
    fp3_options shared = *options, few = *options;
    shared.shares_params = 1;
    few.has_few_constants = 1;
    const fp3_status status = try_policies(p, options, error);
    if (status && p->lacks_constants && !options->config->dual)
        return try_policies(p, &few, error);
    return options->config->interleave || !is_tight(p, options->config, status)
               ? status
               : try_policies(p, &shared, error);
}

fp3_status fp3_pipeline_run(fp3_pipeline *p, const fp3_model *model,
                            const fp3_integrator *integrator, const fp3_options *options,
                            fp3_error *error) {
    *p = (fp3_pipeline){0};
    fp3_status status = fp3_fit_find(model, integrator, options, &p->fit, error);
    if (!status)
        status = fp3_double_check(options, error);
    if (!status)
        status = fp3_check_arithmetic(options, &p->fit, error);
    if (!status)
        status = fp3_phases_check(model, integrator, options, error);
    if (status)
        return status;
    status = fp3_integrate(model, integrator, options, &p->fit, &p->step, error);
    p->step.words = fp3_config_words(options->config);
    if (!status && fp3_phases_are_needed(&p->step))
        return fp3_phases_make(&p->step, options, &p->code, &p->schedule, error);
    if (!status && fp3_has_pass(options, FP3_PASS_CARRY))
        status = fp3_carry(&p->step, error);
    if (!status)
        status = schedule(p, options, error);
    return status ? status : fp3_rest(&p->step, &p->code, options->config, p->schedule, error);
}

void fp3_pipeline_close(fp3_pipeline *p) {
    fp3_step_close(&p->step);
    fp3_convert_close(&p->code);
    fp3_schedule_free(&p->schedule);
}
