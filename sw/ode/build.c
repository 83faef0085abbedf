/* build.c - integrators, each as its table says, over the derivatives of a model. */
#include "build.h"

#include <inttypes.h>
#include <isa.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BIT(state) (UINT64_C(1) << (state))

/* ---- notes ---- */

__attribute__((format(printf, 2, 3))) static uint32_t note(build *b, const char *format, ...) {
    if (!b->has_notes)
        return FP3_NONE;
    if (b->note_count == b->note_room) {
        const uint32_t room = b->note_room ? 2 * b->note_room : 64;
        char **notes = realloc(b->notes, room * sizeof *notes);
        if (!notes) {
            b->has_failed = 1;
            return FP3_NONE;
        }
        b->notes = notes;
        b->note_room = room;
    }
    va_list arguments;
    va_start(arguments, format);
    if (vasprintf(&b->notes[b->note_count], format, arguments) < 0) {
        b->notes[b->note_count] = NULL;
        b->has_failed = 1;
    }
    va_end(arguments);
    return b->note_count++;
}

static const char *name_of(const build *b, uint32_t state) { return b->model->states[state].name; }

static void place_name(const build *b, uint32_t place, char text[24]) {
    if (b->integrator->kind == FP3_RUNGE_KUTTA)
        snprintf(text, 24, "k%" PRIu32, place + 1);
    else
        snprintf(text, 24, "%" PRIu32, place + 1);
}

static uint32_t note_expr(lowering *l, uint32_t expr) {
    build *b = l->user;
    if (!b->has_notes || b->model->exprs[expr].is_known ||
        b->model->exprs[expr].op == FP3_EXPR_STATE)
        return FP3_NONE;
    const char *of = NULL, *tick = "";
    for (uint32_t i = 0; !of && i < b->model->state_count; i++)
        if (b->model->states[i].derivative == expr) {
            of = b->model->states[i].name;
            tick = "'";
        }
    for (uint32_t i = 0; !of && i < b->model->definition_count; i++)
        if (b->model->definitions[i].expr == expr)
            of = b->model->definitions[i].name;
    char place[24], *text = fp3_expr_text(b->model, expr);
    if (!text) {
        b->has_failed = 1;
        return FP3_NONE;
    }
    place_name(b, l->place, place);
    const uint32_t made = note(b, "%s: %s%s%s%s", place, of ? of : "", tick, of ? " = " : "", text);
    free(text);
    return made;
}

/* ---- small things ---- */

static uint32_t at(const build *b, uint32_t place, uint32_t state) {
    return place * b->model->state_count + state;
}

static const fp3_quantity *state_of(const build *b, uint32_t state) {
    return &b->model->states[state];
}

static int is_live(const build *b, uint32_t state) { return (b->live & BIT(state)) != 0; }

/* A position is a state whose derivative is another state, alone, that is no position itself. */
static int is_position(const build *b, uint32_t state) {
    const uint32_t velocity = state_of(b, state)->velocity;
    return velocity != FP3_NONE && state_of(b, velocity)->velocity == FP3_NONE;
}

/* The first position that this state is the velocity of, or FP3_NONE. */
static uint32_t position_of(const build *b, uint32_t velocity) {
    for (uint32_t s = 0; s < b->model->state_count; s++)
        if (is_position(b, s) && state_of(b, s)->velocity == velocity)
            return s;
    return FP3_NONE;
}

static uint32_t variable_of(const build *b, role role, uint32_t state) {
    for (uint32_t i = 0; i < b->variable_count; i++)
        if (b->variables[i].role == role && b->variables[i].state == state)
            return i;
    return FP3_NONE;
}

