/* SPDX-License-Identifier: Apache-2.0 */
/* runge_kutta.c - stages, and sums of slopes. */
#include "runge_kutta.h"

#include "weights.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FOLDED_MOST 5        /* different numbers, of a table for pairs */
#define ESTIMATE_LEAST 1e-12 /* what is left of equal weights that were written as fractions */

/* A row of the table, without its zeros as a rule. */
typedef struct {
    double c;
    term slope;
} summand;

typedef struct {
    fp3_advance *a;
    term *stage, *slope; /* [place * state_count + state], where has_... */
    char *has_stage, *has_slope;
} runge_kutta;

static dag *values(const runge_kutta *r) { return &r->a->step->values; }
static fp3_notes *notes(const runge_kutta *r) { return &r->a->step->notes; }

static const char *name_of(const runge_kutta *r, uint32_t state) {
    return fp3_advance_name(r->a, state);
}

static uint32_t cell(const runge_kutta *r, uint32_t place, uint32_t state) {
    return place * r->a->step->model->state_count + state;
}

static term held(const runge_kutta *r, uint32_t state) {
    return fp3_advance_held(r->a, values(r), ROLE_STATE, state);
}

/* Numbers of the table that are no 0, whatever their sign. */
static unsigned different(const fp3_integrator *table) {
    double seen[FP3_STAGES_MAX * (FP3_STAGES_MAX + 1)];
    unsigned count = 0;
    for (unsigned i = 0; i <= table->stages; i++)
        for (unsigned j = 0; j < table->stages; j++) {
            const double c = fabs(i < table->stages ? table->a[i][j] : table->b[j]);
            unsigned k = 0;
            while (k < count && seen[k] != c)
                k++;
            if (c != 0 && k == count)
                seen[count++] = c;
        }
    return count;
}

/* Slopes are without h, which is in the coefficients, or in a product for each row (adaptive
 * steps). A product of pairs is expensive, but each coefficient with h takes four constants. */
static int is_folded(const runge_kutta *r) {
    return r->a->is_adaptive || fp3_has_pass(r->a->options, FP3_PASS_FOLD_STEP) ||
           (r->a->options->arithmetic == FP3_DOUBLE_SINGLE &&
            different(r->a->integrator) <= FOLDED_MOST);
}

/* A number of the table; where h is folded in, times h. */
static term coefficient(const runge_kutta *r, double c) {
    return fp3_advance_scaled_step(r->a, c, is_folded(r) ? 1 : 0);
}

/* Whether a state gets its slopes one by one. Not with adaptive steps, whose h is outside the sum,
 * nor compensated, where the kept rounding error is that of the whole increment. */
static int has_own_weights(const runge_kutta *r) {
    return fp3_has_pass(r->a->options, FP3_PASS_OWN_WEIGHTS) && !r->a->is_adaptive &&
           r->a->options->arithmetic != FP3_COMPENSATED;
}

/* ---- sums of slopes ---- */

static term sum_of(const runge_kutta *r, const summand *list, unsigned count, int is_scaled) {
    dag *g = values(r);
    term sum = {0};
    for (unsigned i = 0; i < count; i++) {
        const double c = list[i].c;
        term factor = is_scaled ? fp3_term(fp3_dag_number(g, fabs(c))) : coefficient(r, fabs(c));
        term t = fp3_term_mul(g, factor, list[i].slope);
        if (c < 0)
            t = fp3_term_negated(t);
        sum = i ? fp3_term_add(g, sum, t) : t;
    }
    return sum;
}

static unsigned factors(const summand *list, unsigned count, double unit) {
    unsigned found = 0;
    for (unsigned i = 0; i < count; i++)
        found += fabs(list[i].c) != unit;
    return found;
}

/* The smallest coefficient, if all others are whole multiples and the common factor leaves fewer
 * products: (k1 + 2 k2 + 2 k3 + k4)/6. Else 0. */
