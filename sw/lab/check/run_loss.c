/* SPDX-License-Identifier: Apache-2.0 */
/* run_loss.c - see run_loss.h. */
#include "run_loss.h"

#include "others.h"

#include "engine/common/inside.h"
#include "language/evaluate.h"
#include "machine/config.h"
#include "world/apply.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Objects, the first of a part: a warning costs little, however many there are. */
#define LOOKED 1024
/* Fewer, where to see their neighbours would take more pairs than this. */
#define PAIRS 4194304

/* More than a normal number loses when FP32 rounds it. */
#define ROUNDING 5.9604644775390625e-8

struct fp3_run_loss {
    fp3_run_part part;
    const fp3_model *model;
    const fp3_config *config;
    fp3_object_values values;
    size_t looked;
    int is_adaptive;
    char *is_needed; /* expressions that derivatives and events are made of */
    char *is_read;   /* those that an instruction reads, if they are known before the run */
    size_t seen;     /* objects: those that are looked at and their neighbours may be among them */
    double *columns; /* their final states */
    fp3_others *others;
    double *common; /* of objects that see each other, the size of each state */
    double *states, *lost;
    double *room; /* for fp3_model_standstill */
    /* Of each expression: in double, and without what FP32 has no room for. */
    double *exact, *clipped;
    double t, span;
};

/* ---- states ---- */

static int are_of_one_vector(const char *one, const char *other) {
    const char *end = strrchr(one, '_');
    const size_t length = end ? (size_t)(end - one) + 1 : 0;
    return length && !strncmp(one, other, length) && !strchr(other + length, '_');
}

void fp3_run_common_size(const fp3_model *model, uint32_t states, size_t objects, double *size) {
    const fp3_quantity *of = model->states;
    for (uint32_t first = 0, end; first < states; first = end) {
        double common = 0;
        end = first + 1;
        while (end < states && are_of_one_vector(of[first].name, of[end].name))
            end++;
        for (size_t k = first * objects; k < end * objects; k++)
            common = fmax(common, fabs(size[k]));
        for (size_t k = first * objects; k < end * objects; k++)
            size[k] = common;
    }
}

/* ---- open and close ---- */

static void mark_root(fp3_run_loss *l, uint32_t expr) {
    if (expr != FP3_NONE)
        l->is_needed[expr] = l->is_read[expr] = 1;
}

static void mark(fp3_run_loss *l) {
    const fp3_model *m = l->model;
    for (uint32_t s = 0; s < m->state_count; s++)
        mark_root(l, m->states[s].derivative);
    for (uint32_t i = 0; i < m->event_count; i++)
        mark_root(l, m->events[i].condition);
    for (uint32_t i = 0; i < m->assignment_count; i++)
        mark_root(l, m->assignments[i].expr);
    for (uint32_t i = m->expr_count; i-- > 0;)
        for (unsigned k = 0; l->is_needed[i] && k < fp3_ode_operands(m->exprs[i].op); k++) {
            l->is_needed[m->exprs[i].operand[k]] = 1;
            l->is_read[m->exprs[i].operand[k]] |= !m->exprs[i].is_known;
        }
}

static size_t looked_of(const fp3_run_part *part) {
    const size_t most = part->program->sees_others ? PAIRS / part->objects + 1 : LOOKED;
    const size_t looked = most < LOOKED ? most : LOOKED;
    return part->objects < looked ? part->objects : looked;
}

static fp3_status find_common(fp3_run_loss *l, fp3_error *error) {
    const uint32_t states = l->model->state_count;
    double *size = malloc((states * l->seen + 1) * sizeof *size);
    if (!size)
        return fp3_no_memory(error);
    memcpy(size, l->columns, states * l->seen * sizeof *size);
    fp3_run_common_size(l->model, states, l->seen, size);
    for (uint32_t s = 0; s < states; s++)
        l->common[s] = size[s * l->seen];
    free(size);
    return FP3_OK;
}

int fp3_run_loss_is_blind(const fp3_run_part *part) {
    return fp3_model_remembers(part->program->model) || part->program->model->kind_count ||
           (part->program->sees_others && fp3_engine_has_lives(part->engine));
}

