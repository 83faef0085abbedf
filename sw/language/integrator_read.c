/* SPDX-License-Identifier: Apache-2.0 */
/* read.c - an integrator from its table, and what is wrong with the table. */
#include <fp3/model.h>

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "base/settings.h"
#include "chebyshev.h"
#include "conditions.h"
#include "embedded.h"

#define DAMPING_MOST 10.0 /* more takes most of the stability away */

typedef struct {
    fp3_settings in;
    fp3_integrator *table;
} reader;

static const char *const kind_names[] = {"runge-kutta", "splitting", "stoermer", "rosenbrock",
                                         "chebyshev"};
enum { KINDS = sizeof kind_names / sizeof *kind_names };

#define KIND(kind) (1u << (kind))
#define EVERY_KIND (KIND(KINDS) - 1)
static const struct {
    const char *key;
    unsigned kinds; /* a set: those that have the key */
} keys[] = {
    {"name", EVERY_KIND},
    {"doc", EVERY_KIND},
    {"source", EVERY_KIND},
    {"kind", EVERY_KIND},
    {"order", EVERY_KIND},
    {"late_position", KIND(FP3_RUNGE_KUTTA)},
    {"A", KIND(FP3_RUNGE_KUTTA) | KIND(FP3_ROSENBROCK)},
    {"b", KIND(FP3_RUNGE_KUTTA) | KIND(FP3_ROSENBROCK)},
    {"gamma", KIND(FP3_ROSENBROCK)},
    {"G", KIND(FP3_ROSENBROCK)},
    {"embedded", KIND(FP3_RUNGE_KUTTA) | KIND(FP3_ROSENBROCK)},
    {"embedded_order", KIND(FP3_RUNGE_KUTTA) | KIND(FP3_ROSENBROCK)},
    {"substeps", KIND(FP3_SPLITTING)},
    {"stages", KIND(FP3_CHEBYSHEV)},
    {"damping", KIND(FP3_CHEBYSHEV)},
};
enum { KEYS = sizeof keys / sizeof *keys };

static fp3_status read_text(const reader *r, const char *key, const char **text) {
    const config_setting_t *setting = fp3_setting_need(&r->in, key);
    return setting ? fp3_setting_text(&r->in, setting, key, text) : FP3_E_PROGRAM;
}

static fp3_status read_name(const reader *r) {
    const char *text = NULL;
    const fp3_status status = read_text(r, "name", &text);
    if (status)
        return status;
    if (!fp3_name_valid(text))
        return fp3_setting_wrong(&r->in, fp3_setting_need(&r->in, "name"),
                                 "name: found '%s', expected a name", text);
    strcpy(r->table->name, text);
    return FP3_OK;
}

static fp3_status read_string(const reader *r, const char *key, char **copy) {
    const char *text = NULL;
    const fp3_status status = read_text(r, key, &text);
    if (status)
        return status;
    *copy = strdup(text);
    return *copy ? FP3_OK : fp3_no_memory(r->in.error);
}

static fp3_status read_kind(const reader *r) {
    const char *text = NULL;
    const fp3_status status = read_text(r, "kind", &text);
    if (status)
        return status;
    for (unsigned i = 0; i < KINDS; i++)
        if (strcmp(text, kind_names[i]) == 0) {
            r->table->kind = (fp3_integrator_kind)i;
            return FP3_OK;
        }
    return fp3_setting_wrong(&r->in, fp3_setting_need(&r->in, "kind"),
                             "kind: found '%s', expected %s, %s, %s, %s or %s", text, kind_names[0],
                             kind_names[1], kind_names[2], kind_names[3], kind_names[4]);
}

static fp3_status read_order(const reader *r) {
    const config_setting_t *setting = fp3_setting_need(&r->in, "order");
    if (!setting)
        return FP3_E_PROGRAM;
    uint64_t order = 0;
    const fp3_status status =
        fp3_setting_count(&r->in, setting, "order", 1, FP3_TREE_ORDER, &order);
    r->table->order = (unsigned)order;
    return status;
}

