/* SPDX-License-Identifier: Apache-2.0 */
/* equations.c - see equations.h. One line for each expression, in the order of the model. */
#include "equations.h"

#include "language/function_rows.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#define WHOLE_POWER_MOST 4

static const char powers[] = "#ifdef LIBM_POWERS\n"
                             "#define POWER2(x) powf(x, 2)\n"
                             "#define POWER3(x) powf(x, 3)\n"
                             "#define POWER4(x) powf(x, 4)\n"
                             "#else\n"
                             "#define POWER2(x) ((x) * (x))\n"
                             "#define POWER3(x) ((x) * (x) * (x))\n"
                             "#define POWER4(x) ((x) * (x) * (x) * (x))\n"
                             "#endif\n";

/* A, B and C stand for the operands, @ for the ending of a function of <math.h>. */
static const struct {
    const char *c, *python;
} forms[FP3_EXPR_OP_COUNT] = {
#define X(OP, name, MADE, UNIT, VALUE, SLOPE, C, PYTHON) [FP3_EXPR_##OP] = {C, PYTHON},
    FP3_FUNCTION_ROWS(X)
#undef X
        [FP3_EXPR_NEGATE] = {"-A", "-A"},
    [FP3_EXPR_ADD] = {"A + B", "A + B"},
    [FP3_EXPR_SUB] = {"A - B", "A - B"},
    [FP3_EXPR_MUL] = {"A * B", "A * B"},
    [FP3_EXPR_DIV] = {"A / B", "A / B"},
    [FP3_EXPR_POWER] = {"pow@(A, B)", "jnp.power(A, B)"},
    [FP3_EXPR_LESS] = {"A < B", "jnp.where(A < B, 1.0, 0.0)"},
    [FP3_EXPR_LESS_EQUAL] = {"A <= B", "jnp.where(A <= B, 1.0, 0.0)"},
    [FP3_EXPR_EQUAL] = {"A == B", "jnp.where(A == B, 1.0, 0.0)"},
    [FP3_EXPR_AND] = {"A != 0 && B != 0", "jnp.where((A != 0) & (B != 0), 1.0, 0.0)"},
    [FP3_EXPR_OR] = {"A != 0 || B != 0", "jnp.where((A != 0) | (B != 0), 1.0, 0.0)"},
    [FP3_EXPR_NOT] = {"A == 0", "jnp.where(A == 0, 1.0, 0.0)"},
};

typedef struct {
    FILE *to;
    const fp3_model *model;
    fp3_bench_language language;
    unsigned char *wanted; /* by expression */
} writer;

static int is_python(const writer *w) { return w->language == FP3_BENCH_PYTHON; }

static void want_nothing(writer *w) {
    for (uint32_t i = 0; i < w->model->expr_count; i++)
        w->wanted[i] = 0;
}

/* ... and what it is computed from, which stands before it. */
static void want(writer *w, uint32_t expr) {
    w->wanted[expr] = 1;
    for (uint32_t i = expr + 1; i-- > 0;)
        for (int k = 0; w->wanted[i] && k < 3; k++)
            if (w->model->exprs[i].operand[k] != FP3_NONE)
                w->wanted[w->model->exprs[i].operand[k]] = 1;
}

static void write_form(const writer *w, const fp3_expr *e) {
    for (const char *c = is_python(w) ? forms[e->op].python : forms[e->op].c; *c; c++)
        if (*c >= 'A' && *c <= 'C' && (c[1] < 'a' || c[1] > 'z'))
            fprintf(w->to, "e%" PRIu32, e->operand[*c - 'A']);
        else if (*c == '@')
            fputs(w->language == FP3_BENCH_FLOAT ? "f" : "", w->to);
        else
            fputc(*c, w->to);
}

/* A whole exponent that is small, or 0. */
static int whole_power(const writer *w, const fp3_expr *e) {
    const fp3_expr *b = e->op == FP3_EXPR_POWER ? &w->model->exprs[e->operand[1]] : NULL;
    for (int n = 2; b && b->op == FP3_EXPR_NUMBER && n <= WHOLE_POWER_MOST; n++)
        if (b->number == n)
            return n;
    return 0;
}

static void write_value(const writer *w, const fp3_expr *e) {
    const int power = whole_power(w, e);
    switch (e->op) {
    case FP3_EXPR_NUMBER:
        fprintf(w->to, is_python(w) ? "%.17g" : "(real)%.17g", e->number);
        break;
    case FP3_EXPR_STATE:
        fprintf(w->to, "y[%" PRIu32 "]", e->index);
        break;
    case FP3_EXPR_PARAM:
        fprintf(w->to, "p[%" PRIu32 "]", e->index);
        break;
    case FP3_EXPR_TIME:
        fputs("t", w->to);
        break;
    default:
        if (power && !is_python(w))
            fprintf(w->to, "POWER%d(e%" PRIu32 ")", power, e->operand[0]);
        else
            write_form(w, e);
    }
}

