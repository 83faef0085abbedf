/* integrator_read.c - a table in libconfig's syntax, and what is wrong with it. */
#include <fp3/integrator.h>
#include <fp3/model.h>

#include <libconfig.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "integrator_conditions.h"

typedef struct {
    const char *name; /* of the text */
    const config_setting_t *root;
    fp3_integrator *table;
    fp3_error *error;
} reader;

static const char *const kind_names[] = {"runge-kutta", "splitting", "stoermer"};
enum { KINDS = sizeof kind_names / sizeof *kind_names };

#define KIND(kind) (1u << (kind))
#define EVERY_KIND (KIND(KINDS) - 1)
static const struct {
    const char *key;
    unsigned kinds; /* that have it */
} keys[] = {
    {"name", EVERY_KIND},
    {"doc", EVERY_KIND},
    {"source", EVERY_KIND},
    {"kind", EVERY_KIND},
    {"order", EVERY_KIND},
    {"late_position", KIND(FP3_RUNGE_KUTTA)},
    {"A", KIND(FP3_RUNGE_KUTTA)},
    {"b", KIND(FP3_RUNGE_KUTTA)},
    {"substeps", KIND(FP3_SPLITTING)},
};
enum { KEYS = sizeof keys / sizeof *keys };

__attribute__((format(printf, 3, 4))) static fp3_status
wrong(const reader *r, const config_setting_t *at, const char *format, ...) {
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const unsigned line = config_setting_source_line(at);
    return fp3_fail(r->error, FP3_E_PROGRAM, "%s:%u: %s", r->name, line ? line : 1, text);
}

static const char *type_name(const config_setting_t *setting) {
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
    case CONFIG_TYPE_INT64:
        return "an integer";
    case CONFIG_TYPE_FLOAT:
        return "a number";
    case CONFIG_TYPE_STRING:
        return "a string";
    case CONFIG_TYPE_BOOL:
        return "true or false";
    case CONFIG_TYPE_GROUP:
        return "a group { }";
    default:
        return "a list ( )";
    }
}

static int is_list(const config_setting_t *setting) {
    return config_setting_is_list(setting) || config_setting_is_array(setting);
}

/* ---- single values --------------------------------------------------------------------------- */

/* The setting, or NULL with an error. */
static const config_setting_t *need(const reader *r, const char *key) {
    const config_setting_t *setting = config_setting_get_member(r->root, key);
    if (!setting)
        wrong(r, r->root, "found no '%s', expected one", key);
    return setting;
}

static fp3_status read_text(const reader *r, const char *key, const char **text) {
    const config_setting_t *setting = need(r, key);
    if (!setting)
        return FP3_E_PROGRAM;
    *text = config_setting_get_string(setting);
    return *text ? FP3_OK
                 : wrong(r, setting, "%s: found %s, expected a string", key, type_name(setting));
}

/* what names it in a message: "b[2]". */
static fp3_status read_number(const reader *r, const config_setting_t *setting, const char *what,
                              double *number) {
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
    case CONFIG_TYPE_INT64:
        *number = (double)config_setting_get_int64(setting);
        break;
    case CONFIG_TYPE_FLOAT:
        *number = config_setting_get_float(setting);
        break;
    case CONFIG_TYPE_STRING: {
        fp3_error why;
        if (fp3_constant_read(config_setting_get_string(setting), number, &why))
            return wrong(r, setting, "%s: %s", what, why.text);
        break;
    }
    default:
        return wrong(r, setting, "%s: found %s, expected a number or a string like \"1/6\"", what,
                     type_name(setting));
    }
    return isfinite(*number)
               ? FP3_OK
               : wrong(r, setting, "%s: found %g, expected a finite number", what, *number);
}

static fp3_status read_name(const reader *r) {
    const char *text = NULL;
    const fp3_status status = read_text(r, "name", &text);
    if (status)
        return status;
    if (!fp3_name_valid(text))
        return wrong(r, need(r, "name"), "name: found '%s', expected a name", text);
    strcpy(r->table->name, text);
    return FP3_OK;
}

static fp3_status read_string(const reader *r, const char *key, char **copy) {
    const char *text = NULL;
    const fp3_status status = read_text(r, key, &text);
    if (status)
        return status;
    *copy = strdup(text);
    return *copy ? FP3_OK : fp3_fail(r->error, FP3_E_SYSTEM, "out of memory");
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
    return wrong(r, need(r, "kind"), "kind: found '%s', expected %s, %s or %s", text, kind_names[0],
                 kind_names[1], kind_names[2]);
}

