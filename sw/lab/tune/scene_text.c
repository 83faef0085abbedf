/* SPDX-License-Identifier: Apache-2.0 */
/* scene_text.c - a choice as a scene that runs as it is. */
#include <fp3/tune.h>

#include "base/definition.h"
#include "base/host.h"
#include "world/values.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put_values(FILE *to, const fp3_params *params, int is_spread) {
    fp3_value_look look;
    fprintf(to, "            %s = {", is_spread ? "spread" : "set");
    for (size_t i = 0; fp3_values_look(params, i, &look); i++) {
        if (look.is_spread != is_spread || strcmp(look.name, FP3_NAME_STEP) == 0)
            continue;
        if (look.formula)
            fprintf(to, " %s = \"%s\";", look.name, look.formula);
        else if (is_spread)
            fprintf(to, " %s = [%.17g, %.17g];", look.name, look.first, look.last);
        else
            fprintf(to, " %s = %.17g;", look.name, look.first);
    }
    fprintf(to, " };\n");
}

static void put_arithmetic(FILE *to, fp3_arithmetic arithmetic) {
    if (arithmetic != FP3_PLAIN)
        fprintf(to, "            %s = true;\n", fp3_arithmetic_of(arithmetic)->name);
}

/* A string of libconfig. */
static void put_string(FILE *to, const char *text) {
    fputc('"', to);
    for (; *text; text++) {
        if (strchr("\"\\", *text))
            fputc('\\', to);
        fputc(*text, to);
    }
    fputc('"', to);
}

/* Of the whole scene; a tolerance, and where objects end, are of a group. */
static void put_steps(FILE *to, const fp3_tune_row *best) {
    if (!best->is_adaptive && !best->is_cut)
        fprintf(to, "steps  = %" PRIu64 ";\n", best->steps);
    if (!best->is_adaptive)
        fprintf(to, "h      = %.9g;\n", (double)best->h);
}

static void put_tolerance(FILE *to, const fp3_tune_def *def, const fp3_tune_row *best,
                          double span) {
    if (best->is_adaptive && def->maxstep != 0)
        fprintf(to, "            maxstep = %.9g;\n", def->maxstep);
    if (best->is_adaptive)
        fprintf(to, "            tolerance = %.9g;\n            absolute = %.9g;\n",
                best->tolerance, best->absolute);
    if (best->is_adaptive || best->is_cut)
        fprintf(to, "            until = %.17g;\n", (double)(float)span);
}

static void put_scene(FILE *to, const fp3_tune_def *def, const fp3_tuning *t, const char *program,
                      uint32_t objects) {
    const fp3_tune_row *best = &t->rows[t->best];
    fprintf(to, "# Made by fp3 tune for tolerance %g over a span of %.9g.\n", def->tolerance,
            t->span);
    if (t->held_out)
        fprintf(to, "# %" PRIu32 " held-out objects have an error of %.2e at most.\n", t->held_out,
                t->error_held_out);
    else
        fprintf(to, "# Only these values were looked at.\n");
    fprintf(to, "config = \"%s\";\nengine = \"fast\";\n", def->config);
    put_steps(to, best);
    fprintf(to, "\ngroups = (\n        {\n            program = ");
    put_string(to, program);
    fprintf(to, ";\n            integrator = \"%s\";\n", best->integrator);
    put_arithmetic(to, best->arithmetic);
    put_tolerance(to, def, best, t->span);
    fprintf(to, "            objects = %" PRIu32 ";\n", objects);
    put_values(to, def->params, 0);
    put_values(to, def->params, 1);
    fprintf(to, "        }\n    );\n");
}

fp3_status fp3_tuning_scene(const fp3_tune_def *def, const fp3_tuning *tuning, const char *program,
                            uint32_t objects, char **text, fp3_error *error) {
    FP3_HOST;
    size_t size = 0;
    *text = NULL;
    if (fp3_definition_check(def, sizeof *def, "fp3_tune_def", error))
        return FP3_E_ARGUMENT;
    if (tuning->best >= tuning->row_count)
        return fp3_fail(error, FP3_E_ARGUMENT, "nothing meets the tolerance: there is no scene");
    FILE *to = open_memstream(text, &size);
    if (!to)
        return fp3_no_memory(error);
    put_scene(to, def, tuning, program, objects);
    if (fclose(to)) {
        free(*text);
        *text = NULL;
        return fp3_no_memory(error);
    }
    return FP3_OK;
}
