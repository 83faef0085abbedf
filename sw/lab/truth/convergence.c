/* SPDX-License-Identifier: Apache-2.0 */
/* convergence.c - error against time step. */
#include <fp3/convergence.h>
#include <fp3/truth.h>
#include <fp3/tune.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "base/number.h"
#include "language/evaluate.h"
#include "path.h"

#define SAMPLES 32            /* of the truth, for the scale */
#define ABOVE_NOISE 5         /* as squares it is then 4 % of the error */
#define METHOD_LEAST 1e-10    /* the truth is good to about a hundredth of it */
#define ONLY_NOISE 3000       /* finer steps have nothing to tell */
#define POLYNOMIAL_LEAST 1e-5 /* ... where functions are polynomials, and the truth has others */
#define METHOD_SMALL 1e-4
#define ERROR_MOST 0.2 /* of the scale: beyond it there is no order to see */

/* A state that is 0 at all samples may be another between them. */
static fp3_status find_short_ones(fp3_ladder *l, double span, fp3_error *error) {
    const uint32_t states = l->model->state_count;
    uint32_t unknown = 0, known = 0;
    for (uint32_t s = 0; s < states; s++)
        unknown += l->scale[s] == 0;
    if (!unknown)
        return FP3_OK;
    double *at = calloc(states + 1u, sizeof *at), *sizes = calloc(states + 1u, sizeof *sizes);
    fp3_status status =
        at ? fp3_model_truths(l->model, l->params, l->initial, &span, 1, at, sizes, error)
           : fp3_no_memory(error);
    for (uint32_t s = 0; !status && s < states; s++) {
        if (l->scale[s] == 0)
            l->scale[s] = sizes[s];
        known += l->scale[s] > 0;
    }
    free(at);
    free(sizes);
    return status || known
               ? status
               : fp3_fail(error, FP3_E_ARGUMENT,
                          "every state is 0 up to time %.9g, so no error can be relative to its "
                          "size",
                          span);
}

/* The largest magnitude of each state along the truth. */
static fp3_status find_scale(fp3_ladder *l, double span, fp3_error *error) {
    const uint32_t states = l->model->state_count;
    double *rows = calloc(SAMPLES * states + 1u, sizeof *rows), times[SAMPLES];
    for (int i = 0; i < SAMPLES; i++)
        times[i] = span * (i + 1) / SAMPLES;
    fp3_status status =
        rows ? fp3_model_truths(l->model, l->params, l->initial, times, SAMPLES, rows, NULL, error)
             : fp3_no_memory(error);
    for (uint32_t s = 0; !status && s < states; s++) {
        l->scale[s] = fabs(l->initial[s]);
        for (int i = 0; i < SAMPLES; i++)
            l->scale[s] = fmax(l->scale[s], fabs(rows[(uint32_t)i * states + s]));
    }
    free(rows);
    return status ? status : find_short_ones(l, span, error);
}

static uint64_t steps_at(const fp3_ladder *l, unsigned rung, unsigned look) {
    return l->steps[rung] * (look + 1) / FP3_LOOKS;
}

static fp3_status find_truth(fp3_ladder *l, unsigned rung, fp3_error *error) {
    double times[FP3_LOOKS];
    l->truth[rung] = calloc((size_t)FP3_LOOKS * l->model->state_count + 1u, sizeof(double));
    if (!l->truth[rung])
        return fp3_no_memory(error);
    for (unsigned i = 0; i < FP3_LOOKS; i++)
        times[i] = (double)l->h[rung] * (double)steps_at(l, rung, i);
    return fp3_model_truths(l->model, l->params, l->initial, times, FP3_LOOKS, l->truth[rung], NULL,
                            error);
}

/* Each rung has about 1.4 times the steps of the one before. */
static fp3_status climb(fp3_ladder *l, double span, uint64_t most, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned k = 0; !status && l->count < FP3_RUNGS_MOST; k++) {
        const double steps = FP3_LOOKS * round(pow(2, k / 2.0));
        if (steps > (double)most)
            break;
        if (l->count && steps == (double)l->steps[l->count - 1])
            continue;
        const unsigned i = l->count++;
        l->steps[i] = (uint64_t)steps;
        l->h[i] = (float)(span / steps);
        status = find_truth(l, i, error);
    }
    return status;
}

