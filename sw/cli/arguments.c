/* SPDX-License-Identifier: Apache-2.0 */
/* arguments.c - see arguments.h. */
#include "arguments.h"

#include "base/nearest.h"

#include <errno.h>
#include <fp3/model.h>
#include <fp3/program.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TABLE_MOST = 64 };

/* What argp adds to every table. */
static const char *const everywhere[] = {"help", "usage", "version"};
enum { EVERYWHERE = sizeof everywhere / sizeof *everywhere };

typedef struct {
    const fp3_option *table;
    const char *command;
    int given[TABLE_MOST];
} arguments;

/* ---- finding ---- */

/* Whether a name is the beginning of one that argp adds. */
static int is_everywhere(const char *name, size_t length) {
    for (size_t i = 0; i < EVERYWHERE; i++)
        if (!strncmp(everywhere[i], name, length))
            return 1;
    return 0;
}

/* By its name, or the beginning of it. *count: how many begin so. */
static int find_long(const arguments *a, const char *name, size_t length, int *count) {
    int found = -1;
    *count = is_everywhere(name, length);
    for (int i = 0; a->table[i].name; i++) {
        if (strncmp(a->table[i].name, name, length) != 0)
            continue;
        ++*count;
        found = i;
        if (strlen(a->table[i].name) == length) {
            *count = 1;
            break;
        }
    }
    return found;
}

static int find_short(const arguments *a, char key) {
    for (int i = 0; a->table[i].name; i++)
        if (a->table[i].letter == key)
            return i;
    return -1;
}

/* ---- refusing ---- */

static void usage(const arguments *a) {
    fprintf(stderr, "Try '%s --help' for more information.\n", a->command);
    exit(argp_err_exit_status);
}

static void refuse_unknown(const arguments *a, const char *name, size_t length) {
    const fp3_token wanted = {.text = name, .length = length, .kind = FP3_TOKEN_NAME};
    const char *best = NULL;
    for (int i = 0; a->table[i].name; i++)
        fp3_nearest(wanted, a->table[i].name, &best);
    for (size_t i = 0; i < EVERYWHERE; i++)
        fp3_nearest(wanted, everywhere[i], &best);
    fprintf(stderr, "%s: there is no option --%.*s", a->command, (int)length, name);
    fprintf(stderr, best ? "; did you mean --%s?\n" : "\n", best);
    usage(a);
}

/* ---- what a line says ---- */

typedef struct {
    arguments all;
    int argc, at;
    char *const *argv;
    fp3_argument_fn *tell;
    void *user;
    fp3_error *error;
    int is_argp_next; /* argp reads the line, too, and refuses the rest of what is wrong */
} reader;

/* attached: what stands in the same word; NULL: nothing. */
static fp3_status tell(reader *r, int option, const char *attached) {
    const fp3_option *o = &r->all.table[option];
    if (attached && !o->value && !r->is_argp_next)
        return fp3_fail(r->error, FP3_E_ARGUMENT, "--%s: found a value, expected none", o->name);
    if (o->value && !attached && !o->is_optional) {
        if (r->at + 1 == r->argc)
            return r->is_argp_next
                       ? FP3_OK
                       : fp3_fail(r->error, FP3_E_ARGUMENT, "--%s: expected a value", o->name);
        attached = r->argv[++r->at];
    }
    return r->tell(r->user, o, attached, r->error);
}

static fp3_status tell_long(reader *r, const char *text) {
    const size_t length = strcspn(text, "=");
    int count;
    const int option = find_long(&r->all, text, length, &count);
    if (count == 0 && r->is_argp_next)
        refuse_unknown(&r->all, text, length);
    if (option < 0 || count != 1)
        return r->is_argp_next ? FP3_OK
                               : fp3_fail(r->error, FP3_E_ARGUMENT,
                                          "--%.*s: no option of %s, or of several the beginning",
                                          length < 100 ? (int)length : 100, text, r->all.command);
    return tell(r, option, text[length] ? &text[length + 1] : NULL);
}

static fp3_status tell_short(reader *r, const char *text) {
    fp3_status status = FP3_OK;
    for (; !status && *text; text++) {
        const int option = find_short(&r->all, *text);
        if (option < 0)
            return r->is_argp_next ? FP3_OK
                                   : fp3_fail(r->error, FP3_E_ARGUMENT, "-%c: no option of %s",
                                              *text, r->all.command);
        if (r->all.table[option].value)
            return tell(r, option, text[1] ? &text[1] : NULL);
        status = tell(r, option, NULL);
    }
    return status;
}

