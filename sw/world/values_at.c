/* SPDX-License-Identifier: Apache-2.0 */
/* values_at.c - what a value is for an object: its number, or what its formula makes of others. */
#include "values.h"

#include "values_own.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "base/number.h"
#include "language/formula.h"

#define FORMULA_DEPTH 64 /* of values that are made of each other */

size_t fp3_params_count(const fp3_params *params) { return params->count; }

int fp3_params_has(const fp3_params *params, const char *name) {
    return fp3_values_find(params, name) != NULL;
}

int fp3_values_look(const fp3_params *params, size_t number, fp3_value_look *look) {
    if (number >= params->count)
        return 0;
    const fp3_value *v = &params->list[number];
    *look = (fp3_value_look){v->name, v->formula,   v->value,
                             v->last, v->is_spread, v->column ? v->count : 0};
    return 1;
}

/* Of an object, 0 for the first and 1 for the last. */
static double number_at(const fp3_value *v, double share) {
    if (v->column) /* the share is that of a whole number */
        return v->column[(size_t)(share * (double)(v->count - 1) + 0.5)];
    return v->is_spread ? (1 - share) * v->value + share * v->last : v->value;
}

/* Asks for values that are made of others. */
typedef struct {
    const fp3_params *params;
    double share;
    unsigned words;
    int is_spread;
    unsigned depth;
} asking;

static fp3_status ask(asking *a, const char *name, double *number, fp3_error *error);

static fp3_status value_of(void *user, const char *name, double *number, fp3_error *error) {
    if (!fp3_values_find(((asking *)user)->params, name))
        return fp3_fail(error, FP3_E_PROGRAM, "'%s' has no value", name);
    const fp3_status status = ask(user, name, number, error);
    *number = fp3_number_given(*number, ((asking *)user)->words);
    return status;
}

/* A number that is given besides a formula is the same FP32 number. */
static fp3_status check_agreement(const asking *a, const fp3_value *v, double computed,
                                  fp3_error *error) {
    const double given = number_at(v, a->share);
    if (!v->has_number || (float)given == (float)computed)
        return FP3_OK;
    return fp3_value_wrong(a->params, v->name, error,
                           "'%s' is %.9g, but it is %s, which is %.9g: leave it out", v->name,
                           given, v->formula, computed);
}

/* "h = 0.125, m = 2", if the formula depends on facts (language/formula.h) that do not hold now;
 * else NULL. */
static char *facts_that_held(asking *a, const fp3_formula *formula) {
    fp3_fact *facts = NULL;
    const size_t count = formula ? fp3_formula_facts(formula, &facts) : 0;
    char *text = NULL;
    size_t size;
    int is_another = 0;
    FILE *out = count ? open_memstream(&text, &size) : NULL;
    for (size_t i = 0; out && i < count; i++) {
        double now = facts[i].is;
        fp3_error why;
        value_of(a, facts[i].name, &now, &why);
        is_another |= now != fp3_number_given(facts[i].is, a->words);
        fprintf(out, "%s%s = %.9g", i ? ", " : "", facts[i].name, facts[i].is);
    }
    free(facts);
    if (out && !fclose(out) && is_another)
        return text;
    free(text);
    return NULL;
}

/* A formula without a value. */
static fp3_status refuse(asking *a, const fp3_value *v, const fp3_error *why, fp3_error *error) {
    char *held = facts_that_held(a, v->parsed);
    const fp3_status status =
        held ? fp3_value_wrong(a->params, v->name, error, "'%s' was computed for %s: compile again",
                               v->name, held)
             : fp3_value_wrong(a->params, v->name, error, "'%s' is %s: %s", v->name, v->formula,
                               why->text);
    free(held);
    return status;
}

static fp3_status compute(asking *a, const fp3_value *v, double *number, fp3_error *error) {
    fp3_error why;
    if (a->depth == FORMULA_DEPTH)
        return fp3_value_wrong(a->params, v->name, error,
                               "'%s' is computed from itself, or from too many other values",
                               v->name);
    a->depth++;
    fp3_formula *none;
    fp3_status status = v->parsed ? fp3_formula_value(v->parsed, value_of, a, number, &why)
                                  : fp3_formula_read(v->formula, &none, &why);
    a->depth--;
    if (status == FP3_E_PROGRAM)
        return refuse(a, v, &why, error);
    if (status)
        return fp3_fail(error, status, "%s", why.text);
    return check_agreement(a, v, *number, error);
}

static fp3_status ask(asking *a, const char *name, double *number, fp3_error *error) {
    const fp3_value *v = fp3_values_find(a->params, name);
    if (!v)
        return fp3_value_wrong(a->params, name, error, "'%s' has no value", name);
    a->is_spread |= v->is_spread;
    if (v->formula)
        return compute(a, v, number, error);
    *number = number_at(v, a->share);
    return FP3_OK;
}

unsigned fp3_values_words(const fp3_image *image) {
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        const fp3_symbol *state = &image->symbols[i];
        char low[FP3_NAME_SIZE + sizeof "_low"];
        snprintf(low, sizeof low, "%s_low", state->name);
        if (state->symbol_class == FP3_SYMBOL_STATE &&
            fp3_image_find(image, low, FP3_CLASS(FP3_SYMBOL_STATE)))
            return 2;
    }
    return 1;
}

fp3_status fp3_values_at(const fp3_params *params, const char *name, double share, unsigned words,
                         double *number, int *is_spread, fp3_error *error) {
    asking a = {.params = params, .share = share, .words = words};
    double found = 0;
    fp3_status status = ask(&a, name, &found, error);
    if (status)
        return status;
    *number = found;
    *is_spread = a.is_spread;
    return FP3_OK;
}

fp3_status fp3_params_get(const fp3_params *params, const char *name, double *number,
                          fp3_error *error) {
    FP3_HOST;
    int is_spread;
    return fp3_values_at(params, name, 0, 1, number, &is_spread, error);
}

/* A formula that cannot be read counts as depending on everything; its error is reported when its
 * value is needed. */
static int is_made_of(const fp3_value *v, const char *name) {
    return v->formula && (!v->parsed || fp3_formula_mentions(v->parsed, name));
}

/* Marks what a used value is made of; whether there was any. */
static int mark(const fp3_params *params, char *is_used) {
    int is_any = 0;
    for (size_t i = 0; i < params->count; i++)
        for (size_t j = 0; is_used[i] && j < params->count; j++)
            if (!is_used[j] && is_made_of(&params->list[i], params->list[j].name))
                is_used[j] = 1, is_any = 1;
    return is_any;
}

fp3_status fp3_values_check(const fp3_params *params, fp3_values_has_fn *has, const void *of,
                            fp3_error *error) {
    char *is_used = calloc(params->count + 1, 1);
    if (!is_used)
        return fp3_no_memory(error);
    for (size_t i = 0; i < params->count; i++)
        is_used[i] = (char)(has(of, params->list[i].name) != 0);
    while (mark(params, is_used))
        continue;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < params->count; i++)
        if (!is_used[i])
            status = fp3_value_wrong(params, params->list[i].name, error, "the program has no '%s'",
                                     params->list[i].name);
    free(is_used);
    return status;
}