static fp3_status read_order(const reader *r) {
    const config_setting_t *setting = need(r, "order");
    if (!setting)
        return FP3_E_PROGRAM;
    if (config_setting_type(setting) != CONFIG_TYPE_INT)
        return wrong(r, setting, "order: found %s, expected an integer from 1 to %d",
                     type_name(setting), FP3_TREE_ORDER);
    const int order = config_setting_get_int(setting);
    if (order < 1 || order > FP3_TREE_ORDER)
        return wrong(r, setting, "order: found %d, expected an integer from 1 to %d", order,
                     FP3_TREE_ORDER);
    r->table->order = (unsigned)order;
    return FP3_OK;
}

/* Optional. */
static fp3_status read_late(const reader *r) {
    const config_setting_t *setting = config_setting_get_member(r->root, "late_position");
    if (!setting)
        return FP3_OK;
    if (config_setting_type(setting) != CONFIG_TYPE_BOOL)
        return wrong(r, setting, "late_position: found %s, expected true or false",
                     type_name(setting));
    r->table->is_position_late = config_setting_get_bool(setting);
    return FP3_OK;
}

/* ---- tables ---------------------------------------------------------------------------------- */

/* The length of a list of 1 .. FP3_STAGES_MAX members, into stages. */
static fp3_status read_list(const reader *r, const char *key, const char *what,
                            const config_setting_t **list) {
    *list = need(r, key);
    if (!*list)
        return FP3_E_PROGRAM;
    if (!is_list(*list))
        return wrong(r, *list, "%s: found %s, expected a list ( )", key, type_name(*list));
    const int length = config_setting_length(*list);
    if (length < 1 || length > FP3_STAGES_MAX)
        return wrong(r, *list, "%s: found %d %s, expected 1 to %d", key, length, what,
                     FP3_STAGES_MAX);
    r->table->stages = (unsigned)length;
    return FP3_OK;
}

/* A row has the numbers below the diagonal, or all of a square matrix. */
static fp3_status read_row(const reader *r, const config_setting_t *row, unsigned i) {
    fp3_integrator *table = r->table;
    if (!is_list(row))
        return wrong(r, row, "A[%u]: found %s, expected a list ( )", i + 1, type_name(row));
    const unsigned length = (unsigned)config_setting_length(row);
    if (length != i && length != table->stages)
        return wrong(r, row,
                     "A[%u]: found the length %u, expected %u (below the diagonal) or %u (all)",
                     i + 1, length, i, table->stages);
    fp3_status status = FP3_OK;
    for (unsigned j = 0; j < length && !status; j++) {
        const config_setting_t *setting = config_setting_get_elem(row, j);
        char what[32];
        snprintf(what, sizeof what, "A[%u][%u]", i + 1, j + 1);
        status = read_number(r, setting, what, &table->a[i][j]);
        if (!status && j >= i && table->a[i][j] != 0)
            status = wrong(r, setting,
                           "%s: found %g, expected 0 on and above the diagonal (explicit methods)",
                           what, table->a[i][j]);
        table->c[i] += table->a[i][j];
    }
    return status;
}

static fp3_status read_weights(const reader *r) {
    const config_setting_t *b = need(r, "b");
    if (!b)
        return FP3_E_PROGRAM;
    if (!is_list(b))
        return wrong(r, b, "b: found %s, expected a list ( )", type_name(b));
    const unsigned length = (unsigned)config_setting_length(b);
    if (length != r->table->stages)
        return wrong(r, b, "b: found the length %u, expected %u, one for each row of A", length,
                     r->table->stages);
    fp3_status status = FP3_OK;
    double sum = 0;
    for (unsigned i = 0; i < length && !status; i++) {
        char what[32];
        snprintf(what, sizeof what, "b[%u]", i + 1);
        status = read_number(r, config_setting_get_elem(b, i), what, &r->table->b[i]);
        sum += r->table->b[i];
    }
    if (!status && !(fabs(sum - 1) <= FP3_CONDITION_TOLERANCE))
        status = wrong(r, b, "b: found the sum %.12g, expected 1", sum);
    return status;
}