static fp3_status round_all(const fp3_quantity *quantities, uint32_t count, double *values,
                            fp3_error *error) {
    for (uint32_t i = 0; i < count; i++) {
        float single;
        const char *expected = fp3_number_single(quantities[i].value, &single);
        if (expected)
            return fp3_fail(error, FP3_E_PROGRAM, "line %u: '%s' is %g: expected %s",
                            quantities[i].line, quantities[i].name, quantities[i].value, expected);
        values[i] = single;
    }
    return FP3_OK;
}

static fp3_status fill(fp3_ladder *l, double span, uint64_t most_steps, fp3_error *error) {
    const fp3_model *model = l->model;
    l->params = calloc(model->param_count + 1u, sizeof(double));
    l->initial = calloc(model->state_count + 1u, sizeof(double));
    l->scale = calloc(model->state_count + 1u, sizeof(double));
    l->sizes = calloc(model->state_count + 1u, sizeof(double));
    l->span = span;
    if (!l->params || !l->initial || !l->scale || !l->sizes)
        return fp3_no_memory(error);
    /* The object starts at FP32 numbers: what they are rounded from would be another object. */
    fp3_status status = round_all(model->params, model->param_count, l->params, error);
    if (!status)
        status = round_all(model->states, model->state_count, l->initial, error);
    if (!status)
        status = find_scale(l, span, error);
    if (!status)
        status = fp3_path_open(model, l->params, l->initial, span, l->sizes, &l->path, error);
    return status ? status : climb(l, span, most_steps, error);
}

fp3_status fp3_ladder_open(const fp3_model *model, double span, uint64_t most_steps,
                           fp3_ladder **ladder, fp3_error *error) {
    FP3_HOST;
    *ladder = NULL;
    const fp3_status alone = fp3_model_check_alone(model, error);
    if (alone)
        return alone;
    *ladder = calloc(1, sizeof **ladder);
    if (!*ladder)
        return fp3_no_memory(error);
    (*ladder)->model = model;
    fp3_status status = fill(*ladder, span == 0 ? model->span : span, most_steps, error);
    if (status)
        fp3_ladder_close(ladder);
    return status;
}

void fp3_ladder_close(fp3_ladder **ladder) {
    fp3_ladder *l = *ladder;
    if (!l)
        return;
    free(l->params);
    free(l->initial);
    free(l->scale);
    free(l->sizes);
    fp3_path_close(&l->path);
    for (unsigned i = 0; i < l->count; i++)
        free(l->truth[i]);
    free(l);
    *ladder = NULL;
}

/* The distance of two runs, in units of how large each state gets. */
static double distance(const fp3_ladder *l, const double *one, const double *other) {
    const uint32_t count = l->model->state_count;
    double sum = 0;
    unsigned terms = 0;
    for (uint32_t i = 0; i < FP3_LOOKS * count; i++)
        if (l->scale[i % count] > 0) {
            const double d = (one[i] - other[i]) / l->scale[i % count];
            sum += d * d;
            terms++;
        }
    return sqrt(sum / (terms ? terms : 1));
}