fp3_status fp3_run_loss_open(const fp3_run_part *part, fp3_run_loss **loss, fp3_error *error) {
    fp3_run_loss *l = *loss = calloc(1, sizeof *l);
    if (!l)
        return fp3_no_memory(error);
    const fp3_model *m = l->model = part->program->model;
    l->config = fp3_config_find(part->program->config);
    l->part = *part;
    l->is_adaptive = fp3_adaptive_is(part->program->image);
    l->looked = looked_of(part);
    l->seen = part->program->sees_others ? part->objects : l->looked;
    l->is_needed = calloc(m->expr_count + 1u, 1);
    l->is_read = calloc(m->expr_count + 1u, 1);
    l->columns = calloc(m->state_count * l->seen + 1, sizeof *l->columns);
    l->states = calloc(4u * m->state_count + 2u * m->expr_count + 1u, sizeof *l->states);
    l->exact = calloc(2u * m->expr_count + 1u, sizeof *l->exact);
    fp3_status status = l->is_needed && l->is_read && l->columns && l->states && l->exact
                            ? fp3_object_values_open(part->program, part->params, &l->values, error)
                            : fp3_no_memory(error);
    l->lost = l->states + m->state_count;
    l->common = l->lost + m->state_count;
    l->room = l->common + m->state_count;
    l->clipped = l->exact + m->expr_count;
    for (uint32_t s = 0; !status && s < m->state_count; s++)
        status = fp3_run_state_read(part->program, part->engine, s, part->first, l->seen,
                                    l->columns + s * l->seen, error);
    if (!status && part->program->sees_others)
        status = find_common(l, error);
    if (!status)
        status = fp3_others_open(part->program, part->params, l->seen, l->looked, l->columns,
                                 &l->others, error);
    if (status) {
        fp3_run_loss_close(loss);
        return status;
    }
    mark(l);
    return FP3_OK;
}

void fp3_run_loss_close(fp3_run_loss **loss) {
    fp3_run_loss *l = *loss;
    if (!l)
        return;
    fp3_object_values_free(&l->values);
    fp3_others_close(&l->others);
    free(l->is_needed);
    free(l->is_read);
    free(l->columns);
    free(l->states);
    free(l->exact);
    free(l);
    *loss = NULL;
}

/* ---- one object ---- */

static int is_tiny(double value) { return fabs(value) < (double)FLT_MIN; }

static double clip(const fp3_run_loss *l, double value) {
    return !is_tiny(value)        ? value
           : l->config->subnormal ? (double)(float)value
                                  : copysign(0, value);
}

/* Whether FP32 has a number less exactly than it has a normal one. */
static int is_spoiled(const fp3_run_loss *l, double value) {
    return fabs(clip(l, value) - value) > ROUNDING * fabs(value);
}

/* ---- roots of subnormal numbers, as compiler/functions/division.c makes them ---- */

/* b's, if the expression is b's root from an estimate; else FP3_NONE. */
static uint32_t base_of_root(const fp3_run_loss *l, const fp3_expr *e) {
    const int is_exact =
        (l->part.program->compiled->passes & FP3_PASS(FP3_PASS_EXACT_DIVISION)) != 0;
    const int is_half = e->op == FP3_EXPR_POWER && l->model->exprs[e->operand[1]].is_known &&
                        l->exact[e->operand[1]] == 0.5;
    if (e->is_known || l->config->logarithmic || l->config->mixed)
        return FP3_NONE;
    return is_half || (e->op == FP3_EXPR_SQRT && !is_exact) ? e->operand[0] : FP3_NONE;
}

static int is_tiny_root(const fp3_run_loss *l, const fp3_expr *e) {
    const uint32_t base = base_of_root(l, e);
    return base != FP3_NONE && is_tiny(l->clipped[base]) && l->clipped[base] > 0;
}

/* With the estimate of 2^-126; a pair is corrected once. */
static double root_of_tiny(const fp3_run_loss *l, double b) {
    const double e = 1 - b * 0x1p126, y = 0x1p63 * (1 + e * (0.5 + 0.375 * e)), root = b * y;
    return l->part.program->compiled->arithmetic == FP3_DOUBLE_SINGLE
               ? root + (b - root * root) * y / 2
               : root;
}

/* An fp3_others_fn: what the program has of an expression, where the host has computed value from
 * the program's operands. A value that is known before the run is computed in double: only what the
 * program reads of it, as the host has rounded it, is FP32. */
