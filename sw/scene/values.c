/* values.c - values by name: from files, from name=value, for an object. */
#include "values.h"

#include <fp3/image.h>
#include <fp3/model.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "language/formula.h"
#include "text/number.h"

#define FORMULA_SIZE 65536
#define FORMULA_DEPTH 64 /* of values that are made of each other */

/* Where a value was set. */
typedef struct {
    const char *path; /* one of the files of the params; NULL: nowhere */
    unsigned line;
} place;

typedef struct {
    char name[FP3_NAME_SIZE];
    char *formula;       /* what it is computed from, or NULL */
    fp3_formula *parsed; /* NULL, too, of a formula that cannot be read */
    int has_number;      /* given besides a formula, which must agree; always without one */
    double value, last;  /* of the first object and, if that is another one, of the last */
    int is_spread;
    place at;
} value;

typedef struct file {
    struct file *next;
    char path[];
} file;

struct fp3_params {
    value *list;
    size_t count;
    file *files;
    place at; /* of values that have none */
};

fp3_status fp3_params_make(fp3_params **params, fp3_error *error) {
    *params = calloc(1, sizeof **params);
    return *params ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
}

/* ---- places ---- */

/* Keeps the path, and points at.path to what is kept. */
static fp3_status keep_path(fp3_params *params, place *at, fp3_error *error) {
    for (const file *f = params->files; at->path && f; f = f->next)
        if (strcmp(f->path, at->path) == 0) {
            at->path = f->path;
            return FP3_OK;
        }
    if (!at->path)
        return FP3_OK;
    file *made = malloc(sizeof *made + strlen(at->path) + 1);
    if (!made)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    made->next = params->files;
    params->files = made;
    at->path = strcpy(made->path, at->path);
    return FP3_OK;
}

fp3_status fp3_values_place(fp3_params *params, const char *path, unsigned line, fp3_error *error) {
    params->at = (place){path, line};
    return keep_path(params, &params->at, error);
}

static value *find(const fp3_params *params, const char *name) {
    for (size_t i = 0; i < params->count; i++)
        if (strcmp(params->list[i].name, name) == 0)
            return &params->list[i];
    return NULL;
}

fp3_status fp3_value_wrong(const fp3_params *params, const char *name, fp3_error *error,
                           const char *format, ...) {
    char text[400];
    const value *param = find(params, name);
    const place at = param && param->at.path ? param->at : params->at;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return at.path ? fp3_fail_at(error, FP3_E_ARGUMENT, at.path, at.line, 0, "%s", text)
                   : fp3_fail(error, FP3_E_ARGUMENT, "%s", text);
}

/* ---- making ---- */

static fp3_status parse(value *v, fp3_error *error) {
    fp3_error why;
    const fp3_status status = v->formula ? fp3_formula_read(v->formula, &v->parsed, &why) : FP3_OK;
    return status == FP3_E_SYSTEM ? fp3_fail(error, status, "%s", why.text) : FP3_OK;
}

static void free_formula(value *v) {
    free(v->formula);
    fp3_formula_free(&v->parsed);
}

static fp3_status copy_into(const fp3_params *from, fp3_params *to, fp3_error *error) {
    fp3_status status = fp3_values_place(to, from->at.path, from->at.line, error);
    to->list = malloc((from->count + 1) * sizeof *to->list);
    if (!to->list)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (; !status && to->count < from->count; to->count++) {
        value *v = &to->list[to->count];
        *v = from->list[to->count];
        v->parsed = NULL;
        if (v->formula && !(v->formula = strdup(v->formula)))
            return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
        status = parse(v, error);
        if (!status)
            status = keep_path(to, &v->at, error);
    }
    return status;
}

fp3_status fp3_params_copy(const fp3_params *from, fp3_params **params, fp3_error *error) {
    fp3_status status = fp3_params_make(params, error);
    if (!status)
        status = copy_into(from, *params, error);
    if (status)
        fp3_params_free(params);
    return status;
}

void fp3_params_free(fp3_params **params) {
    fp3_params *p = *params;
    while (p && p->files) {
        file *next = p->files->next;
        free(p->files);
        p->files = next;
    }
    for (size_t i = 0; p && i < p->count; i++)
        free_formula(&p->list[i]);
    if (p)
        free(p->list);
    free(p);
    *params = NULL;
}

/* ---- putting ---- */

/* Adds or replaces, by this name; but a number does not replace a formula. Takes what.formula, except where it
 * fails. */
