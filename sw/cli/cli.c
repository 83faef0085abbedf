/* cli.c - how every subcommand ends. */
#include "cli.h"

#include <fp3/model.h>
#include <stdio.h>
#include <string.h>

int fp3_cli_fail(const char *command, fp3_status status, const fp3_error *error) {
    fflush(stdout);
    fprintf(stderr, "fp3 %s: %s\n", command, error->text);
    return fp3_exit_code(status);
}

int fp3_cli_end(const char *command, fp3_status status, const fp3_error *error,
                const char *report) {
    if (!status)
        return 0;
    if (!report)
        return fp3_cli_fail(command, status, error);
    fflush(stdout);
    fputs(report, stderr);
    return fp3_exit_code(status);
}

const char *fp3_cli_integrator_file(const char *name) {
    for (unsigned i = 0; name && fp3_integrator_name(i); i++)
        if (!strcmp(name, fp3_integrator_name(i)))
            return NULL;
    return name;
}

void fp3_cli_warn(const char *command, const char *path, const char *warning) {
    if (!warning)
        return;
    fflush(stdout);
    fprintf(stderr, "fp3 %s: %s: warning: %s\n", command, path, warning);
}