static double common_factor(const runge_kutta *r, summand *list, unsigned count) {
    double unit = INFINITY;
    for (unsigned i = 0; i < count; i++)
        if (list[i].c != 0 && fabs(list[i].c) < unit)
            unit = fabs(list[i].c);
    if (count < 2 || !isfinite(unit) || fp3_has_pass(r->a->options, FP3_PASS_OWN_WEIGHTS))
        return 0;
    for (unsigned i = 0; i < count; i++)
        if (fabs(list[i].c / unit - round(list[i].c / unit)) > 1e-9)
            return 0;
    const unsigned plain = is_folded(r) ? factors(list, count, INFINITY) : factors(list, count, 1);
    if (factors(list, count, unit) + (unit != 1 || is_folded(r)) >= plain)
        return 0;
    for (unsigned i = 0; i < count; i++)
        list[i].c = round(list[i].c / unit) * unit;
    return unit;
}

/* The first coefficient, which is taken out of all others: (c1 h) (k1 + c2/c1 k2 + ...). The
 * product in front is the same for all states, where h is a value of the object. */
static double take_first(summand *list, unsigned count) {
    unsigned first = 0;
    while (first + 1 < count && list[first].c == 0)
        first++;
    const double c = list[first].c;
    for (unsigned i = 0; i < count; i++)
        list[i].c /= c;
    return c;
}

/* The factor that stands in front of a row's sum, taken out of its coefficients. 0: none does. */
static double take_factor(const runge_kutta *r, summand *list, unsigned count) {
    if (r->a->is_adaptive)
        return take_first(list, count);
    const double unit = common_factor(r, list, count);
    for (unsigned i = 0; unit != 0 && i < count; i++)
        list[i].c = round(list[i].c / unit);
    return unit;
}

/* What a row of the table adds to the state. */
static term increment(const runge_kutta *r, summand *list, unsigned count) {
    const double unit = take_factor(r, list, count);
    if (unit == 0)
        return sum_of(r, list, count, 0);
    return fp3_term_mul(values(r), coefficient(r, unit), sum_of(r, list, count, 1));
}

/* base + c1 k1 + c2 k2 + ..., from the left; the last sum has the note `whole`. */
static term added(const runge_kutta *r, uint32_t state, const summand *list, unsigned count,
                  uint32_t whole) {
    dag *g = values(r);
    term sum = held(r, state);
    for (unsigned i = 0; i < count; i++) {
        if (i + 1 == count)
            g->note = whole;
        sum = fp3_term_add(g, sum, fp3_term_mul(g, coefficient(r, list[i].c), list[i].slope));
    }
    return sum;
}

/* Likewise, or with the common factor taken out. */
static term stage_sum(const runge_kutta *r, uint32_t state, uint32_t place, summand *list,
                      unsigned count) {
    dag *g = values(r);
    const char *name = name_of(r, state);
    summand copy[FP3_STAGES_MAX];
    memcpy(copy, list, count * sizeof *list);
    const int has_factor = r->a->is_adaptive || common_factor(r, copy, count) != 0;
    const uint32_t whole = fp3_note(notes(r), "%s at stage %" PRIu32, name, place + 1);
    g->note = has_factor || count > 1
                  ? fp3_note(notes(r), "%s at stage %" PRIu32 ", in part", name, place + 1)
                  : whole;
    if (has_factor) {
        const term d = increment(r, list, count);
        g->note = whole;
        return fp3_term_add(g, held(r, state), d);
    }
    return added(r, state, list, count, whole);
}

/* ---- stages ---- */

static term slope_of(runge_kutta *r, uint32_t place, uint32_t state);

/* A coefficient 0 has no term: 0 k is not 0 where k is infinite. Without the pass it has one. */
static unsigned row(runge_kutta *r, const double *c, unsigned count, uint32_t state,
                    summand *list) {
    unsigned n = 0;
    for (unsigned j = 0; j < count; j++)
        if (c[j] != 0 || !fp3_has_pass(r->a->options, FP3_PASS_ZERO))
            list[n++] = (summand){c[j], slope_of(r, j, state)};
    return n;
}

static int is_late(const runge_kutta *r, uint32_t state) {
    return r->a->integrator->is_position_late && fp3_fit_is_position(r->a->fit, state);
}

/* The last stage of a pair is at the new state itself: only then do its slopes serve the next step.
 */
static int is_at_new(const runge_kutta *r, uint32_t place) {
    const fp3_integrator *integrator = r->a->integrator;
    return r->a->is_chosen && integrator->is_first_same_as_last && place + 1 == integrator->stages;
}