static double as_program(const void *loss, uint32_t expr, double value) {
    const fp3_run_loss *l = loss;
    const fp3_expr *e = &l->model->exprs[expr];
    if (e->is_known)
        return clip(l, l->exact[expr]);
    if (is_tiny_root(l, e))
        return clip(l, root_of_tiny(l, l->clipped[e->operand[0]]));
    if (e->op == FP3_EXPR_DIV && is_tiny_root(l, &l->model->exprs[e->operand[1]]))
        return l->clipped[e->operand[0]] * INFINITY; /* by 1/sqrt(b), which is infinite */
    return clip(l, value);
}

static fp3_point point_of(const fp3_run_loss *l, const double *states) {
    return (fp3_point){
        .states = states, .params = l->values.params, .initial = l->values.initial, .t = l->t};
}

static void evaluate(fp3_run_loss *l, size_t object) {
    const fp3_point at = point_of(l, l->states);
    fp3_others_evaluate(l->others, object, &at, NULL, NULL, l->exact);
    fp3_others_evaluate(l->others, object, &at, as_program, l, l->clipped);
}

static fp3_status look(fp3_run_loss *l, size_t object, fp3_error *error) {
    const fp3_model *m = l->model;
    const size_t last = l->part.objects - 1;
    fp3_status status =
        fp3_object_values_at(&l->values, last ? (double)object / (double)last : 0, error);
    if (status)
        return status;
    for (uint32_t s = 0; s < m->state_count; s++)
        l->states[s] = l->columns[s * l->seen + object];
    const double before = l->values.steps;
    l->span = l->is_adaptive ? l->states[fp3_model_adapted(m)]
                             : (double)l->part.steps * (double)(float)l->values.h;
    l->t = l->is_adaptive ? l->span : l->span + before * (double)(float)l->values.h;
    evaluate(l, object);
    for (uint32_t s = 0; s < m->state_count; s++) {
        const uint32_t of = m->states[s].derivative;
        l->lost[s] = of == FP3_NONE ? 0 : fabs(l->exact[of] - l->clipped[of]) * fabs(l->span);
    }
    return FP3_OK;
}

size_t fp3_run_loss_looked(const fp3_run_loss *l) { return l->looked; }

fp3_status fp3_run_loss_look(fp3_run_loss *l, size_t object, fp3_run_lost *found,
                             fp3_error *error) {
    const fp3_status status = look(l, object, error);
    *found = (fp3_run_lost){l->states, l->values.initial, l->lost, l->values.params, l->t};
    return status;
}

/* ---- warnings ---- */

typedef struct {
    fp3_run_loss *loss;
    fp3_run_say_fn *say;
    const char *path;
    double bound;
    size_t warnings;
} warner;

__attribute__((format(printf, 2, 3))) static void warn(warner *w, const char *format, ...) {
    char text[320];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    w->say(w->path, text);
    w->warnings++;
}

static void say_digits(warner *w, size_t object, const char *name, double value) {
    const double there = clip(w->loss, value);
    if (is_spoiled(w->loss, value))
        warn(w, "object %zu: %s = %.9g loses digits: FP32 has %.3g (%.2g %% off)", object, name,
             value, there, 100 * fabs(there / value - 1));
}

/* Numbers that the program reads. A state with two words has more, but not down here. */
static void warn_of_digits(warner *w, size_t object) {
    const fp3_run_loss *l = w->loss;
    const fp3_model *m = l->model;
    for (uint32_t s = 0; s < m->state_count; s++)
        say_digits(w, object, m->states[s].name, l->values.initial[s]);
    for (uint32_t i = 0; i < m->expr_count; i++) {
        const fp3_expr *e = &m->exprs[i];
        char name[FP3_NAME_SIZE + 32];
        if (!l->is_read[i] || !e->is_known)
            continue;
        if (e->op == FP3_EXPR_PARAM)
            snprintf(name, sizeof name, "%s", m->params[e->index].name);
        else
            snprintf(name, sizeof name, "a number in line %" PRIu32, e->line);
        say_digits(w, object, name, l->exact[i]);
    }
}

/* The first expression that underflows, or the first root of what is too small for one; operands do
 * not underflow. */
static uint32_t line_of_underflow(const fp3_run_loss *l, double *value) {
    for (uint32_t i = 0; i < l->model->expr_count; i++) {
        const fp3_expr *e = &l->model->exprs[i];
        const int is_root = is_tiny_root(l, e);
        if (l->is_needed[i] && (is_spoiled(l, l->exact[i]) || is_root)) {
            *value = l->exact[is_root ? e->operand[0] : i];
            return e->line;
        }
    }
    return 0;
}

