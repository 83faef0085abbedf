/* SPDX-License-Identifier: Apache-2.0 */
/* rosenbrock.c - stages that each solve one system of linear equations, all with the same matrix.
 *
 *     (1/(gamma h) - J) u_i = f(y + sum a_ij u_j) + sum (c_ij/h) u_j + gamma_i h f_t,   y += sum
 * m_i u_i
 *
 * where no stage is multiplied with J: Hairer and Wanner, Solving Ordinary Differential Equations
 * II, chapter IV.7, equations (7.25). With the table's alpha, Gamma and b: a = alpha Gamma^-1, c =
 * 1/gamma - Gamma^-1, m = b Gamma^-1.
 */
#include "rosenbrock.h"

#include "compiler/functions/division.h"
#include "compiler/value/ops.h"
#include "lu.h"
#include "weights.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#define NOTHING 1e-13 /* a coefficient that rounding has left of 0 */

typedef struct {
    fp3_advance *a;
    const uint32_t *partial;
    uint32_t states[FP3_LU_MOST], count; /* live ones, in the order of equations */
    double coefficient[FP3_STAGES_MAX][FP3_STAGES_MAX];
    double c[FP3_STAGES_MAX][FP3_STAGES_MAX], m[FP3_STAGES_MAX], sum[FP3_STAGES_MAX];
    double estimate[FP3_STAGES_MAX]; /* the m of b less that of the embedded weights */
    term over_h;                     /* adaptive steps alone */
    term u[FP3_STAGES_MAX][FP3_LU_MOST];
    term stage[FP3_STAGES_MAX][FP3_LU_MOST];
    fp3_lu lu;
} rosenbrock;

static dag *values(const rosenbrock *r) { return &r->a->step->values; }

/* ---- coefficients ---- */

/* Of a lower triangle. */
static void invert(const fp3_integrator *t, double inverse[FP3_STAGES_MAX][FP3_STAGES_MAX]) {
    for (unsigned j = 0; j < t->stages; j++)
        for (unsigned i = 0; i < t->stages; i++) {
            double left = i == j;
            for (unsigned k = j; k < i; k++)
                left -= t->gamma[i][k] * inverse[k][j];
            inverse[i][j] = i < j ? 0 : left / t->gamma[i][i];
        }
}

/* Of the conditions of order 2 one has the matrix in it: sum b_i gamma_ij = 0 leaves it out
 * (Verwer, Spee, Blom and Hundsdorfer, 1999). */
int fp3_rosenbrock_is_free(const fp3_integrator *t) {
    double sum = 0;
    for (unsigned i = 0; i < t->stages; i++)
        for (unsigned j = 0; j < t->stages; j++)
            sum += t->b[i] * t->gamma[i][j];
    return t->kind != FP3_ROSENBROCK || t->order < 2 || (t->order == 2 && fabs(sum) < NOTHING);
}

static double tidy(double x) { return fabs(x) < NOTHING ? 0 : x; }

static void find_coefficients(rosenbrock *r) {
    const fp3_integrator *t = r->a->integrator;
    double inverse[FP3_STAGES_MAX][FP3_STAGES_MAX];
    memset(inverse, 0, sizeof inverse);
    invert(t, inverse);
    for (unsigned i = 0; i < t->stages; i++) {
        for (unsigned j = 0; j < t->stages; j++) {
            double a = 0;
            for (unsigned k = 0; k < t->stages; k++)
                a += t->a[i][k] * inverse[k][j];
            r->coefficient[i][j] = tidy(a);
            r->c[i][j] = j < i ? tidy(-inverse[i][j]) : 0;
            r->m[j] += t->b[i] * inverse[i][j];
            r->estimate[j] += (t->b[i] - t->embedded[i]) * inverse[i][j];
            r->sum[i] += t->gamma[i][j];
        }
        r->sum[i] = tidy(r->sum[i]);
    }
    for (unsigned i = 0; i < t->stages; i++) {
        r->m[i] = tidy(r->m[i]);
        r->estimate[i] = tidy(r->estimate[i]);
    }
}