/* The key is optional. */
static fp3_status read_late(const reader *r) {
    const config_setting_t *setting = config_setting_get_member(r->in.root, "late_position");
    return setting ? fp3_setting_flag(&r->in, setting, "late_position", &r->table->is_position_late)
                   : FP3_OK;
}

/* ---- tables ---------------------------------------------------------------------------------- */

/* A list of 1 .. FP3_STAGES_MAX members; its length is the number of stages. */
static fp3_status read_list(const reader *r, const char *key, const char *what,
                            const config_setting_t **list) {
    *list = fp3_setting_need(&r->in, key);
    if (!*list)
        return FP3_E_PROGRAM;
    if (!fp3_setting_is_list(*list))
        return fp3_setting_expected(&r->in, *list, key, "a list ( )");
    const int length = config_setting_length(*list);
    if (length < 1 || length > FP3_STAGES_MAX)
        return fp3_setting_wrong(&r->in, *list, "%s: found %d %s, expected 1 to %d", key, length,
                                 what, FP3_STAGES_MAX);
    r->table->stages = (unsigned)length;
    return FP3_OK;
}

/* A number, or a formula in a text. */
static fp3_status read_coefficient(const reader *r, const config_setting_t *setting,
                                   const char *what, double *number) {
    const char *formula = config_setting_get_string(setting);
    fp3_error why;
    const fp3_status status = formula ? fp3_constant_read(formula, number, &why) : FP3_OK;
    if (status)
        return status == FP3_E_SYSTEM
                   ? fp3_fail(r->in.error, status, "%s", why.text)
                   : fp3_setting_wrong(&r->in, setting, "%s: %s", what, why.text);
    if (!formula && !fp3_setting_is_number(setting))
        return fp3_setting_expected(&r->in, setting, what, "a number or a text like \"1/6\"");
    return formula ? FP3_OK : fp3_setting_number(&r->in, setting, what, number);
}

/* A row has the numbers below the diagonal, or all of a square matrix. */
static fp3_status read_row(const reader *r, const config_setting_t *row, const char *key,
                           unsigned i, double *numbers) {
    const unsigned stages = r->table->stages;
    char name[32];
    snprintf(name, sizeof name, "%s[%u]", key, i + 1);
    if (!fp3_setting_is_list(row))
        return fp3_setting_expected(&r->in, row, name, "a list ( )");
    const unsigned length = (unsigned)config_setting_length(row);
    if (length != i && length != stages)
        return fp3_setting_wrong(
            &r->in, row, "%s: found the length %u, expected %u (below the diagonal) or %u (all)",
            name, length, i, stages);
    fp3_status status = FP3_OK;
    for (unsigned j = 0; j < length && !status; j++) {
        const config_setting_t *setting = config_setting_get_elem(row, j);
        char what[48];
        snprintf(what, sizeof what, "%s[%u]", name, j + 1);
        status = read_coefficient(r, setting, what, &numbers[j]);
        if (!status && j >= i && numbers[j] != 0)
            status = fp3_setting_wrong(
                &r->in, setting, "%s: found %g, expected 0 on and above the diagonal%s", what,
                numbers[j], r->table->kind == FP3_ROSENBROCK ? "" : " (explicit methods)");
    }
    return status;
}

/* A, and with its row sums c. */
static fp3_status read_matrix(const reader *r) {
    fp3_integrator *table = r->table;
    const config_setting_t *a = NULL;
    fp3_status status = read_list(r, "A", "rows", &a);
    for (unsigned i = 0; !status && i < table->stages; i++) {
        status = read_row(r, config_setting_get_elem(a, i), "A", i, table->a[i]);
        for (unsigned j = 0; j < table->stages; j++)
            table->c[i] += table->a[i][j];
    }
    return status;
}

