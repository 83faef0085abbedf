/* SPDX-License-Identifier: Apache-2.0 */
/* cli.c - how every subcommand ends. */
#include "cli.h"

#include <fp3/model.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/printable.h"

void fp3_cli_line(FILE *out, const char *format, ...) {
    char line[2 * PATH_MAX];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    for (size_t i = 0; line[i]; i++)
        fputc(fp3_printable(line, i), out);
    fputc('\n', out);
}

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
    fp3_cli_line(stderr, "fp3 %s: %s: warning: %s", command, path, warning);
}