static fp3_status put_value(fp3_params *params, const char *name, value what, fp3_error *error) {
    value *param = find(params, name);
    if (!param) {
        value *list = realloc(params->list, (params->count + 1) * sizeof *list);
        if (!list)
            return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
        params->list = list;
        param = &list[params->count++];
        *param = (value){.formula = NULL};
    }
    strcpy(what.name, name);
    if (what.formula)
        free_formula(param);
    else {
        what.formula = param->formula;
        what.parsed = param->parsed;
    }
    *param = what;
    return FP3_OK;
}

static fp3_status put(fp3_params *params, const char *name, value what, fp3_error *error) {
    fp3_status status = fp3_name_valid(name)
                            ? parse(&what, error)
                            : fp3_fail(error, FP3_E_ARGUMENT, "'%s' is no name", name);
    if (!status)
        status = keep_path(params, &what.at, error);
    if (!status)
        status = put_value(params, name, what, error);
    if (status)
        free_formula(&what);
    return status;
}

fp3_status fp3_params_put(fp3_params *params, const char *name, double number, fp3_error *error) {
    return put(params, name, (value){.value = number, .has_number = 1}, error);
}

/* A number, or else a formula of numbers. */
static fp3_status read_number(const char *set, const char *text, double *number, fp3_error *error) {
    FP3_HOST;
    const char *expected = fp3_number_read(text, number);
    fp3_error why;
    const fp3_status status = expected ? fp3_constant_read(text, number, &why) : FP3_OK;
    if (!status || status == FP3_E_SYSTEM)
        return status ? fp3_fail(error, status, "'%s': %s", set, why.text) : FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT, "'%s': '%s' is no number: %s", set, text, why.text);
}

/* The name in front of the = of text, and what is behind it, or NULL. */
static const char *split(const char *text, char name[FP3_NAME_SIZE]) {
    const char *equals = strchr(text, '=');
    if (!equals || (size_t)(equals - text) >= FP3_NAME_SIZE)
        return NULL;
    memcpy(name, text, (size_t)(equals - text));
    name[equals - text] = '\0';
    return equals + 1;
}

fp3_status fp3_params_set(fp3_params *params, const char *text, fp3_error *error) {
    FP3_HOST;
    char name[FP3_NAME_SIZE];
    double number = 0;
    const char *is = split(text, name);
    if (!is)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is not name=value", text);
    fp3_status status = read_number(text, is, &number, error);
    return status ? status : fp3_params_put(params, name, number, error);
}

fp3_status fp3_params_spread(fp3_params *params, const char *text, fp3_error *error) {
    FP3_HOST;
    char name[FP3_NAME_SIZE];
    value pair = {.is_spread = 1};
    const char *first = split(text, name), *colon = first ? strchr(first, ':') : NULL;
    if (!colon)
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is not name=first:last", text);
    char *copy = strndup(first, (size_t)(colon - first));
    fp3_status status = copy ? read_number(text, copy, &pair.value, error)
                             : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    free(copy);
    if (!status)
        status = read_number(text, colon + 1, &pair.last, error);
    if (!status && !(isfinite(pair.value) && isfinite(pair.last)))
        status = fp3_fail(error, FP3_E_ARGUMENT, "'%s': found %g, expected finite numbers", text,
                          isfinite(pair.value) ? pair.last : pair.value);
    return status ? status : put(params, name, pair, error);
}

/* ---- files ---- */

/* The error with its place in front. */
static fp3_status put_from(fp3_params *params, const fp3_settings *s,
                           const config_setting_t *setting, value what) {
    fp3_error why;
    what.at = (place){s->name, fp3_setting_line(setting)};
    const fp3_status status = put(params, config_setting_name(setting), what, &why);
    if (status == FP3_E_ARGUMENT)
        return fp3_setting_wrong(s, setting, "%s", why.text);
    return status ? fp3_fail(s->error, status, "%s", why.text) : FP3_OK;
}

static fp3_status read_value(const fp3_settings *s, const config_setting_t *setting, value *what) {
    const char *name = config_setting_name(setting), *text = config_setting_get_string(setting);
    if (text && strlen(text) >= FORMULA_SIZE)
        return fp3_setting_expected(s, setting, name, "a number or a shorter formula");
    if (text) {
        what->formula = strdup(text);
        return what->formula ? FP3_OK : fp3_fail(s->error, FP3_E_SYSTEM, "out of memory");
    }
    what->has_number = 1;
    if (!fp3_setting_is_number(setting))
        return fp3_setting_expected(s, setting, name, "a number or a formula in quotes");
    return fp3_setting_number(s, setting, name, &what->value);
}