/* `weights`, one for each row of A, which add up to 1. */
static fp3_status read_weights(const reader *r, const char *key, double *weights) {
    const config_setting_t *b = fp3_setting_need(&r->in, key);
    if (!b)
        return FP3_E_PROGRAM;
    if (!fp3_setting_is_list(b))
        return fp3_setting_expected(&r->in, b, key, "a list ( )");
    const unsigned length = (unsigned)config_setting_length(b);
    if (length != r->table->stages)
        return fp3_setting_wrong(&r->in, b,
                                 "%s: found the length %u, expected %u, one for each row of A", key,
                                 length, r->table->stages);
    fp3_status status = FP3_OK;
    double sum = 0;
    for (unsigned i = 0; i < length && !status; i++) {
        char what[32];
        snprintf(what, sizeof what, "%s[%u]", key, i + 1);
        status = read_coefficient(r, config_setting_get_elem(b, i), what, &weights[i]);
        sum += weights[i];
    }
    if (!status && !(fabs(sum - 1) <= FP3_CONDITION_TOLERANCE))
        status = fp3_setting_wrong(&r->in, b, "%s: found the sum %.12g, expected 1", key, sum);
    return status;
}

/* The keys are optional, but stand together. */
static fp3_status read_embedded(const reader *r) {
    fp3_integrator *table = r->table;
    const config_setting_t *order = config_setting_get_member(r->in.root, "embedded_order");
    uint64_t claimed = 0;
    if (!order && !config_setting_get_member(r->in.root, "embedded"))
        return FP3_OK;
    fp3_status status = read_weights(r, "embedded", table->embedded);
    if (!status && !(order = fp3_setting_need(&r->in, "embedded_order")))
        status = FP3_E_PROGRAM;
    if (!status)
        status = fp3_setting_count(&r->in, order, "embedded_order", 1, FP3_TREE_ORDER, &claimed);
    if (!status)
        fp3_embedded_find(table);
    if (!status && table->embedded_order < claimed)
        status =
            fp3_setting_wrong(&r->in, order, "embedded_order %u claimed: the weights have order %u",
                              (unsigned)claimed, table->embedded_order);
    if (!status && table->is_position_late)
        status =
            fp3_setting_wrong(&r->in, order, "embedded: a late position has no error estimate");
    return status;
}

static fp3_status read_runge_kutta(const reader *r) {
    fp3_status status = read_matrix(r);
    if (!status)
        status = read_weights(r, "b", r->table->b);
    if (!status)
        status = read_late(r);
    return status ? status : read_embedded(r);
}

/* The diagonal is one number, so that all stages have one matrix. */
static fp3_status read_gamma(const reader *r, double *gamma) {
    const config_setting_t *setting = fp3_setting_need(&r->in, "gamma");
    const fp3_status status =
        setting ? read_coefficient(r, setting, "gamma", gamma) : FP3_E_PROGRAM;
    return status || (*gamma > 0 && *gamma < 100)
               ? status
               : fp3_setting_wrong(&r->in, setting,
                                   "gamma: found %g, expected above 0 and below 100", *gamma);
}

static fp3_status read_rosenbrock(const reader *r) {
    fp3_integrator *table = r->table;
    double gamma = 0;
    fp3_status status = read_matrix(r);
    const config_setting_t *g = status ? NULL : fp3_setting_need(&r->in, "G");
    if (!status && !g)
        return FP3_E_PROGRAM;
    if (!status && (!fp3_setting_is_list(g) || config_setting_length(g) != (int)table->stages))
        status =
            fp3_setting_wrong(&r->in, g, "G: expected a list of %u rows, as A is", table->stages);
    for (unsigned i = 0; !status && i < table->stages; i++)
        status = read_row(r, config_setting_get_elem(g, i), "G", i, table->gamma[i]);
    if (!status)
        status = read_gamma(r, &gamma);
    for (unsigned i = 0; i < table->stages; i++)
        table->gamma[i][i] = gamma;
    if (!status)
        status = read_weights(r, "b", table->b);
    return status ? status : read_embedded(r);
}

