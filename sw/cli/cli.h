/* SPDX-License-Identifier: Apache-2.0 */
/* cli.h - the subcommands of fp3, one file cmd_<name>.c each. */
#ifndef FP3_CLI_H
#define FP3_CLI_H

#include <fp3/status.h>
#include <stdio.h>

/* Each gets its own arguments with argv[0] = "fp3 <name>" (argp prints it) and returns the exit
 * code: 0 success, 1 failed, 2 bad input or usage, 3 objects failed in a run, or results do not
 * hold. Ends usage errors itself through argp. */
int fp3_cmd_asm(int argc, char **argv);
int fp3_cmd_compile(int argc, char **argv);
int fp3_cmd_compare(int argc, char **argv);
int fp3_cmd_dis(int argc, char **argv);
int fp3_cmd_run(int argc, char **argv);
int fp3_cmd_verify(int argc, char **argv);
int fp3_cmd_bench(int argc, char **argv);
int fp3_cmd_stress(int argc, char **argv);
int fp3_cmd_view(int argc, char **argv);
int fp3_cmd_tune(int argc, char **argv);
int fp3_cmd_board(int argc, char **argv);
int fp3_cmd_info(int argc, char **argv);
int fp3_cmd_doctor(int argc, char **argv);

/* Prints a line in which a name or a path from a file cannot control the terminal. */
__attribute__((format(printf, 2, 3))) void fp3_cli_line(FILE *out, const char *format, ...);

/* Prints "fp3 <name>: text" to stderr and returns the exit code that belongs to the status. */
int fp3_cli_fail(const char *command, fp3_status status, const fp3_error *error);

/* The exit code of a command that ends with this status: after a failure with the report of a
 * source's errors, or, where that is NULL, with the error. */
int fp3_cli_end(const char *command, fp3_status status, const fp3_error *error, const char *report);

/* The file that an integrator is read from; NULL if it is built in, or name is NULL. */
const char *fp3_cli_integrator_file(const char *name);

/* Prints "fp3 <name>: path: warning: text" to stderr, unless warning is NULL. */
void fp3_cli_warn(const char *command, const char *path, const char *warning);

#endif