static term held(build *b, role role, uint32_t state) {
    return fp3_term(fp3_graph_variable(&b->g, variable_of(b, role, state)));
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
    term sum = held(b, ROLE_STATE, state);
    summand copy[FP3_STAGES_MAX];
    memcpy(copy, list, count * sizeof *list);
    const int has_unit = common_unit(b, copy, count) != 0;
    const uint32_t whole = note(b, "%s at stage %" PRIu32, name_of(b, state), place + 1);
    g->note = has_unit || count > 1
                  ? note(b, "%s at stage %" PRIu32 ", in part", name_of(b, state), place + 1)
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
    g->note = note(b, "what is added to %s, with what was lost before", name_of(b, state));
    const term y = fp3_term_sub(g, d, b->lost[state]);
    g->note = new_state;
    const term sum = fp3_term_add(g, base, y);
    g->note = note(b, "what is lost of %s", name_of(b, state));
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
        return held(b, ROLE_STATE, state);
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
        b->g.note =
            note(b, "k%" PRIu32 " of %s = h*%s'", place + 1, name_of(b, state), name_of(b, state));
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
        b->g.note = note(b, "what is added to %s", name_of(b, s));
        const term d = increment(b, list, n);
        b->g.note = note(b, "new %s", name_of(b, s));
        b->now[s] = update(b, s, held(b, ROLE_STATE, s), d);
    }
    for (uint32_t s = 0; s < b->model->state_count; s++) {
        if (!is_live(b, s) || !is_late(b, s))
            continue;
        const uint32_t v = state_of(b, s)->velocity;
        b->g.note = note(b, "new %s = %s + h*%s", name_of(b, s), name_of(b, s), name_of(b, v));
        const term d = fp3_term_mul(&b->g, scaled_step(b, 1, 1), b->now[v]);
        b->now[s] = update(b, s, held(b, ROLE_STATE, s), d);
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
                note(b, "%u: %s of %s by %.6g h", i + 1, substep->is_kick ? "kick" : "drift",
                     name_of(b, s), substep->coefficient);
            d[s] = fp3_term_mul(&b->g, scaled_step(b, substep->coefficient, 1), f);
        }
        for (uint32_t s = 0; s < b->model->state_count; s++)
            if (is_live(b, s) && is_position(b, s) != substep->is_kick) {
                b->g.note = note(b, "%u: new %s", i + 1, name_of(b, s));
                b->now[s] = update(b, s, b->now[s], d[s]);
            }
    }
}

/* ---- Stoermer ---- */

/* x + ((x - x_before) + h^2 a), where what was lost is known without the losses. */
static void stoermer_position(build *b, uint32_t s) {
    graph *g = &b->g;
    const term x = held(b, ROLE_STATE, s), before = held(b, ROLE_BEFORE, s);
    const term a = fp3_lower(&b->places[0], state_of(b, state_of(b, s)->velocity)->derivative);
    const term kick = fp3_term_mul(g, scaled_step(b, 1, 2), a);
    b->g.note = note(b, "new %s", name_of(b, s));
    if (!b->is_compensated) {
        const term twice = fp3_term_mul(g, fp3_term(fp3_graph_number(g, 2)), x);
        b->now[s] = fp3_term_add(g, fp3_term_sub(g, twice, before), kick);
        return;
    }
    const term way =
        fp3_term_sub(g, fp3_term_sub(g, x, before),
                     fp3_term_sub(g, held(b, ROLE_LOST, s), held(b, ROLE_LOST_BEFORE, s)));
    b->now[s] = update(b, s, x, fp3_term_add(g, way, kick));
}

/* The velocity where the run ends: (x - x_before)/h + h/2 a(x). */
static term last_state(lowering *l, uint32_t state) {
    build *b = l->user;
    return fp3_term(fp3_graph_variable(&b->last, variable_of(b, ROLE_STATE, state)));
}

