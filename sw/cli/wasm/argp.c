/* SPDX-License-Identifier: Apache-2.0 */
/* argp.c - see include/argp.h. */
#include <argp.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OPTIONS_MOST 64
enum { KEY_HELP = 0x2000000, KEY_USAGE, KEY_VERSION }; /* behind all keys of a command */

const char *argp_program_version;
int argp_err_exit_status = 64;

static void print_options(const struct argp *argp) {
    for (const struct argp_option *o = argp->options; o && o->name; o++) {
        char names[80];
        snprintf(names, sizeof names, "%c%c%c --%s%s%s", o->key < 256 ? '-' : ' ',
                 o->key < 256 ? o->key : ' ', o->key < 256 ? ',' : ' ', o->name, o->arg ? "=" : "",
                 o->arg ? o->arg : "");
        printf("  %-32s %s\n", names, o->doc);
    }
}

static void print_usage(const struct argp *argp, const char *command, FILE *to) {
    const char *line = argp->args_doc ? argp->args_doc : "";
    for (const char *before = "Usage:"; before; before = *line ? "  or: " : NULL) {
        const size_t length = strcspn(line, "\n");
        fprintf(to, "%s %s [OPTION...] %.*s\n", before, command, (int)length, line);
        line += length + (line[length] == '\n');
    }
}

static _Noreturn void help(const struct argp *argp, const char *command) {
    const size_t before = strcspn(argp->doc, "\v");
    print_usage(argp, command, stdout);
    printf("%.*s\n\n", (int)before, argp->doc);
    print_options(argp);
    if (argp->doc[before])
        printf("\n%s\n", argp->doc + before + 1);
    exit(0);
}

static _Noreturn void fail(const char *command) {
    fprintf(stderr, "Try `%s --help' or `%s --usage' for more information.\n", command, command);
    exit(argp_err_exit_status);
}

void argp_usage(const struct argp_state *state) { fail(state->argv[0]); }

void argp_error(const struct argp_state *state, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "%s: ", state->argv[0]);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    fail(state->argv[0]);
}

void argp_failure(const struct argp_state *state, int status, int number, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "%s: ", state->argv[0]);
    vfprintf(stderr, format, arguments);
    fprintf(stderr, number ? ": %s\n" : "\n", strerror(number));
    va_end(arguments);
    exit(status);
}

/* For getopt_long: the table, and the letters with a colon behind those that have a value. */
typedef struct {
    struct option longs[OPTIONS_MOST + 4];
    char shorts[3 * OPTIONS_MOST];
} forms;

static void add_option(forms *f, size_t i, const struct argp_option *o) {
    const int has = !o->arg ? 0 : o->flags & OPTION_ARG_OPTIONAL ? 2 : 1;
    f->longs[i] = (struct option){o->name, has, NULL, o->key};
    if (o->key < 256) {
        const char letter[] = {(char)o->key, has ? ':' : '\0', has == 2 ? ':' : '\0', '\0'};
        strcat(f->shorts, letter);
    }
}

static void list_forms(const struct argp *argp, int is_in_order, forms *f) {
    size_t count = 0;
    *f = (forms){.shorts = ""};
    strcpy(f->shorts, is_in_order ? "+" : "-"); /* -: other words are options of key 1 */
    for (const struct argp_option *o = argp->options; o && o->name && count < OPTIONS_MOST; o++)
        add_option(f, count++, o);
    f->longs[count++] = (struct option){"help", 0, NULL, KEY_HELP};
    f->longs[count++] = (struct option){"usage", 0, NULL, KEY_USAGE};
    f->longs[count++] = (struct option){"version", 0, NULL, KEY_VERSION};
    strcat(f->shorts, "?V");
}

static error_t take(const struct argp *argp, int key, char *text, struct argp_state *state) {
    switch (key) {
    case KEY_HELP:
        help(argp, state->argv[0]);
    case KEY_USAGE:
        print_usage(argp, state->argv[0], stdout);
        exit(0);
    case KEY_VERSION:
    case 'V':
        puts(argp_program_version);
        exit(0);
    case '?':
        fail(state->argv[0]);
    default:
        return argp->parser(key == 1 ? ARGP_KEY_ARG : key, text, state);
    }
}

/* Keys without a handler are no error unless they are options. */
static error_t tell(const struct argp *argp, int key, struct argp_state *state) {
    const error_t status = argp->parser(key, NULL, state);
    return status == ARGP_ERR_UNKNOWN ? 0 : status;
}

error_t argp_parse(const struct argp *argp, int argc, char **argv, unsigned flags, int *index,
                   void *input) {
    struct argp_state state = {.argc = argc, .argv = argv, .input = input};
    forms f;
    int key, words = 0;
    error_t status = 0;
    (void)index;
    list_forms(argp, (flags & ARGP_IN_ORDER) != 0, &f);
    optind = 0; /* from the beginning, whatever was read before */
    while (!status && (key = getopt_long(argc, argv, f.shorts, f.longs, NULL)) != -1) {
        words += key == 1;
        status = take(argp, key, optarg, &state);
    }
    state.next = optind;
    while (!status && state.next < argc) {
        char *word = argv[state.next++];
        words++;
        status = argp->parser(ARGP_KEY_ARG, word, &state);
    }
    if (!status && !words)
        status = tell(argp, ARGP_KEY_NO_ARGS, &state);
    return status ? status : tell(argp, ARGP_KEY_END, &state);
}