static fp3_status each(reader *r) {
    fp3_status status = FP3_OK;
    int is_over = 0; /* after "--" */
    for (r->at = 1; !status && r->at < r->argc; r->at++) {
        const char *word = r->argv[r->at];
        if (!is_over && !strcmp(word, "--"))
            is_over = 1;
        else if (is_over || word[0] != '-' || !word[1])
            status = r->tell(r->user, NULL, word, r->error);
        else
            status = word[1] == '-' ? tell_long(r, word + 2) : tell_short(r, word + 1);
    }
    return status;
}

fp3_status fp3_arguments_each(const fp3_option *table, int argc, char *const *argv,
                              fp3_argument_fn *tell, void *user, fp3_error *error) {
    reader r = {.all = {.table = table, .command = argv[0]},
                .argc = argc,
                .argv = argv,
                .tell = tell,
                .user = user,
                .error = error};
    return each(&r);
}

/* An fp3_argument_fn: ends at an option with a value that is given twice. */
static fp3_status note(void *user, const fp3_option *o, const char *value, fp3_error *error) {
    arguments *a = user;
    (void)value;
    (void)error;
    if (!o || !o->value || o->is_repeated || !a->given[o - a->table]++)
        return FP3_OK;
    fprintf(stderr, "%s: --%s is given twice\n", a->command, o->name);
    usage(a);
    return FP3_OK;
}

/* ---- taking ---- */

enum { KEY_FIRST = 256 }; /* argp's keys: letters, and from here on places in the table */

typedef struct {
    const fp3_command *command;
    void *options;
} taker;

/* In Hz, of a number above 0 and a unit, as 130MHz; ends with 2 and a message if it is none. */
static double frequency(struct argp_state *state, const char *option, const char *text) {
    static const struct {
        const char *name;
        double hertz;
    } units[] = {{"Hz", 1}, {"kHz", 1e3}, {"MHz", 1e6}, {"GHz", 1e9}};
    char *unit;
    const double number = strtod(text, &unit);
    const int is_decimal = strspn(text, "0123456789.eE+-") >= (size_t)(unit - text);
    while (*unit == ' ')
        unit++;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (!strcmp(unit, units[i].name) && is_decimal && number > 0 &&
            isnormal(number * units[i].hertz))
            return number * units[i].hertz;
    argp_error(state, "%s: '%s' is no frequency: expected a number above 0 and Hz, kHz, MHz or GHz",
               option, text);
    return 0;
}

static void take(const taker *t, const fp3_option *o, char *text, struct argp_state *state) {
    char *const to = (char *)t->options + o->at;
    char name[64];
    snprintf(name, sizeof name, "--%s", o->name);
    switch (o->kind) {
    case FP3_OPTION_CALL:
        o->take(t->options, state, text);
        break;
    case FP3_OPTION_FLAG:
        *(int *)(void *)to = 1;
        break;
    case FP3_OPTION_TEXT:
        *(const char **)(void *)to = text;
        break;
    case FP3_OPTION_LIST: {
        unsigned *const count = (unsigned *)(void *)((char *)t->options + o->count);
        if (*count == o->most)
            argp_error(state, "%s: found more than %" PRIu64, name, o->most);
        ((const char **)(void *)to)[(*count)++] = text;
        break;
    }
    case FP3_OPTION_NUMBER: {
        const uint64_t number = fp3_arguments_number(state, name, text, o->least, o->most);
        if (o->size == sizeof number)
            *(uint64_t *)(void *)to = number;
        else
            *(uint32_t *)(void *)to = (uint32_t)number;
        break;
    }
    case FP3_OPTION_ABOVE_ZERO:
        *(double *)(void *)to = fp3_arguments_above_zero(state, name, text);
        break;
    case FP3_OPTION_FREQUENCY:
        *(double *)(void *)to = frequency(state, name, text);
        break;
    }
}

/* NULL: the key is none of the table's. */
static const fp3_option *option_of(const fp3_option *table, int key) {
    if (key >= KEY_FIRST)
        return key < KEY_FIRST + TABLE_MOST ? &table[key - KEY_FIRST] : NULL;
    for (; key && table && table->name; table++)
        if (table->letter == key)
            return table;
    return NULL;
}

