/* SPDX-License-Identifier: Apache-2.0 */
/* check.c - operations, constants and words against what a configuration has. */
#include "check.h"

#include "language/evaluate.h"
#include "machine/config.h"
#include "machine/operation.h"

#include <fp3/isa.h>
#include <inttypes.h>
#include <stdio.h>

/* Whether a sine or a cosine is among what the program computes: `small-angles` is for these. */
static int has_angles(const fp3_step *step) {
    for (uint32_t i = 0; i < step->model->expr_count; i++) {
        const fp3_expr *e = &step->model->exprs[i];
        if ((e->op == FP3_EXPR_SIN || e->op == FP3_EXPR_COS) && !e->is_known)
            return 1;
    }
    return 0;
}

/* "; 'single_full' has it": configurations for as many objects and with the same arithmetic, or "".
 */
static void say_who_has(const fp3_config *config, uint32_t op, char *text, size_t size) {
    size_t length = 0;
    text[0] = '\0';
    for (uint32_t i = 0; i < fp3_config_count; i++) {
        const fp3_config *other = &fp3_configs[i];
        if (other->interleave != config->interleave || !fp3_config_computes_as(config, other) ||
            fp3_operation_lacks(other, op) != FP3_KEY_NONE || length >= size)
            continue;
        length += (size_t)snprintf(text + length, size - length, "%s'%s'",
                                   length ? ", " : "; it is in ", other->name);
    }
}

/* `rint` reduces arguments: truncated, the rest would be twice as large as the range of the
 * polynomials. */
static fp3_status check_rounding(const fp3_config *config, uint32_t op, const fp3_noted *at,
                                 fp3_error *error) {
    if (op != FP3_OP_RINT || config->nearest)
        return FP3_OK;
    return fp3_fail_at(error, FP3_E_PROGRAM, NULL, at->line, at->column,
                       "%s needs rounding to nearest, and configuration '%s' truncates",
                       at->text ? at->text : "the model", config->name);
}

/* What something needs of a configuration's arithmetic. */
enum { FLOATS = 1, ALL_BITS = 2, IEEE = 4 };

static fp3_status need(const fp3_config *config, unsigned needs, const char *what,
                       fp3_error *error) {
    if (needs & FLOATS && config->logarithmic)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "%s needs sums whose rounding errors are floats, and configuration '%s' is "
                        "logarithmic",
                        what, config->name);
    if (needs & ALL_BITS && config->fraction < 23)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "%s counts on numbers of 24 bits, and configuration '%s' has %" PRIu32,
                        what, config->name, config->fraction + 1);
    if (needs & IEEE && !config->nearest)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "%s needs rounding to nearest, and configuration '%s' truncates", what,
                        config->name);
    if (needs & IEEE && !config->subnormal)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "%s needs subnormal numbers, and configuration '%s' flushes them", what,
                        config->name);
    return FP3_OK;
}

fp3_status fp3_check_arithmetic(const fp3_options *options, const fp3_fit *fit, fp3_error *error) {
    const struct {
        int is_asked;
        unsigned needs;
        const char *what;
    } list[] = {
        {options->arithmetic == FP3_COMPENSATED, FLOATS, "compensated arithmetic"},
        {options->arithmetic == FP3_DOUBLE_SINGLE, FLOATS | ALL_BITS | IEEE, "double-single"},
        {fp3_has_pass(options, FP3_PASS_EXACT_DIVISION), FLOATS | ALL_BITS | IEEE,
         "`exact-division`"},
        {fit->control != 0, FLOATS | ALL_BITS, "time in two words, as adaptive steps have it,"},
    };
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < sizeof list / sizeof *list; i++)
        if (list[i].is_asked)
            status = need(options->config, list[i].needs, list[i].what, error);
    return status;
}

/* Whether an operation is a function with constants, which are made for 24 bits. A power has
 * constants if it is computed by a logarithm. */
static int is_of_function(const fp3_model *model, uint32_t op, const fp3_noted *at) {
    const int is_of_power = op == FP3_OP_RINT || op == FP3_OP_EXP2 || op == FP3_OP_LOGB;
    for (uint32_t i = 0; at->line && i < model->expr_count; i++) {
        const fp3_expr *e = &model->exprs[i];
        if (e->line == at->line && e->column == at->column && !e->is_known &&
            fp3_ode_has_constants(e->op) && (e->op != FP3_EXPR_POWER || is_of_power))
            return 1;
    }
    return 0;
}

static fp3_status check_bits(const fp3_model *model, const fp3_config *config, uint32_t op,
                             const fp3_noted *at, fp3_error *error) {
    if (config->fraction == 23 || !is_of_function(model, op, at))
        return FP3_OK;
    return fp3_fail_at(error, FP3_E_PROGRAM, NULL, at->line, at->column,
                       "%s: its constants are made for numbers of 24 bits, and configuration '%s' "
                       "has %" PRIu32,
                       at->text, config->name, config->fraction + 1);
}

static fp3_status check_ops(const fp3_step *step, const fp3_op *ops, uint32_t count,
                            const fp3_config *config, fp3_error *error) {
    for (uint32_t i = 0; i < count; i++) {
        const fp3_noted at = fp3_note_at(&step->notes, ops[i].note);
        const fp3_key key = fp3_operation_lacks(config, ops[i].op);
        if (key != FP3_KEY_NONE) {
            char others[200];
            say_who_has(config, ops[i].op, others, sizeof others);
            return fp3_fail_at(error, FP3_E_PROGRAM, NULL, at.line, at.column,
                               "%s%sneeds `%s`, which configuration '%s' does not have%s%s",
                               at.text ? at.text : "the model", at.text ? ": " : " ",
                               fp3_key_name(key), config->name, others,
                               key == FP3_KEY_ROUND && has_angles(step)
                                   ? " (for angles up to pi/2 the pass `small-angles` does without)"
                                   : "");
        }
        fp3_status status = check_rounding(config, ops[i].op, &at, error);
        if (!status)
            status = check_bits(step->model, config, ops[i].op, &at, error);
        if (status)
            return status;
    }
    return FP3_OK;
}

/* The first part has no operation that the step part has not. */
fp3_status fp3_check_code(const fp3_step *step, const fp3_step_code *code, const fp3_config *config,
                          fp3_error *error) {
    fp3_needs needs = fp3_code_needs(code);
    needs.constants = 0; /* copies may need one more */
    fp3_status status = check_ops(step, code->step, code->step_count, config, error);
    if (!status)
        status = check_ops(step, code->last, code->last_count, config, error);
    return status ? status : fp3_needs_check(&needs, config, error);
}

fp3_status fp3_check_schedule(const fp3_step_code *code, const fp3_schedule *s,
                              const fp3_config *config, fp3_error *error) {
    fp3_needs needs = fp3_code_needs(code);
    needs.registers = s->registers;
    needs.constants = s->constants;
    needs.words = s->first_count + s->step_count + s->last_count + s->loads + s->stores;
    needs.is_visited = s->is_spilled || s->loads + s->stores > 0;
    return fp3_needs_check(&needs, config, error);
}