static fp3_status stoermer_velocity(build *b, uint32_t s, fp3_error *error) {
    graph *g = &b->last;
    const uint32_t v = state_of(b, s)->velocity;
    lowering l;
    fp3_status status = fp3_lower_open(&l, b->model, g, error);
    if (status)
        return status;
    l.state = last_state;
    l.note = note_expr;
    l.user = b;
    const term a = fp3_lower(&l, state_of(b, v)->derivative);
    fp3_lower_close(&l);
    known_table *known = &b->known;
    const uint32_t over_h =
        fp3_known_make(known, KNOWN_DIV, fp3_known_number(known, 1), fp3_known_step(known));
    const uint32_t half_h =
        fp3_known_make(known, KNOWN_MUL, fp3_known_number(known, 0.5), fp3_known_step(known));
    g->note = note(b, "%s at the end", name_of(b, v));
    const term x = fp3_term(fp3_graph_variable(g, variable_of(b, ROLE_STATE, s)));
    const term before = fp3_term(fp3_graph_variable(g, variable_of(b, ROLE_BEFORE, s)));
    const term way =
        fp3_term_mul(g, fp3_term_sub(g, x, before), fp3_term(fp3_graph_known(g, over_h)));
    const term end = fp3_term_add(g, way, fp3_term_mul(g, fp3_term(fp3_graph_known(g, half_h)), a));
    b->variables[variable_of(b, ROLE_STATE, v)].last = fp3_term_value(g, end);
    return FP3_OK;
}

static term stoermer_state(lowering *l, uint32_t state) { return held(l->user, ROLE_STATE, state); }

static fp3_status stoermer(build *b, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t s = 0; !status && s < b->model->state_count; s++)
        if (is_live(b, s) && is_position(b, s)) {
            stoermer_position(b, s);
            if (position_of(b, state_of(b, s)->velocity) == s)
                status = stoermer_velocity(b, s, error);
        }
    return status;
}

/* ---- what fits ---- */

static uint64_t positions(const build *b) {
    uint64_t found = 0;
    for (uint32_t s = 0; s < b->model->state_count; s++)
        if (is_position(b, s))
            found |= BIT(s);
    return found;
}

static void find_needs(build *b) {
    for (uint32_t i = 0; i < b->model->expr_count; i++) {
        const fp3_expr *e = &b->model->exprs[i];
        b->needs[i] = e->op == FP3_EXPR_STATE ? BIT(e->index) : 0;
        for (int j = 0; j < 3; j++)
            if (e->operand[j] != FP3_NONE)
                b->needs[i] |= b->needs[e->operand[j]];
    }
}

/* Stoermer finds a velocity by its position. */
static uint64_t found_by(const build *b, uint32_t state) {
    const uint32_t position = position_of(b, state);
    return b->integrator->kind == FP3_STOERMER && position != FP3_NONE ? BIT(position) : 0;
}

static void find_live(build *b, uint64_t observed) {
    const uint32_t count = b->model->state_count;
    const uint64_t all = count == 64 ? UINT64_MAX : BIT(count) - 1;
    b->live = b->passes & FP3_PASS(FP3_PASS_DEAD) ? observed : all;
    for (uint64_t before = ~b->live; before != b->live;) {
        before = b->live;
        for (uint32_t s = 0; s < count; s++)
            if (before & BIT(s))
                b->live |= b->needs[state_of(b, s)->derivative] | found_by(b, s);
    }
}

static fp3_status check_splitting(const build *b, fp3_error *error) {
    if (positions(b))
        return FP3_OK;
    return fp3_fail(error, FP3_E_PROGRAM,
                    "integrator '%s' moves positions: found no state whose derivative is another "
                    "state (as in s' = v), expected one",
                    b->integrator->name);
}