/* Where f is the same everywhere, y moves by h f: see weights.h. u_i is share[i] h f then. */
static void fit(rosenbrock *r) {
    const fp3_integrator *t = r->a->integrator;
    double share[FP3_STAGES_MAX];
    for (unsigned i = 0; i < t->stages; i++) {
        share[i] = 1;
        for (unsigned j = 0; j < i; j++)
            share[i] += (double)(float)r->c[i][j] * share[j];
        share[i] /= (double)(float)(1 / t->gamma[0][0]);
    }
    fp3_weights(r->a, r->m, share, t->stages, 1);
}

/* ---- sums ---- */

static term of_number(const rosenbrock *r, double x) {
    return (term){fp3_dag_number(values(r), fabs(x)), x < 0};
}

/* coefficient / h */
static term over_step(const rosenbrock *r, double coefficient) {
    known_table *known = &r->a->step->known;
    if (r->a->is_adaptive)
        return fp3_term_mul(values(r), of_number(r, coefficient), r->over_h);
    const uint32_t made = fp3_known_make(
        known, KNOWN_DIV, fp3_known_number(known, fabs(coefficient)), fp3_known_step(known));
    return (term){fp3_dag_known(values(r), made), coefficient < 0};
}

static term plus(const rosenbrock *r, term sum, term factor, term x) {
    return fp3_term_add(values(r), sum, fp3_term_mul(values(r), factor, x));
}

static uint32_t index_of(const rosenbrock *r, uint32_t state) {
    uint32_t i = 0;
    while (i < r->count && r->states[i] != state)
        i++;
    return i;
}

static term state_at(lowering *l, uint32_t state) {
    const rosenbrock *r = l->user;
    return r->stage[l->index][index_of(r, state)];
}

/* ---- the matrix ---- */

static void fill_matrix(rosenbrock *r) {
    const fp3_model *model = r->a->step->model;
    dag *g = values(r);
    fp3_lu_open(&r->lu, g, r->count);
    for (uint32_t i = 0; i < r->count; i++)
        for (uint32_t j = 0; j < r->count; j++) {
            const uint32_t expr =
                r->partial[r->states[i] * (model->state_count + 1u) + r->states[j]];
            term *cell = &r->lu.cell[i][j];
            if (expr != FP3_NONE)
                *cell = fp3_term_negated(fp3_lower(&r->a->places[0], expr));
            if (i != j)
                continue;
            g->note = fp3_note(&r->a->step->notes, "1/(gamma h) - J");
            const term shift = over_step(r, 1 / r->a->integrator->gamma[0][0]);
            *cell = expr == FP3_NONE ? shift : fp3_term_add(g, shift, *cell);
            r->lu.summand[i] = shift;
        }
    g->note = fp3_note(&r->a->step->notes, "factors of 1/(gamma h) - J");
    fp3_lu_factor(&r->lu);
}

/* ---- stages ---- */

static void make_stage(rosenbrock *r, unsigned i) {
    dag *g = values(r);
    for (uint32_t s = 0; s < r->count; s++) {
        term y = fp3_advance_held(r->a, g, ROLE_STATE, r->states[s]);
        g->note = fp3_note(&r->a->step->notes, "%s at stage %u",
                           fp3_advance_name(r->a, r->states[s]), i + 1);
        for (unsigned j = 0; j < i; j++)
            if (r->coefficient[i][j] != 0)
                y = plus(r, y, of_number(r, r->coefficient[i][j]), r->u[j][s]);
        r->stage[i][s] = y;
    }
}

static term right_hand_side(const rosenbrock *r, unsigned i, uint32_t s) {
    const fp3_model *model = r->a->step->model;
    const uint32_t state = r->states[s];
    const uint32_t by_time = r->partial[state * (model->state_count + 1u) + model->state_count];
    term x = fp3_lower(&r->a->places[i], model->states[state].derivative);
    values(r)->note = fp3_note(&r->a->step->notes, "right-hand side of %s at stage %u",
                               fp3_advance_name(r->a, state), i + 1);
    for (unsigned j = 0; j < i; j++)
        if (r->c[i][j] != 0)
            x = plus(r, x, over_step(r, r->c[i][j]), r->u[j][s]);
    if (by_time != FP3_NONE && r->sum[i] != 0)
        x = plus(r, x, fp3_advance_scaled_step(r->a, r->sum[i], 1),
                 fp3_lower(&r->a->places[0], by_time));
    return x;
}