/* Slope of log(error) over log(h) from rung a to rung b, by least squares. */
static double slope(const fp3_ladder *l, const double *error, unsigned a, unsigned b) {
    double n = b - a + 1, x = 0, y = 0, xx = 0, xy = 0;
    for (unsigned i = a; i <= b; i++) {
        const double u = log(l->h[i]), v = log(error[i]);
        x += u, y += v, xx += u * u, xy += u * v;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

/* A factor of 4 in h for low orders, of 2 for high ones. */
static unsigned width_for(unsigned order) { return order > 4 ? 2 : order > 2 ? 3 : 4; }

/* The finest window in which each error is above its limit; 0: there is none. */
static int find_window(const fp3_ladder *l, const double *error, const double *limit,
                       unsigned order, unsigned *from, unsigned *to) {
    const unsigned width = width_for(order);
    unsigned run = 0;
    int is_found = 0;
    for (unsigned i = 0; i < l->count; i++) {
        run = isfinite(error[i]) && error[i] < ERROR_MOST && error[i] > limit[i] ? run + 1 : 0;
        if (run > width) {
            *from = i - width;
            *to = i;
            is_found = 1;
        }
    }
    return is_found;
}

/* A power with another exponent than an integer may be one. */
static int is_polynomial(const fp3_model *model, const fp3_expr *e) {
    if (e->op != FP3_EXPR_POWER)
        return fp3_ode_has_constants(e->op);
    const fp3_expr *exponent = &model->exprs[e->operand[1]];
    return exponent->op != FP3_EXPR_NUMBER || exponent->number != floor(exponent->number);
}

/* Marks what a step computes: not what stands in invariants and closed forms alone. */
static void mark_computed(const fp3_model *model, char *is_computed) {
    for (uint32_t i = 0; i < model->state_count; i++)
        is_computed[model->states[i].derivative] = 1;
    for (uint32_t i = 0; i < model->event_count; i++)
        is_computed[model->events[i].condition] = 1;
    for (uint32_t i = 0; i < model->assignment_count; i++)
        is_computed[model->assignments[i].expr] = 1;
    for (uint32_t i = model->expr_count; i-- > 0;)
        for (int k = 0; is_computed[i] && k < 3; k++)
            if (model->exprs[i].operand[k] != FP3_NONE)
                is_computed[model->exprs[i].operand[k]] = 1;
}

static int has_polynomials(const fp3_model *model) {
    char *is_computed = calloc(model->expr_count + 1u, sizeof *is_computed);
    int has = !is_computed;
    if (is_computed)
        mark_computed(model, is_computed);
    for (uint32_t i = 0; i < model->expr_count && !has; i++)
        has = is_computed[i] && !model->exprs[i].is_known && is_polynomial(model, &model->exprs[i]);
    free(is_computed);
    return has;
}

static void measure(const fp3_ladder *l, unsigned order, fp3_convergence *c) {
    double limit[FP3_RUNGS_MOST];
    unsigned from, to;
    c->order = c->method_order = c->finest_order = NAN;
    for (unsigned i = 0; i < l->count; i++)
        limit[i] = isfinite(c->noise[i]) ? ABOVE_NOISE * c->noise[i] : INFINITY;
    if (find_window(l, c->method, limit, order, &c->from, &c->to)) {
        c->order = slope(l, c->error, c->from, c->to);
        c->method_order = slope(l, c->method, c->from, c->to);
    }
    for (unsigned i = 0; i < l->count; i++)
        limit[i] = has_polynomials(l->model) ? POLYNOMIAL_LEAST : METHOD_LEAST;
    if (find_window(l, c->method, limit, order, &from, &to))
        c->finest_order = slope(l, c->method, from, to);
}

/* Those that an error is looked for after, and the eight of a truth; returns how many, and eight[j]
 * is the place of look j. */
static size_t list_looks(const fp3_ladder *l, unsigned rung, uint64_t *steps, size_t *eight) {
    const uint64_t every = fp3_path_every(l->steps[rung]);
    size_t count = 0;
    uint64_t now = 0;
    for (unsigned j = 0; j < FP3_LOOKS; j++) {
        const uint64_t until = steps_at(l, rung, j);
        while ((now / every + 1) * every < until)
            steps[count++] = now = (now / every + 1) * every;
        eight[j] = count;
        steps[count++] = now = until;
    }
    return count;
}

static double largest_of(const fp3_ladder *l, unsigned rung, const uint64_t *steps, size_t count,
                         const double *rows, double *room) {
    const fp3_path_scale scale = {l->sizes, l->span, room};
    double worst = 0;
    for (size_t i = 0; i < count; i++)
        worst = fmax(worst, fp3_path_error(l->path, &scale, (double)l->h[rung] * (double)steps[i],
                                           rows + i * l->model->state_count));
    return worst;
}

/* Room for the looks at a run; the most there are: up to 2,047, and those of the eight that are
 * beside them. */
typedef struct {
    uint64_t *steps;
    float *first, *low;
    double *rows, *fp32, *exact, *room;
} looks;

#define LOOKS_MOST (2u * FP3_TUNE_LOOKS + FP3_LOOKS)

static fp3_status look(const fp3_ladder *l, const fp3_compiled *compiled, unsigned rung, looks *k,
                       double *largest, fp3_error *error) {
    const size_t states = l->model->state_count;
    size_t eight[FP3_LOOKS];
    const size_t count = list_looks(l, rung, k->steps, eight);
    const fp3_status status = fp3_compiled_reference_pairs(
        compiled, l->params, l->initial, l->h[rung], k->steps, count, k->first, k->low, error);
    for (size_t i = 0; i < count * states; i++)
        k->rows[i] = (double)k->first[i] + (double)k->low[i];
    for (size_t j = 0; j < FP3_LOOKS; j++)
        memcpy(k->fp32 + j * states, k->rows + eight[j] * states, states * sizeof *k->fp32);
    *largest = largest_of(l, rung, k->steps, count, k->rows, k->room);
    return status;
}

static fp3_status converge_at(const fp3_ladder *l, const fp3_compiled *compiled, unsigned i,
                              looks *k, fp3_convergence *c, fp3_error *error) {
    uint64_t steps[FP3_LOOKS];
    for (unsigned j = 0; j < FP3_LOOKS; j++)
        steps[j] = steps_at(l, i, j);
    fp3_status status = look(l, compiled, i, k, &c->largest[i], error);
    if (!status)
        status = fp3_compiled_exact(compiled, l->params, l->initial, l->h[i], steps, FP3_LOOKS,
                                    k->exact, error);
    c->error[i] = distance(l, k->fp32, l->truth[i]);
    c->method[i] = distance(l, k->exact, l->truth[i]);
    c->noise[i] = distance(l, k->fp32, k->exact);
    if (c->error[i] < c->floor) {
        c->floor = c->error[i];
        c->best = i;
    }
    if (c->largest[i] < c->largest_floor) {
        c->largest_floor = c->largest[i];
        c->largest_best = i;
    }
    return status;
}

static int open_looks(looks *k, size_t states) {
    const size_t all = LOOKS_MOST * states + 1u, few = FP3_LOOKS * states + 1u;
    *k = (looks){.steps = calloc(LOOKS_MOST, sizeof *k->steps),
                 .first = calloc(2 * all, sizeof *k->first),
                 .rows = calloc(all + 2 * few + states, sizeof *k->rows)};
    if (!k->steps || !k->first || !k->rows)
        return 0;
    k->low = k->first + all;
    k->fp32 = k->rows + all;
    k->exact = k->fp32 + few;
    k->room = k->exact + few;
    return 1;
}

static void close_looks(looks *k) {
    free(k->steps);
    free(k->first);
    free(k->rows);
}

fp3_status fp3_converge(const fp3_ladder *l, const fp3_compiled *compiled, unsigned order,
                        fp3_convergence *c, fp3_error *error) {
    FP3_HOST;
    looks k;
    fp3_status status = open_looks(&k, l->model->state_count) ? FP3_OK : fp3_no_memory(error);
    *c = (fp3_convergence){.floor = INFINITY, .largest_floor = INFINITY};
    for (unsigned i = 0; i < l->count; i++)
        c->error[i] = c->method[i] = c->noise[i] = c->largest[i] = NAN;
    for (unsigned i = 0; !status && i < l->count; i++) {
        status = converge_at(l, compiled, i, &k, c, error);
        if (c->method[i] < METHOD_SMALL && c->noise[i] > ONLY_NOISE * c->method[i])
            break;
    }
    close_looks(&k);
    measure(l, order, c);
    return status;
}