static fp3_status check_stoermer(const build *b, fp3_error *error) {
    for (uint32_t s = 0; s < b->model->state_count; s++) {
        const fp3_quantity *q = state_of(b, s);
        if (!is_live(b, s) || is_position(b, s))
            continue;
        if (position_of(b, s) == FP3_NONE)
            return fp3_fail(error, FP3_E_PROGRAM,
                            "line %" PRIu32 ": integrator '%s' has positions and their "
                            "accelerations: found state '%s', which is neither",
                            q->line, b->integrator->name, q->name);
        if (b->needs[q->derivative] & ~positions(b))
            return fp3_fail(error, FP3_E_PROGRAM,
                            "line %" PRIu32
                            ": integrator '%s' has no velocity within a step: found "
                            "'%s', whose derivative depends on more than positions",
                            q->line, b->integrator->name, q->name);
    }
    return FP3_OK;
}

static fp3_status check_fit(const build *b, fp3_error *error) {
    if (b->integrator->kind == FP3_RUNGE_KUTTA)
        return FP3_OK;
    fp3_status status = check_splitting(b, error);
    return status || b->integrator->kind == FP3_SPLITTING ? status : check_stoermer(b, error);
}

static unsigned order_of(const build *b) {
    const uint64_t fixed = positions(b);
    if (b->integrator->kind == FP3_RUNGE_KUTTA)
        return b->integrator->is_position_late && b->live & fixed ? b->integrator->position_order
                                                                  : b->integrator->order;
    for (uint32_t s = 0; s < b->model->state_count; s++)
        if (is_live(b, s) && !is_position(b, s) && b->needs[state_of(b, s)->derivative] & ~fixed)
            return 1;
    return b->integrator->order;
}

/* ---- all of it ---- */

static void add_variables(build *b, role role, int (*is_for)(const build *, uint32_t)) {
    for (uint32_t s = 0; s < b->model->state_count; s++)
        if (is_live(b, s) && is_for(b, s))
            b->variables[b->variable_count++] = (variable){
                .role = role, .state = s, .next = FP3_NONE, .first = FP3_NONE, .last = FP3_NONE};
}

static int every(const build *b, uint32_t state) { return (void)b, (void)state, 1; }

static int is_updated(const build *b, uint32_t state) {
    return b->integrator->kind != FP3_STOERMER || is_position(b, state);
}

/* States first: the host finds them where the model has them. */
static void make_variables(build *b) {
    add_variables(b, ROLE_STATE, every);
    if (b->is_compensated)
        add_variables(b, ROLE_LOST, is_updated);
    if (b->integrator->kind == FP3_STOERMER)
        add_variables(b, ROLE_BEFORE, is_position);
    if (b->integrator->kind == FP3_STOERMER && b->is_compensated)
        add_variables(b, ROLE_LOST_BEFORE, is_position);
    for (uint32_t i = 0; i < b->variable_count; i++) {
        const variable *v = &b->variables[i];
        if (v->role == ROLE_STATE)
            b->now[v->state] = held(b, ROLE_STATE, v->state);
        if (v->role == ROLE_LOST)
            b->lost[v->state] = held(b, ROLE_LOST, v->state);
    }
}

static void make_outputs(build *b) {
    for (uint32_t i = 0; i < b->variable_count; i++) {
        variable *v = &b->variables[i];
        if (v->role == ROLE_STATE)
            v->next = fp3_term_value(&b->g, b->now[v->state]);
        else if (v->role == ROLE_LOST)
            v->next = fp3_term_value(&b->g, b->lost[v->state]);
        else
            v->next = fp3_term_value(
                &b->g, held(b, v->role == ROLE_BEFORE ? ROLE_STATE : ROLE_LOST, v->state));
    }
}

static fp3_status make_places(build *b, fp3_error *error) {
    static term (*const state[])(lowering *, uint32_t) = {[FP3_RUNGE_KUTTA] = runge_kutta_state,
                                                          [FP3_SPLITTING] = splitting_state,
                                                          [FP3_STOERMER] = stoermer_state};
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < FP3_STAGES_MAX; i++) {
        lowering *l = &b->places[i];
        status = fp3_lower_open(l, b->model, &b->g, error);
        l->state = state[b->integrator->kind];
        l->note = note_expr;
        l->user = b;
        l->place = i;
    }
    return status;
}