static fp3_status read_pair(const fp3_settings *s, const config_setting_t *setting, value *what) {
    const char *name = config_setting_name(setting);
    what->is_spread = what->has_number = 1;
    if (!fp3_setting_is_list(setting) || config_setting_length(setting) != 2)
        return fp3_setting_expected(s, setting, name, "a pair of numbers [FIRST, LAST]");
    fp3_status status =
        fp3_setting_number(s, config_setting_get_elem(setting, 0), name, &what->value);
    if (!status)
        status = fp3_setting_number(s, config_setting_get_elem(setting, 1), name, &what->last);
    return status;
}

typedef fp3_status read_fn(const fp3_settings *s, const config_setting_t *setting, value *what);

static fp3_status put_all(fp3_params *params, const fp3_settings *s, const config_setting_t *from,
                          read_fn *read_one) {
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < config_setting_length(from); i++) {
        const config_setting_t *setting = config_setting_get_elem(from, (unsigned)i);
        value what = {.value = 0};
        status = read_one(s, setting, &what);
        if (!status)
            status = put_from(params, s, setting, what);
    }
    return status;
}

fp3_status fp3_values_read(fp3_params *params, const fp3_settings *s,
                           const config_setting_t *from) {
    return put_all(params, s, from, read_value);
}

fp3_status fp3_values_spread(fp3_params *params, const fp3_settings *s,
                             const config_setting_t *from) {
    return put_all(params, s, from, read_pair);
}

fp3_status fp3_params_load(fp3_params *params, const char *path, fp3_error *error) {
    FP3_HOST;
    fp3_settings s;
    fp3_status status = fp3_settings_load(path, FP3_E_ARGUMENT, &s, error);
    if (!status)
        status = fp3_values_read(params, &s, s.root);
    fp3_settings_close(&s);
    return status;
}

/* ---- asking ---- */

size_t fp3_params_count(const fp3_params *params) { return params->count; }

int fp3_params_has(const fp3_params *params, const char *name) {
    return find(params, name) != NULL;
}

int fp3_values_look(const fp3_params *params, size_t number, fp3_value_look *look) {
    if (number >= params->count)
        return 0;
    const value *v = &params->list[number];
    *look = (fp3_value_look){v->name, v->formula, v->value, v->last, v->is_spread};
    return 1;
}

/* Of an object, 0 for the first and 1 for the last. */
static double number_at(const value *v, double share) {
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
    if (!find(((asking *)user)->params, name))
        return fp3_fail(error, FP3_E_PROGRAM, "'%s' has no value", name);
    const fp3_status status = ask(user, name, number, error);
    *number = fp3_number_given(*number, ((asking *)user)->words);
    return status;
}

/* A number that is given besides a formula is the same FP32 number. */
static fp3_status check_agreement(const asking *a, const value *v, double computed,
                                  fp3_error *error) {
    const double given = number_at(v, a->share);
    if (!v->has_number || (float)given == (float)computed)
        return FP3_OK;
    return fp3_value_wrong(a->params, v->name, error,
                           "parameter '%s' is %.9g, but it is %s, which is %.9g: leave it out",
                           v->name, given, v->formula, computed);
}

/* "h = 0.125, m = 2", if the formula is one of facts (language/formula.h) that do not hold now; else NULL. */
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
static fp3_status refuse(asking *a, const value *v, const fp3_error *why, fp3_error *error) {
    char *held = facts_that_held(a, v->parsed);
    const fp3_status status =
        held ? fp3_value_wrong(a->params, v->name, error,
                               "parameter '%s' was computed for %s: compile again", v->name, held)
             : fp3_value_wrong(a->params, v->name, error, "parameter '%s' is %s: %s", v->name,
                               v->formula, why->text);
    free(held);
    return status;
}

static fp3_status compute(asking *a, const value *v, double *number, fp3_error *error) {
    fp3_error why;
    if (a->depth == FORMULA_DEPTH)
        return fp3_value_wrong(a->params, v->name, error,
                               "parameter '%s' is made of itself, or of too many others", v->name);
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
    const value *v = find(a->params, name);
    if (!v)
        return fp3_value_wrong(a->params, name, error, "parameter '%s' has no value", name);
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

/* One that cannot be read counts as of everything: what is wrong with it is said when it is asked for. */
static int is_made_of(const value *v, const char *name) {
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
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (size_t i = 0; i < params->count; i++)
        is_used[i] = (char)(has(of, params->list[i].name) != 0);
    while (mark(params, is_used))
        continue;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < params->count; i++)
        if (!is_used[i])
            status = fp3_value_wrong(params, params->list[i].name, error,
                                     "the program has no parameter '%s'", params->list[i].name);
    free(is_used);
    return status;
}