static int is_same_place(const rosenbrock *r, unsigned i, unsigned j) {
    for (unsigned k = 0; k < r->a->integrator->stages; k++)
        if (r->coefficient[i][k] != r->coefficient[j][k])
            return 0;
    return r->a->integrator->c[i] == r->a->integrator->c[j];
}

static void solve_stage(rosenbrock *r, unsigned i) {
    unsigned same = 0;
    while (same < i && !is_same_place(r, i, same))
        same++;
    if (same < i)
        memcpy(r->stage[i], r->stage[same], sizeof r->stage[i]);
    else
        make_stage(r, i);
    fp3_advance_show(r->a, &r->a->places[i]); /* before the sums of that stage */
    for (uint32_t s = 0; s < r->count; s++)
        r->u[i][s] = right_hand_side(r, i, s);
    values(r)->note = fp3_note(&r->a->step->notes, "solution of stage %u", i + 1);
    if (i == 0)
        fill_matrix(r);
    fp3_lu_solve(&r->lu, r->u[i]);
}

/* ---- the step ---- */

static term weighted(const rosenbrock *r, const double *weights, uint32_t s) {
    dag *g = values(r);
    term sum = fp3_term(FP3_NONE);
    for (unsigned i = 0; i < r->a->integrator->stages; i++) {
        if (weights[i] == 0)
            continue;
        const term part = fp3_term_mul(g, of_number(r, weights[i]), r->u[i][s]);
        sum = sum.node == FP3_NONE ? part : fp3_term_add(g, sum, part);
    }
    return sum;
}

static void advance_state(const rosenbrock *r, uint32_t s) {
    fp3_advance *a = r->a;
    dag *g = values(r);
    const uint32_t state = r->states[s];
    g->note = fp3_note(&a->step->notes, "what is added to %s", fp3_advance_name(a, state));
    const term d = weighted(r, r->m, s);
    if (a->is_chosen) {
        g->note = fp3_note(&a->step->notes, "error of %s", fp3_advance_name(a, state));
        a->error[state] = weighted(r, r->estimate, s);
    }
    g->note = fp3_note(&a->step->notes, "new %s", fp3_advance_name(a, state));
    a->now[state] = fp3_advance_update(a, state, fp3_advance_held(a, g, ROLE_STATE, state), d);
}

/* After the end there is no step, and 1 stands for it. */
static term over_own_step(const fp3_advance *a) {
    dag *g = &a->step->values;
    const uint32_t h = fp3_term_value(g, a->h);
    g->note = fp3_note(&a->step->notes, "1/h");
    return fp3_one_over(g, fp3_term(sel(g, h, h, num(g, 1))));
}

static void find_states(rosenbrock *r) {
    for (uint32_t s = 0; s < r->a->step->model->state_count; s++)
        if (fp3_fit_is_moved(r->a->fit, s))
            r->states[r->count++] = s;
}

fp3_status fp3_rosenbrock(fp3_advance *a, const uint32_t *partial, fp3_error *error) {
    const unsigned stages = a->integrator->stages;
    rosenbrock r = {.a = a, .partial = partial};
    find_states(&r);
    const fp3_status status = fp3_advance_places(a, stages, "k", state_at, &r, error);
    if (status)
        return status;
    find_coefficients(&r);
    fit(&r);
    if (a->is_adaptive)
        r.over_h = over_own_step(a);
    for (unsigned i = 0; a->fit->has_time && i < stages; i++)
        a->places[i].time = fp3_advance_time(a, values(&r), a->integrator->c[i]);
    for (unsigned i = 0; i < stages; i++)
        solve_stage(&r, i);
    for (uint32_t s = 0; s < r.count; s++)
        advance_state(&r, s);
    return FP3_OK;
}