static term state_at(lowering *l, uint32_t state) {
    runge_kutta *r = l->user;
    const uint32_t i = cell(r, l->index, state);
    if (l->index == 0 || is_late(r, state) || fp3_advance_rests(r->a, state))
        return held(r, state);
    if (is_at_new(r, l->index))
        return r->a->now[state];
    if (!r->has_stage[i]) {
        const uint32_t outside = values(r)->note;
        summand list[FP3_STAGES_MAX];
        const unsigned n = row(r, r->a->integrator->a[l->index], l->index, state, list);
        r->stage[i] = stage_sum(r, state, l->index, list, n);
        r->has_stage[i] = 1;
        values(r)->note = outside;
    }
    return r->stage[i];
}

static term slope_of(runge_kutta *r, uint32_t place, uint32_t state) {
    const uint32_t i = cell(r, place, state);
    if (!r->has_slope[i]) {
        const uint32_t derivative = r->a->step->model->states[state].derivative;
        const term f = fp3_lower(&r->a->places[place], derivative);
        const uint32_t outside = values(r)->note;
        values(r)->note = fp3_note(notes(r), "k%" PRIu32 " of %s = h*%s'", place + 1,
                                   name_of(r, state), name_of(r, state));
        r->slope[i] =
            is_folded(r) ? f : fp3_term_mul(values(r), fp3_advance_scaled_step(r->a, 1, 1), f);
        r->has_slope[i] = 1;
        values(r)->note = outside;
    }
    return r->slope[i];
}

/* ---- the step ---- */

static double sum_of_weights(const summand *list, unsigned count) {
    double sum = 0;
    for (unsigned i = 0; i < count; i++)
        sum += list[i].c;
    return sum;
}

/* Compensated, the increment of a state, with the earlier rounding error: its weights are exact. A
 * common factor that FP32 does not have stays inside, because only weights that are no integers
 * have room for its error: 2 - 2^-23 for 2 rounds most products to the same side. */
static term increment_kept(const runge_kutta *r, uint32_t s, summand *list, unsigned count) {
    dag *g = values(r);
    summand taken[FP3_STAGES_MAX];
    double weights[FP3_STAGES_MAX];
    memcpy(taken, list, count * sizeof *list);
    const double unit = take_factor(r, taken, count);
    const int has_factor =
        r->a->is_adaptive || (double)(float)unit * sum_of_weights(taken, count) == 1;
    if (has_factor)
        memcpy(list, taken, count * sizeof *list);
    for (unsigned i = 0; i < count; i++)
        weights[i] = list[i].c;
    fp3_weights(r->a, weights, NULL, count, has_factor ? 1 / (double)(float)unit : 1);
    for (unsigned i = 0; i < count; i++)
        list[i].c = weights[i];
    if (has_factor)
        return fp3_advance_with_lost(
            r->a, s, fp3_term_mul(g, coefficient(r, unit), sum_of(r, list, count, 1)));
    term rest = r->a->lost[s];
    for (unsigned i = 0; i < count; i++)
        rest = fp3_term_sub(g, rest, fp3_term_mul(g, coefficient(r, list[i].c), list[i].slope));
    return fp3_term_negated(rest);
}

static void advance_early(runge_kutta *r, uint32_t s) {
    if (fp3_advance_rests(r->a, s))
        return;
    const fp3_integrator *integrator = r->a->integrator;
    summand list[FP3_STAGES_MAX];
    const unsigned n = row(r, integrator->b, integrator->stages, s, list);
    const uint32_t new_state = fp3_note(notes(r), "new %s", name_of(r, s));
    values(r)->note = fp3_note(notes(r), "what is added to %s", name_of(r, s));
    if (has_own_weights(r)) {
        r->a->now[s] = added(r, s, list, n, new_state);
        return;
    }
    const int is_compensated = r->a->options->arithmetic == FP3_COMPENSATED;
    const term d = is_compensated ? increment_kept(r, s, list, n) : increment(r, list, n);
    values(r)->note = new_state;
    r->a->now[s] = is_compensated ? fp3_advance_keep(r->a, s, held(r, s), d)
                                  : fp3_term_add(values(r), held(r, s), d);
}