static fp3_status allocate(build *b, fp3_error *error) {
    const size_t states = b->model->state_count + 1u, cells = (FP3_STAGES_MAX + 1u) * states;
    fp3_known_open(&b->known, b->model);
    fp3_graph_open(&b->g, &b->known);
    fp3_graph_open(&b->last, &b->known);
    b->needs = calloc(b->model->expr_count + 1u, sizeof *b->needs);
    b->places = calloc(FP3_STAGES_MAX, sizeof *b->places);
    b->stage = calloc(cells, sizeof *b->stage);
    b->slope = calloc(cells, sizeof *b->slope);
    b->has_stage = calloc(cells, 1);
    b->has_slope = calloc(cells, 1);
    b->now = calloc(states, sizeof *b->now);
    b->lost = calloc(states, sizeof *b->lost);
    b->variables = calloc(4 * states, sizeof *b->variables);
    return b->needs && b->places && b->stage && b->slope && b->has_stage && b->has_slope &&
                   b->now && b->lost && b->variables && !b->known.has_failed
               ? FP3_OK
               : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
}

static fp3_status check_made(const build *b, fp3_error *error) {
    if (b->has_failed || b->known.has_failed || b->g.has_failed || b->last.has_failed)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (b->g.is_full || b->last.is_full)
        return fp3_fail(error, FP3_E_LIMIT,
                        "a step needs more than %u operations: no instruction memory holds them",
                        GRAPH_LIMIT);
    return FP3_OK;
}

static fp3_status make(build *b, uint64_t observed, fp3_error *error) {
    fp3_status status = allocate(b, error);
    if (status)
        return status;
    b->g.is_shared = b->last.is_shared = (b->passes & FP3_PASS(FP3_PASS_COMMON)) != 0;
    b->g.drops_units = b->last.drops_units = (b->passes & FP3_PASS(FP3_PASS_UNIT)) != 0;
    b->g.folds_products = b->last.folds_products =
        (b->passes & FP3_PASS(FP3_PASS_FOLD_PRODUCT)) != 0;
    find_needs(b);
    find_live(b, observed);
    status = check_fit(b, error);
    if (!status)
        status = make_places(b, error);
    if (status)
        return status;
    b->order = order_of(b);
    make_variables(b);
    if (b->integrator->kind == FP3_RUNGE_KUTTA)
        runge_kutta(b);
    else if (b->integrator->kind == FP3_SPLITTING)
        splitting(b);
    else
        status = stoermer(b, error);
    make_outputs(b);
    return status ? status : check_made(b, error);
}

static void free_scratch(build *b) {
    for (uint32_t i = 0; b->places && i < FP3_STAGES_MAX; i++)
        fp3_lower_close(&b->places[i]);
    free(b->places);
    free(b->needs);
    free(b->stage);
    free(b->slope);
    free(b->has_stage);
    free(b->has_slope);
    free(b->now);
    free(b->lost);
}

fp3_status fp3_build(build *b, const fp3_model *model, const fp3_integrator *integrator,
                     unsigned passes, int is_compensated, int has_notes, uint64_t observed,
                     fp3_error *error) {
    *b = (build){.model = model,
                 .integrator = integrator,
                 .passes = passes,
                 .is_compensated = is_compensated,
                 .has_notes = has_notes,
                 .one = FP3_NONE,
                 .minus_zero = FP3_NONE};
    const fp3_status status = make(b, observed, error);
    free_scratch(b);
    return status;
}

void fp3_build_close(build *b) {
    fp3_known_close(&b->known);
    fp3_graph_close(&b->g);
    fp3_graph_close(&b->last);
    free(b->variables);
    for (uint32_t i = 0; i < b->note_count; i++)
        free(b->notes[i]);
    free(b->notes);
    *b = (build){0};
}