static fp3_status read_chebyshev(const reader *r) {
    const config_setting_t *count = fp3_setting_need(&r->in, "stages");
    uint64_t stages = 0;
    double damping = 0;
    fp3_status status = !count ? FP3_E_PROGRAM
                               : fp3_setting_count(&r->in, count, "stages", FP3_CHEBYSHEV_LEAST,
                                                   FP3_CHEBYSHEV_MOST, &stages);
    const config_setting_t *setting = status ? NULL : fp3_setting_need(&r->in, "damping");
    if (!setting)
        return FP3_E_PROGRAM;
    status = read_coefficient(r, setting, "damping", &damping);
    if (!status && !(damping >= 0 && damping <= DAMPING_MOST))
        status = fp3_setting_wrong(&r->in, setting, "damping: found %g, expected 0 to %g", damping,
                                   DAMPING_MOST);
    if (!status)
        fp3_chebyshev_make(r->table, (unsigned)stages, damping);
    return status;
}

static fp3_status read_substep(const reader *r, const config_setting_t *setting, unsigned i) {
    fp3_substep *substep = &r->table->substeps[i];
    const config_setting_t *member =
        config_setting_is_group(setting) && config_setting_length(setting) == 1
            ? config_setting_get_elem(setting, 0)
            : NULL;
    const char *which = member ? config_setting_name(member) : "";
    char what[32];
    snprintf(what, sizeof what, "substeps[%u]", i + 1);
    substep->is_kick = strcmp(which, "kick") == 0;
    if (!substep->is_kick && strcmp(which, "drift") != 0)
        return fp3_setting_expected(&r->in, setting, what,
                                    "{ kick = number; } or { drift = number; }");
    return read_coefficient(r, member, what, &substep->coefficient);
}

