/* SPDX-License-Identifier: Apache-2.0 */
/* arguments.h - a command line, by argp, with what all commands have in common. */
#ifndef FP3_CLI_ARGUMENTS_H
#define FP3_CLI_ARGUMENTS_H

#include <argp.h>
#include <fp3/compile.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

/* ---- options as data ---- */

/* One that only a function takes. text: NULL if it has no value. It ends with 2 and a message, by
 * argp_error, if it refuses the value. */
typedef void fp3_option_fn(void *options, struct argp_state *state, char *text);

typedef enum {
    FP3_OPTION_CALL,
    FP3_OPTION_FLAG, /* an int becomes 1 */
    FP3_OPTION_TEXT,
    FP3_OPTION_LIST,   /* texts, at most `most`, whose number is an unsigned at `count` */
    FP3_OPTION_NUMBER, /* a uint32_t or uint64_t, from least to most */
    FP3_OPTION_ABOVE_ZERO,
    FP3_OPTION_FREQUENCY
} fp3_option_kind;

typedef struct {
    const char *name;
    int letter;              /* 0: none */
    const char *value, *doc; /* value: what the help calls it; NULL: none */
    fp3_option_kind kind;
    size_t at, size, count; /* where the value goes in the command's options */
    uint64_t least, most;
    fp3_option_fn *take;
    int is_repeated; /* may be given again */
    int is_optional; /* its value may be left out */
    unsigned forms;  /* what the command makes of it */
} fp3_option;

/* A field of another type than the kind's does not compile. */
#define FP3_PLACE(type, field, ...)                                                                \
    .at = offsetof(type, field) + 0 * _Generic(((type *)0)->field, __VA_ARGS__),                   \
    .size = sizeof(((type *)0)->field)
#define FP3_CALL(function) .kind = FP3_OPTION_CALL, .take = function
#define FP3_FLAG(type, field) .kind = FP3_OPTION_FLAG, FP3_PLACE(type, field, int : 1)
#define FP3_TEXT(type, field) .kind = FP3_OPTION_TEXT, FP3_PLACE(type, field, const char * : 1)
#define FP3_LIST(type, field, counter, to)                                                         \
    .kind = FP3_OPTION_LIST, FP3_PLACE(type, field[0], const char * : 1),                          \
    .count = offsetof(type, counter) + 0 * _Generic(((type *)0)->counter, unsigned : 1),           \
    .most = (to)
#define FP3_ABOVE_ZERO(type, field)                                                                \
    .kind = FP3_OPTION_ABOVE_ZERO, FP3_PLACE(type, field, double : 1)
#define FP3_FREQUENCY(type, field) .kind = FP3_OPTION_FREQUENCY, FP3_PLACE(type, field, double : 1)
#define FP3_NUMBER(type, field, from, to)                                                          \
    .kind = FP3_OPTION_NUMBER, FP3_PLACE(type, field, uint32_t : 1, uint64_t : 1),                 \
    .least = (from), .most = (to)

typedef struct {
    const fp3_option *options;                              /* ended by {0}; or NULL */
    fp3_option_fn *take;                                    /* a word that is no option, or: */
    const char *one;                                        /* what the only such word is, */
    size_t at;                                              /* and where it goes */
    void (*end)(void *options, struct argp_state *state);   /* after the last word */
    void (*given)(void *options, const fp3_option *option); /* before an option is taken */
    const char *forms, *doc;                                /* as argp's args_doc and doc */
} fp3_command;

#define FP3_WORD(type, field, what)                                                                \
    .one = what, .at = offsetof(type, field) + 0 * _Generic(&((type *)0)->field, const char ** : 1)

/* Reads a line into the command's options. Ends with 2 and a message at an option that there is
 * not, naming the nearest, and at an option with a value that is given twice. */
void fp3_arguments_parse(const fp3_command *command, int argc, char **argv, void *options);

/* What a line says, without doing it: options of the table, by whatever form, and arguments that
 * are none (option NULL), in their order. value: of an option that has none NULL. */
typedef fp3_status fp3_argument_fn(void *user, const fp3_option *option, const char *value,
                                   fp3_error *error);
/* Ends with what `tell` returns, unless it is FP3_OK. FP3_E_ARGUMENT: an option that the table has
 * not (--help is none of the table's), one that could be several of them, one without the value
 * that it needs, or one with a value that it does not take. */
fp3_status fp3_arguments_each(const fp3_option *table, int argc, char *const *argv,
                              fp3_argument_fn *tell, void *user, fp3_error *error);

/* A number in decimal digits; ends with 2 and a message if it is none from least to most. */
uint64_t fp3_arguments_number(struct argp_state *state, const char *option, const char *text,
                              uint64_t least, uint64_t most);

/* A number or a constant expression, finite and above 0; ends with 2 and a message if it is none.
 */
double fp3_arguments_above_zero(struct argp_state *state, const char *option, const char *text);

/* Ends with 2 and a message if the name says that it is another program than a model, and the
 * option --model was not given. */
void fp3_arguments_model(struct argp_state *state, const char *path, int is_model);

/* Sets it; ends with 2 and a message if another one is set already. */
void fp3_arguments_arithmetic(struct argp_state *state, fp3_compile_def *def,
                              fp3_arithmetic arithmetic);

/* Of --arithmetic; ends with 2 and a message that names all if there is none of this name. */
fp3_arithmetic fp3_arguments_arithmetic_named(struct argp_state *state, const char *name);

#endif