static double size_of(const fp3_run_loss *l, uint32_t state) {
    const double own = fmax(fabs(l->states[state]), fabs(l->values.initial[state]));
    return l->part.program->sees_others ? fmax(own, l->common[state]) : own;
}

/* Returns whether it said something. */
static int warn_of_underflow(warner *w, size_t object) {
    const fp3_run_loss *l = w->loss;
    const fp3_model *m = l->model;
    for (uint32_t s = 0; s < m->state_count; s++) {
        const double size = size_of(l, s);
        if (!(l->lost[s] > w->bound * size))
            continue;
        const uint32_t of = m->states[s].derivative;
        double value = 0;
        const uint32_t line = line_of_underflow(l, &value);
        warn(w,
             "object %zu: %s' is %.3g, but FP32 makes it %.3g: a value of %.3g in line %" PRIu32
             " is too small for FP32; scale the equations",
             object, m->states[s].name, l->exact[of], l->clipped[of], value, line);
        return 1;
    }
    return 0;
}

static int warn_of_standstill(warner *w, size_t object) {
    fp3_run_loss *l = w->loss;
    const fp3_point at = point_of(l, l->states);
    char text[FP3_STANDSTILL_TEXT_SIZE];
    if (!fp3_model_standstill(l->model, &at, l->values.h, l->span, w->bound, l->room, text))
        return 0;
    warn(w, "object %zu: %s; use --compensated or a longer step", object, text);
    return 1;
}

/* Each kind is said of the first object that has it. */
fp3_status fp3_run_loss_warn(fp3_run_loss *l, fp3_run_say_fn *say, const char *path, double bound,
                             size_t *warnings, fp3_error *error) {
    warner w = {.loss = l, .say = say, .path = path, .bound = bound};
    int has_underflow = 0;
    int has_standstill = l->is_adaptive || l->part.program->compiled->arithmetic != FP3_PLAIN;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < l->looked; i++) {
        const size_t object = l->part.first + i;
        status = look(l, i, error);
        if (!status && (i == 0 || (!w.warnings && l->values.is_spread)))
            warn_of_digits(&w, object);
        if (!status && !has_underflow)
            has_underflow = warn_of_underflow(&w, object);
        if (!status && !has_standstill)
            has_standstill = warn_of_standstill(&w, object);
    }
    *warnings += w.warnings;
    return status;
}

/* ---- what failed ---- */

/* Sines end at 2^16 (compiler/functions/circular.c). An attempt that goes beyond is rejected: then
 * the object is a little before it. */
#define ANGLE_END 0x1p16
#define ANGLE_SIZE (0.999 * ANGLE_END)

static const char *name_of_circular(fp3_expr_op op) {
    return op == FP3_EXPR_SIN   ? "sin"
           : op == FP3_EXPR_COS ? "cos"
           : op == FP3_EXPR_TAN ? "tan"
                                : NULL;
}

/* Returns whether it said something. */
static int warn_of_angle(warner *w, size_t object) {
    const fp3_run_loss *l = w->loss;
    for (uint32_t i = 0; i < l->model->expr_count; i++) {
        const fp3_expr *e = &l->model->exprs[i];
        const char *name = e->is_known || !l->is_needed[i] ? NULL : name_of_circular(e->op);
        const double angle = name ? l->exact[e->operand[0]] : 0;
        if (fabs(angle) >= ANGLE_SIZE) {
            warn(w,
                 "object %zu: the argument of %s in line %" PRIu32
                 " is %.9g at the end, and a program computes %s below %.0f only; make the angle a "
                 "state, and let `when x > pi: x = x - 2*pi` remove whole turns",
                 object, name, e->line, angle, name, ANGLE_END);
            return 1;
        }
    }
    return 0;
}

fp3_status fp3_run_loss_warn_failed(fp3_run_loss *l, fp3_run_say_fn *say, const char *path,
                                    fp3_error *error) {
    warner w = {.loss = l, .say = say, .path = path};
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && !w.warnings && i < l->looked; i++) {
        status = look(l, i, error);
        if (!status)
            warn_of_angle(&w, l->part.first + i);
    }
    return status;
}