static void write_wanted(const writer *w, const char *indent) {
    for (uint32_t i = 0; i < w->model->expr_count; i++)
        if (w->wanted[i]) {
            fprintf(w->to, is_python(w) ? "%se%" PRIu32 " = " : "%sconst real e%" PRIu32 " = ",
                    indent, i);
            write_value(w, &w->model->exprs[i]);
            fputs(is_python(w) ? "\n" : ";\n", w->to);
        }
}

static void write_slopes(writer *w) {
    const fp3_model *m = w->model;
    want_nothing(w);
    for (uint32_t i = 0; i < m->state_count; i++)
        want(w, m->states[i].derivative);
    fputs(is_python(w) ? "def slopes(t, y, p):\n"
                       : "static inline __attribute__((always_inline)) void slopes(real t, const "
                         "real *y, const real *p, real *d) {\n    (void)t, (void)y, (void)p;\n",
          w->to);
    write_wanted(w, "    ");
    fputs(is_python(w) ? "    return (" : "", w->to);
    for (uint32_t i = 0; i < m->state_count; i++)
        if (is_python(w))
            fprintf(w->to, "e%" PRIu32 ", ", m->states[i].derivative);
        else
            fprintf(w->to, "    d[%" PRIu32 "] = e%" PRIu32 ";\n", i, m->states[i].derivative);
    fputs(is_python(w) ? ")\n" : "}\n", w->to);
}

/* Whether the event may happen after what was before the step, in a block of its own. */
static void write_armed(writer *w, const fp3_event *event) {
    fputs("        int is_armed = 1;\n", w->to);
    if (event->armed == FP3_NONE)
        return;
    want_nothing(w);
    want(w, event->armed);
    fputs("        {\n            const real *y = was;\n            const real t = began;\n        "
          "    (void)t, (void)y;\n",
          w->to);
    write_wanted(w, "            ");
    fprintf(w->to, "            is_armed = e%" PRIu32 " != 0;\n        }\n", event->armed);
}

static void write_event(writer *w, const fp3_event *event) {
    const fp3_assignment *to = &w->model->assignments[event->first];
    fputs("    {\n", w->to);
    write_armed(w, event);
    want_nothing(w);
    if (event->condition != FP3_NONE)
        want(w, event->condition);
    for (uint32_t i = 0; i < event->count; i++)
        want(w, to[i].expr);
    write_wanted(w, "        ");
    fputs("        const int happens = is_armed", w->to);
    if (event->condition != FP3_NONE)
        fprintf(w->to, " && e%" PRIu32 " != 0", event->condition);
    fputs(";\n", w->to);
    for (uint32_t i = 0; i < event->count; i++)
        fprintf(w->to, "        y[%" PRIu32 "] = happens ? e%" PRIu32 " : y[%" PRIu32 "];\n",
                to[i].state, to[i].expr, to[i].state);
    fputs("    }\n", w->to);
}

static void write_projections(writer *w) {
    const fp3_model *m = w->model;
    const fp3_repeat *r = m->repeats, *end = r + m->repeat_count;
    for (uint32_t i = 0; i < m->projection_count; i++) {
        if (r < end && i == r->first)
            fprintf(w->to, "    for (int n = 0; n < %" PRIu32 "; n++) {\n", r->times);
        write_event(w, &m->projections[i]);
        if (r < end && i + 1 == r->first + r->count) {
            fputs("    }\n", w->to);
            r++;
        }
    }
}

static void write_model(writer *w) {
    const fp3_model *m = w->model;
    if (is_python(w)) {
        write_slopes(w);
        return;
    }
    fprintf(w->to,
            "#include <math.h>\n#include <stddef.h>\n#include <string.h>\ntypedef %s real;\n"
            "enum { STATES = %" PRIu32 ", PARAMS = %" PRIu32 " };\n",
            w->language == FP3_BENCH_FLOAT ? "float" : "double", m->state_count, m->param_count);
    fputs(powers, w->to);
    write_slopes(w);
    fputs("static inline __attribute__((always_inline)) void events(real began, const real "
          "*was, real t, real *y, const real *p) {\n    (void)began, (void)was, (void)t, (void)y, "
          "(void)p;\n",
          w->to);
    write_projections(w);
    for (uint32_t i = 0; i < m->event_count; i++)
        write_event(w, &m->events[i]);
    fputs("}\n", w->to);
}

fp3_status fp3_bench_equations(const fp3_model *model, fp3_bench_language language, char **text,
                               fp3_error *error) {
    size_t size = 0;
    *text = NULL;
    if (language == FP3_BENCH_PYTHON && (model->event_count || model->projection_count))
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' has events or projections", model->name);
    writer w = {.to = open_memstream(text, &size),
                .model = model,
                .language = language,
                .wanted = calloc(model->expr_count + 1u, 1)};
    if (w.to && w.wanted)
        write_model(&w);
    const int failed = !w.to || !w.wanted || ferror(w.to);
    free(w.wanted);
    if ((w.to && fclose(w.to)) || failed) {
        free(*text);
        *text = NULL;
        return fp3_no_memory(error);
    }
    return FP3_OK;
}
