/* SPDX-License-Identifier: Apache-2.0 */
/* chebyshev.c - stages by a recurrence: for each state only the last sum and its last change are
 * kept.
 *
 * Both are increments of the state, so roundings are of their size, not of the state's.
 */
#include "chebyshev.h"

#include "weights.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    fp3_advance *a;
    fp3_recurrence table;
    term *slope, *sum, *change; /* of each live state: f at y, E and V of fp3_recurrence */
    term *stage;                /* y + at[j] E */
} chebyshev;

static dag *values(const chebyshev *r) { return &r->a->step->values; }

static int is_moved(const chebyshev *r, uint32_t s) { return fp3_fit_is_moved(r->a->fit, s); }

static term state_at(lowering *l, uint32_t state) {
    const chebyshev *r = l->user;
    if (l->index == r->table.stages) /* for the estimate of the error */
        return r->a->now[state];
    return r->stage[state];
}

static void note(const chebyshev *r, const char *what, uint32_t s, unsigned stage) {
    values(r)->note =
        fp3_note(&r->a->step->notes, "%s of %s, stage %u", what, fp3_advance_name(r->a, s), stage);
}

static term number(const chebyshev *r, double x) {
    return (term){fp3_dag_number(values(r), fabs(x)), x < 0};
}

static term slope_at(const chebyshev *r, unsigned j, uint32_t s) {
    return fp3_lower(&r->a->places[j], r->a->step->model->states[s].derivative);
}

/* The host knows the slope, which is the same in all stages, so the sums are c h times the slope.
 * With the recurrence the host's formula would double with each stage. */
static int is_steady(const chebyshev *r, uint32_t s) {
    return fp3_dag_is_known(values(r), r->slope[s].node) != FP3_NONE;
}

/* at[j] E_j, which is the distance of stage j from y; of the last one to the new y. */
static term increment(const chebyshev *r, unsigned j, uint32_t s) {
    if (is_steady(r, s))
        return fp3_term_mul(
            values(r),
            fp3_advance_scaled_step(r->a, j < r->table.stages ? r->a->integrator->c[j] : 1, 1),
            r->slope[s]);
    return fp3_term_mul(values(r), number(r, r->table.at[j]), r->sum[s]);
}

/* E_stages for V_j+1 = 1, earlier V = 0, and no later slopes. */
static double effect_of(const fp3_recurrence *table, unsigned j) {
    double change = 1, sum = 1;
    while (++j < table->stages) {
        change += (double)(float)table->bend * sum;
        sum += change;
    }
    return sum;
}

/* Where f is the same in all stages, y moves by h f: see weights.h. Only how often f_0 counts is
 * adjusted, which no condition of higher order reads. */
static void fit(const fp3_advance *a, fp3_recurrence *table) {
    double weights[FP3_STAGES_MAX], share[FP3_STAGES_MAX];
    double sum = 1 / (double)(float)table->at[table->stages];
    weights[0] = table->first;
    share[0] = effect_of(table, 0);
    for (unsigned j = 1; j < table->stages; j++) {
        const double added = (double)(float)table->slope[j] * effect_of(table, j);
        weights[j] = table->share[j];
        share[j] = -added;
        sum -= added;
    }
    fp3_weights(a, weights, share, table->stages, sum);
    table->first = weights[0];
    memcpy(table->share + 1, weights + 1, (table->stages - 1) * sizeof *weights);
}

static void begin(const chebyshev *r, uint32_t s) {
    r->slope[s] = slope_at(r, 0, s);
    if (is_steady(r, s))
        return;
    note(r, "first change", s, 1);
    r->sum[s] = r->change[s] =
        fp3_term_mul(values(r), fp3_advance_scaled_step(r->a, r->table.first, 1), r->slope[s]);
}

/* V_j+1: f_j reads the stage, so E_j stays as it is until all states have theirs. */
static void change(const chebyshev *r, unsigned j, uint32_t s) {
    const fp3_recurrence *table = &r->table;
    dag *g = values(r);
    const term f = slope_at(r, j, s);
    note(r, "change", s, j + 1);
    if (table->bend != 0)
        r->change[s] =
            fp3_term_add(g, r->change[s], fp3_term_mul(g, number(r, table->bend), r->sum[s]));
    const term off = fp3_term_sub(g, f, fp3_term_mul(g, number(r, table->share[j]), r->slope[s]));
    r->change[s] = fp3_term_add(
        g, r->change[s], fp3_term_mul(g, fp3_advance_scaled_step(r->a, table->slope[j], 1), off));
}

