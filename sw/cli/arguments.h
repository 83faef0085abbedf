/* SPDX-License-Identifier: Apache-2.0 */
/* arguments.h - a command line, by argp, with what all commands have in common. */
#ifndef FP3_CLI_ARGUMENTS_H
#define FP3_CLI_ARGUMENTS_H

#include <argp.h>
#include <fp3/compile.h>
#include <fp3/status.h>
#include <stdint.h>

/* argp_parse, for options that need no argp children. Ends with 2 and a message at an option that
 * there is not, naming the nearest; and at an option with a value that is given twice, unless
 * its help says "may be repeated". */
void fp3_arguments_parse(const struct argp *argp, int argc, char **argv, void *input);

/* What a line says, without doing it: options of the table, by whatever form, and arguments that are none (option NULL), in
 * their order. value: of an option that has none NULL. */
typedef fp3_status fp3_argument_fn(void *user, const struct argp_option *option, const char *value,
                                   fp3_error *error);
/* Ends with what `tell` returns, unless it is FP3_OK. FP3_E_ARGUMENT: an option that the table has not (--help is none of
 * the table's), one that could be several of them, one without the value that it needs, or one with a value that it does
 * not take. */
fp3_status fp3_arguments_each(const struct argp_option *table, int argc, char *const *argv,
                              fp3_argument_fn *tell, void *user, fp3_error *error);

/* A number in decimal digits; ends with 2 and a message if it is none from least to most. */
uint64_t fp3_arguments_number(struct argp_state *state, const char *option, const char *text,
                              uint64_t least, uint64_t most);

/* A number or a constant expression, finite and above 0; ends with 2 and a message if it is none. */
double fp3_arguments_above_zero(struct argp_state *state, const char *option, const char *text);

/* Ends with 2 and a message if the name says that it is another program than a model, and the
 * option --model was not given. */
void fp3_arguments_model(struct argp_state *state, const char *path, int is_model);

/* Sets it; ends with 2 and a message if another one is set already. */
void fp3_arguments_arithmetic(struct argp_state *state, fp3_compile_def *def,
                              fp3_arithmetic arithmetic);

/* Of --arithmetic; ends with 2 and a message that names all if there is none of this name. */
fp3_arithmetic fp3_arguments_arithmetic_named(struct argp_state *state, const char *name);

/* In Hz, of a number above 0 and a unit, as 130MHz; ends with 2 and a message if it is none. */
double fp3_arguments_frequency(struct argp_state *state, const char *option, const char *text);

#endif