static fp3_status read_runge_kutta(const reader *r) {
    const config_setting_t *a = NULL;
    fp3_status status = read_list(r, "A", "rows", &a);
    for (unsigned i = 0; !status && i < r->table->stages; i++)
        status = read_row(r, config_setting_get_elem(a, i), i);
    if (!status)
        status = read_weights(r);
    return status ? status : read_late(r);
}

static fp3_status read_substep(const reader *r, const config_setting_t *setting, unsigned i) {
    fp3_substep *substep = &r->table->substeps[i];
    const config_setting_t *member =
        config_setting_is_group(setting) && config_setting_length(setting) == 1
            ? config_setting_get_elem(setting, 0)
            : NULL;
    const char *which = member ? config_setting_name(member) : "";
    substep->is_kick = strcmp(which, "kick") == 0;
    if (!substep->is_kick && strcmp(which, "drift") != 0)
        return wrong(r, setting,
                     "substeps[%u]: found %s%s, expected { kick = number; } or { drift = number; }",
                     i + 1, member ? which : type_name(setting),
                     member || !config_setting_is_group(setting) ? "" : " of several or none");
    char what[32];
    snprintf(what, sizeof what, "substeps[%u]", i + 1);
    return read_number(r, member, what, &substep->coefficient);
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
            status = wrong(r, list, "substeps: found the sum %.12g of all %s, expected 1",
                           sum[kick], kick ? "kicks" : "drifts");
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

/* A table may promise less than it has, and says so then. */
static fp3_status promise_less(const reader *r, unsigned order) {
    fp3_integrator *table = r->table;
    char *doc = NULL;
    if (asprintf(&doc, "%s (the conditions of order %u hold, too)", table->doc, order) < 0)
        return fp3_fail(r->error, FP3_E_SYSTEM, "out of memory");
    free(table->doc);
    table->doc = doc;
    return FP3_OK;
}

static fp3_status check_order(const reader *r) {
    const fp3_integrator *table = r->table;
    double worst = 0, next = 0;
    const unsigned order = fp3_integrator_order(table, &worst, &next);
    if (order > table->order)
        return promise_less(r, order);
    if (order == table->order)
        return FP3_OK;
    if (table->kind == FP3_STOERMER)
        return wrong(r, need(r, "order"), "order %u claimed: this method has order %u",
                     table->order, order);
    fp3_condition conditions[FP3_TREE_ORDER + 1];
    fp3_conditions(table, conditions);
    const fp3_condition *broken = &conditions[order + 1];
    return wrong(r, need(r, "order"),
                 "order %u claimed: the condition of the tree %s%s is off by %.2g", table->order,
                 broken->tree,
                 table->kind != FP3_SPLITTING ? ""
                 : broken->is_kick            ? ", for velocities,"
                                              : ", for positions,",
                 broken->residual);
}

static fp3_status check_keys(const reader *r) {
    for (int i = 0; i < config_setting_length(r->root); i++) {
        const config_setting_t *setting = config_setting_get_elem(r->root, (unsigned)i);
        const char *key = config_setting_name(setting);
        char known[128] = "";
        unsigned k = 0;
        while (k < KEYS && strcmp(key, keys[k].key) != 0)
            strcat(strcat(known, k ? ", " : ""), keys[k].key), k++;
        if (k == KEYS)
            return wrong(r, setting, "found '%s', expected one of %s", key, known);
        if (!(keys[k].kinds & KIND(r->table->kind)))
            return wrong(r, setting, "found '%s', which kind %s has not", key,
                         kind_names[r->table->kind]);
    }
    return FP3_OK;
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
    if (!status)
        status = check_order(r);
    table->position_order = table->is_position_late ? 1 : table->order;
    return status;
}

fp3_status fp3_integrator_read(const char *text, const char *name, fp3_integrator **integrator,
                               fp3_error *error) {
    *integrator = NULL;
    fp3_integrator *table = calloc(1, sizeof *table);
    if (!table)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    config_t config;
    config_init(&config);
    fp3_status status;
    if (!config_read_string(&config, text)) {
        status = fp3_fail(error, FP3_E_PROGRAM, "%s:%d: %s", name, config_error_line(&config),
                          config_error_text(&config));
    } else {
        const reader r = {name, config_root_setting(&config), table, error};
        status = read_table(&r);
    }
    config_destroy(&config);
    if (status)
        fp3_integrator_free(&table);
    else
        *integrator = table;
    return status;
}
