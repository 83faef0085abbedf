/* SPDX-License-Identifier: Apache-2.0 */
/* run_values.c - see run_values.h. */
#include "run_values.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Adds the name in front of the = of text to those of one option; the other must not have it. */
static void note_name(struct argp_state *state, const char *text, char **mine, const char *others) {
    char *name = NULL, *all = NULL;
    if (asprintf(&name, ",%.*s,", (int)strcspn(text, "="), text) < 0 ||
        asprintf(&all, "%s%s", *mine ? *mine : "", name) < 0)
        argp_failure(state, 1, 0, "out of memory");
    else if (others && strstr(others, name))
        argp_error(state, "found both --set and --spread of '%.*s', expected one of them",
                   (int)strcspn(text, "="), text);
    free(name);
    free(*mine);
    *mine = all;
}

static void check(struct argp_state *state, fp3_status status, const fp3_error *error) {
    if (status)
        argp_failure(state, 2, 0, "%s", error->text);
}

void fp3_run_values_load(fp3_run_values *values, struct argp_state *state, const char *path) {
    fp3_error error;
    check(state, fp3_params_load(values->params, path, &error), &error);
}

void fp3_run_values_set(fp3_run_values *values, struct argp_state *state, const char *text) {
    fp3_error error;
    check(state, fp3_params_set(values->params, text, &error), &error);
    note_name(state, text, &values->sets, values->spreads);
}

void fp3_run_values_spread(fp3_run_values *values, struct argp_state *state, const char *text) {
    fp3_error error;
    check(state, fp3_params_spread(values->params, text, &error), &error);
    note_name(state, text, &values->spreads, values->sets);
}

void fp3_run_values_free(fp3_run_values *values) {
    fp3_params_free(&values->params);
    free(values->sets);
    free(values->spreads);
    *values = (fp3_run_values){0};
}