static fp3_status read_splitting(const reader *r) {
    const config_setting_t *list = NULL;
    double sum[2] = {0, 0};
    fp3_status status = read_list(r, "substeps", "substeps", &list);
    for (unsigned i = 0; !status && i < r->table->stages; i++) {
        status = read_substep(r, config_setting_get_elem(list, i), i);
        sum[r->table->substeps[i].is_kick != 0] += r->table->substeps[i].coefficient;
    }
    for (int kick = 0; !status && kick < 2; kick++)
        if (!(fabs(sum[kick] - 1) <= FP3_CONDITION_TOLERANCE))
            status = fp3_setting_wrong(&r->in, list,
                                       "substeps: found the sum %.12g of all %s, expected 1",
                                       sum[kick], kick ? "kicks" : "drifts");
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

/* A table may claim a lower order than it has. Its doc then says so. */
static fp3_status claims_less(const reader *r, unsigned order) {
    fp3_integrator *table = r->table;
    char *doc = NULL;
    if (asprintf(&doc, "%s (the conditions of order %u hold, too)", table->doc, order) < 0)
        return fp3_no_memory(r->in.error);
    free(table->doc);
    table->doc = doc;
    return FP3_OK;
}

static fp3_status check_order(const reader *r) {
    const fp3_integrator *table = r->table;
    double worst = 0, next = 0;
    const unsigned order = fp3_integrator_order(table, &worst, &next);
    if (order > table->order)
        return claims_less(r, order);
    if (order == table->order)
        return FP3_OK;
    if (table->kind == FP3_STOERMER)
        return fp3_setting_wrong(&r->in, fp3_setting_need(&r->in, "order"),
                                 "order %u claimed: this method has order %u", table->order, order);
    fp3_condition conditions[FP3_TREE_ORDER + 1];
    fp3_conditions(table, conditions);
    const fp3_condition *broken = &conditions[order + 1];
    return fp3_setting_wrong(&r->in, fp3_setting_need(&r->in, "order"),
                             "order %u claimed: the condition of the tree %s%s is off by %.2g",
                             table->order, broken->tree,
                             table->kind != FP3_SPLITTING ? ""
                             : broken->is_kick            ? ", for velocities,"
                                                          : ", for positions,",
                             broken->residual);
}

/* Adaptive steps believe the estimate. */
static fp3_status check_estimate(const reader *r) {
    const fp3_integrator *table = r->table;
    const int is_weights = table->kind != FP3_CHEBYSHEV;
    const config_setting_t *of =
        config_setting_get_member(r->in.root, is_weights ? "embedded" : "stages");
    const char *what = is_weights ? "embedded" : "the estimate of the method";
    if (!table->embedded_order)
        return FP3_OK;
    if (!fp3_embedded_sees_rates(table))
        return fp3_setting_wrong(
            &r->in, of,
            "%s: found 0 as the error of y' = a y, whatever the step (b.%s^k.1 "
            "is the same by both methods for all k), expected another method",
            what, table->kind == FP3_ROSENBROCK ? "(A + G)" : "A");
    if (!fp3_embedded_sees_time(table))
        return fp3_setting_wrong(&r->in, of,
                                 "%s: found 0 as the error of y' = f(t), whatever the step (b.c^k "
                                 "is the same by both methods for all k), expected another method",
                                 what);
    return FP3_OK;
}

static fp3_status check_keys(const reader *r) {
    const char *names[KEYS + 1] = {NULL};
    for (unsigned k = 0; k < KEYS; k++)
        names[k] = keys[k].key;
    fp3_status status = fp3_setting_keys(&r->in, r->in.root, "an integrator", names);
    for (unsigned k = 0; !status && k < KEYS; k++) {
        const config_setting_t *setting = config_setting_get_member(r->in.root, keys[k].key);
        if (setting && !(keys[k].kinds & KIND(r->table->kind)))
            status = fp3_setting_wrong(&r->in, setting, "found '%s', which kind %s does not have",
                                       keys[k].key, kind_names[r->table->kind]);
    }
    return status;
}

static fp3_status read_table(const reader *r) {
    fp3_integrator *table = r->table;
    fp3_status status = read_kind(r);
    if (!status)
        status = check_keys(r);
    if (!status)
        status = read_name(r);
    if (!status)
        status = read_string(r, "doc", &table->doc);
    if (!status)
        status = read_string(r, "source", &table->source);
    if (!status)
        status = read_order(r);
    if (!status && table->kind == FP3_RUNGE_KUTTA)
        status = read_runge_kutta(r);
    if (!status && table->kind == FP3_SPLITTING)
        status = read_splitting(r);
    if (!status && table->kind == FP3_ROSENBROCK)
        status = read_rosenbrock(r);
    if (!status && table->kind == FP3_CHEBYSHEV)
        status = read_chebyshev(r);
    if (!status)
        status = check_order(r);
    if (!status)
        status = check_estimate(r);
    table->position_order = table->is_position_late ? 1 : table->order;
    return status;
}

void fp3_integrator_free(fp3_integrator **integrator) {
    if (!*integrator)
        return;
    free((*integrator)->doc);
    free((*integrator)->source);
    free(*integrator);
    *integrator = NULL;
}

fp3_status fp3_integrator_read(const char *text, const char *name, fp3_integrator **integrator,
                               fp3_error *error) {
    FP3_HOST;
    *integrator = NULL;
    fp3_integrator *table = calloc(1, sizeof *table);
    if (!table)
        return fp3_no_memory(error);
    reader r = {.table = table};
    fp3_status status = fp3_settings_read(text, strlen(text), name, FP3_E_PROGRAM, &r.in, error);
    if (!status)
        status = read_table(&r);
    fp3_settings_close(&r.in);
    if (status)
        fp3_integrator_free(&table);
    else
        *integrator = table;
    return status;
}
