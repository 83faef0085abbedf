/* cli.c - how every subcommand ends. */
#include "cli.h"

#include <stdio.h>

int fp3_cli_fail(const char *command, fp3_status status, const fp3_error *error) {
    fflush(stdout);
    fprintf(stderr, "fp3 %s: %s\n", command, error->text);
    return fp3_exit_code(status);
}

int fp3_cli_done(const char *command, int exit_code) {
    if (!fflush(stdout) && !ferror(stdout))
        return exit_code;
    fprintf(stderr, "fp3 %s: cannot write the output\n", command);
    return 1;
}
