/* SPDX-License-Identifier: Apache-2.0 */
/* verify_command.h - what fp3 verify runs again of the arguments that a file keeps.
 *
 * A file may be anybody's, so its arguments are not executed as they are: a line is made from those
 * that decide the bits of a run. What a run writes or prints is left out; anything else is refused.
 */
#ifndef FP3_CLI_VERIFY_COMMAND_H
#define FP3_CLI_VERIFY_COMMAND_H

#include <fp3/status.h>

typedef struct {
    const char *path;   /* of the file, for messages */
    const char *engine; /* that replaces the one of the run; NULL: none does */
    int argc;
    char **argv;
} fp3_verify_command;

/* Takes `text` apart, the arguments of a run of fp3, one a line. path and engine are given; the
 * caller frees the rest, after a failure too. FP3_E_ARGUMENT: an argument that is refused, by name;
 * more or longer ones than a run has. */
fp3_status fp3_verify_command_make(fp3_verify_command *command, char *text, fp3_error *error);
void fp3_verify_command_free(fp3_verify_command *command);

#endif
