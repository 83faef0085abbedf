/* integrate.c - the steps of integrators, each as its table says, over the derivatives of a model. */
#include "integrate.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static uint32_t at(const build *b, uint32_t place, uint32_t state) {
    return place * b->model->state_count + state;
}

static term known_term(build *b, uint32_t known) { return fp3_term(fp3_graph_known(&b->g, known)); }

/* coefficient * h^n, its sign outside. */
static term scaled_step(build *b, double coefficient, unsigned n) {
    uint32_t known = fp3_known_number(&b->known, fabs(coefficient));
    for (; n; n--)
        known = fp3_known_make(&b->known, KNOWN_MUL, known, fp3_known_step(&b->known));
    term t = known_term(b, known);
    t.is_negative = coefficient < 0;
    return t;
}

static int is_folded(const build *b) { return (b->passes & FP3_PASS(FP3_PASS_FOLD_STEP)) != 0; }

/* A number of a table; where h is folded in, times h. */
static term coefficient(build *b, double c) { return scaled_step(b, c, is_folded(b) ? 1 : 0); }

/* ---- sums of slopes ---- */

typedef struct {
    double c;
    term slope;
} summand;

static term sum_of(build *b, const summand *list, unsigned count, double unit, int is_scaled) {
    graph *g = &b->g;
    term sum = {0};
    for (unsigned i = 0; i < count; i++) {
        const double c = list[i].c / unit;
        term factor = is_scaled ? fp3_term(fp3_graph_number(g, fabs(c))) : coefficient(b, fabs(c));
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

/* The smallest coefficient, where all others are whole multiples of it and fewer products are left
 * when it is taken out: (k1 + 2 k2 + 2 k3 + k4)/6. Else 0. */
static double common_unit(const build *b, summand *list, unsigned count) {
    double unit = INFINITY;
    for (unsigned i = 0; i < count; i++)
        if (fabs(list[i].c) < unit)
            unit = fabs(list[i].c);
    if (count < 2 || !isfinite(unit))
        return 0;
    for (unsigned i = 0; i < count; i++)
        if (fabs(list[i].c / unit - round(list[i].c / unit)) > 1e-9)
            return 0;
    const unsigned plain = is_folded(b) ? factors(list, count, INFINITY) : factors(list, count, 1);
    if (factors(list, count, unit) + (unit != 1 || is_folded(b)) >= plain)
        return 0;
    for (unsigned i = 0; i < count; i++)
        list[i].c = round(list[i].c / unit) * unit;
    return unit;
}

/* What a row of the table adds to the state. */
static term increment(build *b, summand *list, unsigned count) {
    const double unit = common_unit(b, list, count);
    if (unit == 0)
        return sum_of(b, list, count, 1, 0);
    for (unsigned i = 0; i < count; i++)
        list[i].c = round(list[i].c / unit);
    return fp3_term_mul(&b->g, coefficient(b, unit), sum_of(b, list, count, 1, 1));
}

/* base + c1 k1 + c2 k2 + ..., from the left, or with the unit taken out. */
static term stage_sum(build *b, uint32_t state, uint32_t place, summand *list, unsigned count) {
    graph *g = &b->g;
    term sum = fp3_held(b, ROLE_STATE, state);
    summand copy[FP3_STAGES_MAX];
    memcpy(copy, list, count * sizeof *list);
    const int has_unit = common_unit(b, copy, count) != 0;
    const uint32_t whole = fp3_note(b, "%s at stage %" PRIu32, name_of(b, state), place + 1);
    g->note = has_unit || count > 1
                  ? fp3_note(b, "%s at stage %" PRIu32 ", in part", name_of(b, state), place + 1)
                  : whole;
    if (has_unit) {
        const term d = increment(b, list, count);
        g->note = whole;
        return fp3_term_add(g, sum, d);
    }
    for (unsigned i = 0; i < count; i++) {
        if (i + 1 == count)
            g->note = whole;
        sum = fp3_term_add(g, sum, fp3_term_mul(g, coefficient(b, list[i].c), list[i].slope));
    }
    return sum;
}

/* base + d; what is rounded away is kept and taken off the next d (Kahan, 1965). */
static term update(build *b, uint32_t state, term base, term d) {
    graph *g = &b->g;
    if (!b->is_compensated)
        return fp3_term_add(g, base, d);
    const uint32_t new_state = g->note;
    g->note = fp3_note(b, "what is added to %s, with what was lost before", name_of(b, state));
    const term y = fp3_term_sub(g, d, b->lost[state]);
    g->note = new_state;
    const term sum = fp3_term_add(g, base, y);
    g->note = fp3_note(b, "what is lost of %s", name_of(b, state));
    b->lost[state] = fp3_term_sub(g, fp3_term_sub(g, sum, base), y);
    return sum;
}

/* ---- Runge-Kutta ---- */

static term slope_of(build *b, uint32_t place, uint32_t state);

/* A coefficient 0 has no term: 0 k is no 0 where k is infinite. */
static unsigned row(build *b, const double *c, unsigned count, uint32_t state, summand *list) {
    unsigned n = 0;
    for (unsigned j = 0; j < count; j++)
        if (c[j] != 0)
            list[n++] = (summand){c[j], slope_of(b, j, state)};
    return n;
}

static int is_late(const build *b, uint32_t state) {
    return b->integrator->is_position_late && is_position(b, state);
}

static term runge_kutta_state(lowering *l, uint32_t state) {
    build *b = l->user;
    const uint32_t i = at(b, l->place, state);
    if (l->place == 0 || is_late(b, state))
        return fp3_held(b, ROLE_STATE, state);
    if (!b->has_stage[i]) {
        const uint32_t outside = b->g.note;
        summand list[FP3_STAGES_MAX];
        const unsigned n = row(b, b->integrator->a[l->place], l->place, state, list);
        b->stage[i] = stage_sum(b, state, l->place, list, n);
        b->has_stage[i] = 1;
        b->g.note = outside;
    }
    return b->stage[i];
}

static term slope_of(build *b, uint32_t place, uint32_t state) {
    const uint32_t i = at(b, place, state);
    if (!b->has_slope[i]) {
        const term f = fp3_lower(&b->places[place], state_of(b, state)->derivative);
        const uint32_t outside = b->g.note;
        b->g.note = fp3_note(b, "k%" PRIu32 " of %s = h*%s'", place + 1, name_of(b, state),
                             name_of(b, state));
        b->slope[i] = is_folded(b) ? f : fp3_term_mul(&b->g, scaled_step(b, 1, 1), f);
        b->has_slope[i] = 1;
        b->g.note = outside;
    }
    return b->slope[i];
}

static void runge_kutta(build *b) {
    for (uint32_t s = 0; s < b->model->state_count; s++) {
        if (!is_live(b, s) || is_late(b, s))
            continue;
        summand list[FP3_STAGES_MAX];
        const unsigned n = row(b, b->integrator->b, b->integrator->stages, s, list);
        b->g.note = fp3_note(b, "what is added to %s", name_of(b, s));
        const term d = increment(b, list, n);
        b->g.note = fp3_note(b, "new %s", name_of(b, s));
        b->now[s] = update(b, s, fp3_held(b, ROLE_STATE, s), d);
    }
    for (uint32_t s = 0; s < b->model->state_count; s++) {
        if (!is_live(b, s) || !is_late(b, s))
            continue;
        const uint32_t v = state_of(b, s)->velocity;
        b->g.note = fp3_note(b, "new %s = %s + h*%s", name_of(b, s), name_of(b, s), name_of(b, v));
        const term d = fp3_term_mul(&b->g, scaled_step(b, 1, 1), b->now[v]);
        b->now[s] = update(b, s, fp3_held(b, ROLE_STATE, s), d);
    }
}

/* ---- splittings ---- */

static term splitting_state(lowering *l, uint32_t state) { return ((build *)l->user)->now[state]; }

static void splitting(build *b) {
    term d[BUILD_STATES];
    for (unsigned i = 0; i < b->integrator->stages; i++) {
        const fp3_substep *substep = &b->integrator->substeps[i];
        for (uint32_t s = 0; s < b->model->state_count; s++) {
            if (!is_live(b, s) || is_position(b, s) == substep->is_kick)
                continue;
            const term f = substep->is_kick ? fp3_lower(&b->places[i], state_of(b, s)->derivative)
                                            : b->now[state_of(b, s)->velocity];
            b->g.note =
                fp3_note(b, "%u: %s of %s by %.6g h", i + 1, substep->is_kick ? "kick" : "drift",
                         name_of(b, s), substep->coefficient);
            d[s] = fp3_term_mul(&b->g, scaled_step(b, substep->coefficient, 1), f);
        }
        for (uint32_t s = 0; s < b->model->state_count; s++)
            if (is_live(b, s) && is_position(b, s) != substep->is_kick) {
                b->g.note = fp3_note(b, "%u: new %s", i + 1, name_of(b, s));
                b->now[s] = update(b, s, b->now[s], d[s]);
            }
    }
}

/* ---- Stoermer ---- */

/* x + ((x - x_before) + h^2 a), where what was lost is known without the losses. */
static void stoermer_position(build *b, uint32_t s) {
    graph *g = &b->g;
    const term x = fp3_held(b, ROLE_STATE, s), before = fp3_held(b, ROLE_BEFORE, s);
    const term a = fp3_lower(&b->places[0], state_of(b, state_of(b, s)->velocity)->derivative);
    const term kick = fp3_term_mul(g, scaled_step(b, 1, 2), a);
    b->g.note = fp3_note(b, "new %s", name_of(b, s));
    if (!b->is_compensated) {
        const term twice = fp3_term_mul(g, fp3_term(fp3_graph_number(g, 2)), x);
        b->now[s] = fp3_term_add(g, fp3_term_sub(g, twice, before), kick);
        return;
    }
    const term way =
        fp3_term_sub(g, fp3_term_sub(g, x, before),
                     fp3_term_sub(g, fp3_held(b, ROLE_LOST, s), fp3_held(b, ROLE_LOST_BEFORE, s)));
    b->now[s] = update(b, s, x, fp3_term_add(g, way, kick));
}

/* The velocity where the run ends: (x - x_before)/h + h/2 a(x). */
static term last_state(lowering *l, uint32_t state) {
    build *b = l->user;
    return fp3_term(fp3_graph_variable(&b->last, fp3_variable_of(b, ROLE_STATE, state)));
}

static fp3_status stoermer_velocity(build *b, uint32_t s, fp3_error *error) {
    graph *g = &b->last;
    const uint32_t v = state_of(b, s)->velocity;
    lowering l;
    fp3_status status = fp3_lower_open(&l, b->model, g, error);
    if (status)
        return status;
    l.state = last_state;
    l.note = fp3_note_expr;
    l.user = b;
    const term a = fp3_lower(&l, state_of(b, v)->derivative);
    fp3_lower_close(&l);
    known_table *known = &b->known;
    const uint32_t over_h =
        fp3_known_make(known, KNOWN_DIV, fp3_known_number(known, 1), fp3_known_step(known));
    const uint32_t half_h =
        fp3_known_make(known, KNOWN_MUL, fp3_known_number(known, 0.5), fp3_known_step(known));
    g->note = fp3_note(b, "%s at the end", name_of(b, v));
    const term x = fp3_term(fp3_graph_variable(g, fp3_variable_of(b, ROLE_STATE, s)));
    const term before = fp3_term(fp3_graph_variable(g, fp3_variable_of(b, ROLE_BEFORE, s)));
    const term way =
        fp3_term_mul(g, fp3_term_sub(g, x, before), fp3_term(fp3_graph_known(g, over_h)));
    const term end = fp3_term_add(g, way, fp3_term_mul(g, fp3_term(fp3_graph_known(g, half_h)), a));
    b->variables[fp3_variable_of(b, ROLE_STATE, v)].last = fp3_term_value(g, end);
    return FP3_OK;
}

static term stoermer_state(lowering *l, uint32_t state) {
    return fp3_held(l->user, ROLE_STATE, state);
}

static fp3_status stoermer(build *b, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t s = 0; !status && s < b->model->state_count; s++)
        if (is_live(b, s) && is_position(b, s)) {
            stoermer_position(b, s);
            if (fp3_position_of(b, state_of(b, s)->velocity) == s)
                status = stoermer_velocity(b, s, error);
        }
    return status;
}

/* ---- each kind ---- */

term fp3_integrate_state(lowering *l, uint32_t state) {
    switch (((const build *)l->user)->integrator->kind) {
    case FP3_RUNGE_KUTTA:
        return runge_kutta_state(l, state);
    case FP3_SPLITTING:
        return splitting_state(l, state);
    default:
        return stoermer_state(l, state);
    }
}

fp3_status fp3_integrate(build *b, fp3_error *error) {
    if (b->integrator->kind == FP3_STOERMER)
        return stoermer(b, error);
    if (b->integrator->kind == FP3_SPLITTING)
        splitting(b);
    else
        runge_kutta(b);
    return FP3_OK;
}