/* A late position moves by the new velocity: s + h v1. */
static void advance_late(runge_kutta *r, uint32_t s) {
    const uint32_t v = r->a->step->model->states[s].velocity;
    values(r)->note =
        fp3_note(notes(r), "new %s = %s + h*%s", name_of(r, s), name_of(r, s), name_of(r, v));
    const term d = fp3_term_mul(values(r), fp3_advance_scaled_step(r->a, 1, 1), r->a->now[v]);
    r->a->now[s] = fp3_advance_update(r->a, s, held(r, s), d);
}

/* For pairs, an estimate in floats: its weights add up to 0, so k_i - k_1 can replace k_i; the
 * first word of the difference includes what the first word of k_i has lost. */
static unsigned of_differences(dag *g, summand *list, unsigned count) {
    const term first = list[0].slope;
    for (unsigned i = 1; i < count; i++) {
        const term d = fp3_term_sub(g, list[i].slope, first);
        list[i - 1] = (summand){list[i].c, {fp3_dag_first(g, d.node), d.is_negative}};
    }
    return count - 1;
}

/* The distance of the two methods of a pair. */
static void estimate(runge_kutta *r, uint32_t s) {
    const fp3_integrator *integrator = r->a->integrator;
    double c[FP3_STAGES_MAX];
    summand list[FP3_STAGES_MAX];
    for (unsigned i = 0; i < integrator->stages; i++)
        c[i] = fabs(integrator->b[i] - integrator->embedded[i]) < ESTIMATE_LEAST
                   ? 0
                   : integrator->b[i] - integrator->embedded[i];
    unsigned n = row(r, c, integrator->stages, s, list);
    values(r)->note = fp3_note(notes(r), "error of %s", name_of(r, s));
    if (values(r)->is_abstract)
        n = of_differences(values(r), list, n);
    r->a->error_scale = fp3_advance_scaled_step(r->a, take_first(list, n), 1);
    r->a->error[s] = sum_of(r, list, n, 1);
    r->a->has_slope = integrator->is_first_same_as_last;
    if (r->a->has_slope)
        r->a->slope[s] = fp3_lower(&r->a->places[integrator->stages - 1],
                                   r->a->step->model->states[s].derivative);
}

/* Before sums of that stage: those where states are within the step, or the new ones. */
static void show_stages(runge_kutta *r, int are_new) {
    for (uint32_t i = 0; i < r->a->integrator->stages; i++)
        if (is_at_new(r, i) == are_new)
            fp3_advance_show(r->a, &r->a->places[i]);
}

fp3_status fp3_runge_kutta(fp3_advance *a, fp3_error *error) {
    const uint32_t states = a->step->model->state_count;
    const size_t cells = (size_t)a->integrator->stages * states + 1u;
    runge_kutta r = {.a = a,
                     .stage = calloc(cells, sizeof *r.stage),
                     .slope = calloc(cells, sizeof *r.slope),
                     .has_stage = calloc(cells, 1),
                     .has_slope = calloc(cells, 1)};
    fp3_status status =
        r.stage && r.slope && r.has_stage && r.has_slope ? FP3_OK : fp3_no_memory(error);
    if (!status)
        status = fp3_advance_places(a, a->integrator->stages, "k", state_at, &r, error);
    for (uint32_t i = 0; !status && a->fit->has_time && i < a->integrator->stages; i++)
        a->places[i].time = fp3_advance_time(a, values(&r), a->integrator->c[i]);
    if (!status)
        show_stages(&r, 0);
    for (int late = 0; !status && late < 2; late++)
        for (uint32_t s = 0; s < states; s++)
            if (fp3_fit_is_moved(a->fit, s) && is_late(&r, s) == late)
                (late ? advance_late : advance_early)(&r, s);
    if (!status)
        show_stages(&r, 1);
    for (uint32_t s = 0; !status && a->is_chosen && s < states; s++)
        if (fp3_fit_is_moved(a->fit, s) && !fp3_advance_rests(a, s))
            estimate(&r, s);
    free(r.stage);
    free(r.slope);
    free(r.has_stage);
    free(r.has_slope);
    return status;
}
