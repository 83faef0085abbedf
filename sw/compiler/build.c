/* build.c - the graph of a step: what fits together, which states and variables, and notes. */
#include "integrate.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- notes ---- */

uint32_t fp3_note(build *b, const char *format, ...) {
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

static void place_name(const build *b, uint32_t place, char text[24]) {
    if (b->integrator->kind == FP3_RUNGE_KUTTA)
        snprintf(text, 24, "k%" PRIu32, place + 1);
    else
        snprintf(text, 24, "%" PRIu32, place + 1);
}

uint32_t fp3_note_expr(lowering *l, uint32_t expr) {
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
    const uint32_t made =
        fp3_note(b, "%s: %s%s%s%s", place, of ? of : "", tick, of ? " = " : "", text);
    free(text);
    return made;
}

/* ---- variables ---- */

uint32_t fp3_position_of(const build *b, uint32_t velocity) {
    for (uint32_t s = 0; s < b->model->state_count; s++)
        if (is_position(b, s) && state_of(b, s)->velocity == velocity)
            return s;
    return FP3_NONE;
}

uint32_t fp3_variable_of(const build *b, role role, uint32_t state) {
    for (uint32_t i = 0; i < b->variable_count; i++)
        if (b->variables[i].role == role && b->variables[i].state == state)
            return i;
    return FP3_NONE;
}

term fp3_held(build *b, role role, uint32_t state) {
    return fp3_term(fp3_graph_variable(&b->g, fp3_variable_of(b, role, state)));
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
    const uint32_t position = fp3_position_of(b, state);
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
        if (fp3_position_of(b, s) == FP3_NONE)
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
            b->now[v->state] = fp3_held(b, ROLE_STATE, v->state);
        if (v->role == ROLE_LOST)
            b->lost[v->state] = fp3_held(b, ROLE_LOST, v->state);
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
                &b->g, fp3_held(b, v->role == ROLE_BEFORE ? ROLE_STATE : ROLE_LOST, v->state));
    }
}

static fp3_status make_places(build *b, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < FP3_STAGES_MAX; i++) {
        lowering *l = &b->places[i];
        status = fp3_lower_open(l, b->model, &b->g, error);
        l->state = fp3_integrate_state;
        l->note = fp3_note_expr;
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
    status = fp3_integrate(b, error);
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