static void make_stage(const chebyshev *r, unsigned j) {
    dag *g = values(r);
    const uint32_t count = r->a->step->model->state_count;
    for (uint32_t s = 0; s < count; s++)
        if (is_moved(r, s)) {
            note(r, "value", s, j);
            r->stage[s] =
                fp3_term_add(g, fp3_advance_held(r->a, g, ROLE_STATE, s), increment(r, j, s));
        }
    fp3_advance_show(r->a, &r->a->places[j]);
    for (uint32_t s = 0; s < count; s++)
        if (is_moved(r, s) && !is_steady(r, s))
            change(r, j, s);
    for (uint32_t s = 0; s < count; s++)
        if (is_moved(r, s) && !is_steady(r, s)) {
            note(r, "sum of changes", s, j + 1);
            r->sum[s] = fp3_term_add(g, r->sum[s], r->change[s]);
        }
}

static term finish(const chebyshev *r, uint32_t s) {
    fp3_advance *a = r->a;
    dag *g = values(r);
    g->note = fp3_note(&a->step->notes, "what is added to %s", fp3_advance_name(a, s));
    const term d = increment(r, r->table.stages, s);
    g->note = fp3_note(&a->step->notes, "new %s", fp3_advance_name(a, s));
    a->now[s] = fp3_advance_update(a, s, fp3_advance_held(a, g, ROLE_STATE, s), d);
    return d;
}

/* WAY (h (f_0 + f_1)/2 - d) */
static void estimate(const chebyshev *r, uint32_t s, term d) {
    fp3_advance *a = r->a;
    dag *g = values(r);
    a->slope[s] = slope_at(r, r->table.stages, s);
    a->has_slope = 1;
    g->note = fp3_note(&a->step->notes, "error of %s", fp3_advance_name(a, s));
    const term way = fp3_term_mul(g, fp3_advance_scaled_step(a, FP3_CHEBYSHEV_WAY / 2, 1),
                                  fp3_term_add(g, r->slope[s], a->slope[s]));
    a->error[s] = fp3_term_sub(g, way, fp3_term_mul(g, number(r, FP3_CHEBYSHEV_WAY), d));
}

static void make_step(const chebyshev *r) {
    fp3_advance *a = r->a;
    const unsigned stages = r->table.stages;
    const uint32_t count = a->step->model->state_count;
    for (uint32_t s = 0; s < count; s++)
        if (is_moved(r, s))
            r->stage[s] = fp3_advance_held(a, values(r), ROLE_STATE, s);
    fp3_advance_show(a, &a->places[0]);
    for (uint32_t s = 0; s < count; s++)
        if (is_moved(r, s))
            begin(r, s);
    for (unsigned j = 1; j < stages; j++)
        make_stage(r, j);
    for (uint32_t s = 0; s < count; s++)
        if (is_moved(r, s))
            r->sum[s] = finish(r, s);
    if (a->is_chosen)
        fp3_advance_show(a, &a->places[stages]);
    for (uint32_t s = 0; a->is_chosen && s < count; s++)
        if (is_moved(r, s))
            estimate(r, s, r->sum[s]);
}

fp3_status fp3_chebyshev(fp3_advance *a, fp3_error *error) {
    const unsigned places = a->integrator->recurrence.stages + (a->is_chosen ? 1 : 0);
    const size_t count = a->step->model->state_count + 1u;
    chebyshev r = {.a = a,
                   .table = a->integrator->recurrence,
                   .slope = calloc(count, sizeof *r.slope),
                   .sum = calloc(count, sizeof *r.sum),
                   .change = calloc(count, sizeof *r.change),
                   .stage = calloc(count, sizeof *r.stage)};
    fp3_status status = r.slope && r.sum && r.change && r.stage ? FP3_OK : fp3_no_memory(error);
    if (!status)
        status = fp3_advance_places(a, places, "k", state_at, &r, error);
    for (unsigned j = 0; !status && a->fit->has_time && j < places; j++)
        a->places[j].time = fp3_advance_time(a, values(&r), a->integrator->c[j]);
    if (!status) {
        fit(a, &r.table);
        make_step(&r);
    }
    free(r.slope);
    free(r.sum);
    free(r.change);
    free(r.stage);
    return status;
}