static void take_word(const taker *t, const char *text, struct argp_state *state) {
    const char **const to = (const char **)(void *)((char *)t->options + t->command->at);
    if (*to)
        argp_error(state, "found '%s', expected one %s", text, t->command->one);
    *to = text;
}

static error_t parse(int key, char *text, struct argp_state *state) {
    const taker *t = state->input;
    const fp3_command *c = t->command;
    const fp3_option *o = option_of(c->options, key);
    if (key == ARGP_KEY_ARG && c->take) {
        c->take(t->options, state, text);
    } else if (key == ARGP_KEY_ARG && c->one) {
        take_word(t, text, state);
    } else if (key == ARGP_KEY_END) {
        if (c->end)
            c->end(t->options, state);
    } else if (!o) {
        return ARGP_ERR_UNKNOWN;
    } else {
        if (c->given)
            c->given(t->options, o);
        take(t, o, text, state);
    }
    return 0;
}

void fp3_arguments_parse(const fp3_command *command, int argc, char **argv, void *options) {
    static const fp3_option none[] = {{0}};
    arguments a = {.table = command->options ? command->options : none, .command = argv[0]};
    reader r = {.all = a, .argc = argc, .argv = argv, .tell = note, .user = &a, .is_argp_next = 1};
    struct argp_option list[TABLE_MOST + 1] = {{0}};
    const struct argp argp = {
        .options = list, .parser = parse, .args_doc = command->forms, .doc = command->doc};
    for (int i = 0; a.table[i].name; i++) {
        const fp3_option *o = &a.table[i];
        list[i] = (struct argp_option){o->name,  o->letter ? o->letter : KEY_FIRST + i,
                                       o->value, o->is_optional ? OPTION_ARG_OPTIONAL : 0,
                                       o->doc,   0};
    }
    each(&r);
    if (argp_parse(&argp, argc, argv, 0, NULL, &(taker){command, options}))
        exit(argp_err_exit_status);
}

uint64_t fp3_arguments_number(struct argp_state *state, const char *option, const char *text,
                              uint64_t least, uint64_t most) {
    char *end;
    errno = 0;
    const uint64_t value = strtoull(text, &end, 10);
    if (errno || end == text || *end || *text < '0' || *text > '9' || value < least || value > most)
        argp_error(state, "%s: '%s' is no number from %" PRIu64 " to %" PRIu64, option, text, least,
                   most);
    return value;
}

double fp3_arguments_above_zero(struct argp_state *state, const char *option, const char *text) {
    double value = 0;
    fp3_error error;
    if (fp3_constant_read(text, &value, &error))
        argp_error(state, "%s: '%s' is no number: %s", option, text, error.text);
    if (!(value > 0 && isfinite(value)))
        argp_error(state, "%s: found '%s', expected a number above 0", option, text);
    return value;
}

void fp3_arguments_model(struct argp_state *state, const char *path, int is_model) {
    if (path && !is_model && fp3_program_is_named(path) && !fp3_program_is_model(path))
        argp_error(state, "found '%s', expected a model (*.ode, or --model)", path);
}

/* ---- arithmetic ---- */

void fp3_arguments_arithmetic(struct argp_state *state, fp3_compile_def *def,
                              fp3_arithmetic arithmetic) {
    const fp3_arithmetic before = def->arithmetic;
    if (before != FP3_PLAIN && before != arithmetic)
        argp_error(state, "found both --%s and --%s, expected one arithmetic",
                   fp3_arithmetic_of(before < arithmetic ? before : arithmetic)->text,
                   fp3_arithmetic_of(before < arithmetic ? arithmetic : before)->text);
    def->arithmetic = arithmetic;
}

fp3_arithmetic fp3_arguments_arithmetic_named(struct argp_state *state, const char *name) {
    char all[160] = "";
    const fp3_arithmetic found = fp3_arithmetic_find(name);
    for (int i = 0; i < FP3_ARITHMETICS; i++) {
        strcat(all, i == 0 ? "" : i + 1 < FP3_ARITHMETICS ? ", " : " or ");
        strcat(all, fp3_arithmetic_of((fp3_arithmetic)i)->name);
    }
    if (found == FP3_ARITHMETICS)
        argp_error(state, "found '%s', expected %s", name, all);
    return found;
}
