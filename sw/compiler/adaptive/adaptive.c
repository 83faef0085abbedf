/* SPDX-License-Identifier: Apache-2.0 */
/* adaptive.c - the step that is made, whether it is good, and the one that follows. */
#include "adaptive.h"

#include "compiler/value/ops.h"
#include "keep.h"
#include "language/turn.h"
#include "locate.h"

#include <fp3/compile.h>
#include <math.h>
#include <string.h>

#define SAFETY 0.75 /* of the step that would have just the error that is allowed */
#define SHRINK 0.2  /* the next step is this much shorter at most, */
#define GROW 5.0    /* this much longer at most, */
#define SHARE 0.25  /* and of what it may grow by it takes this share */
#define NO_CUT 0x1p100
#define STOPPED (-0.0) /* the next step of an object that has stopped: other steps may become 0 */

/* Of a model's own states, by the order of fp3_model_adapt. */
enum { T, H, ACCEPTED, REJECTED, SMALLEST, LARGEST };

static uint32_t state_of(const fp3_advance *a, uint32_t which) {
    return fp3_model_adapted(a->step->model) + which;
}

static uint32_t old(const fp3_advance *a, uint32_t which) {
    return fp3_advance_held(a, &a->step->values, ROLE_STATE, state_of(a, which)).node;
}

static void put(const fp3_advance *a, uint32_t which, uint32_t value) {
    a->now[state_of(a, which)] = fp3_term(value);
}

static int is_live(const fp3_advance *a, uint32_t which) {
    return fp3_fit_is_live(a->fit, state_of(a, which));
}

static void note(const fp3_advance *a, const char *text) {
    a->step->values.note = fp3_note(&a->step->notes, "%s", text);
}

static uint32_t low_of_time(const fp3_advance *a) {
    return fp3_advance_held(a, &a->step->values, ROLE_LOW, state_of(a, T)).node;
}

static uint32_t until(const fp3_advance *a) {
    dag *g = &a->step->values;
    return fp3_dag_first(g, fp3_dag_known(g, fp3_known_param(&a->step->known, "until")));
}

/* A tolerance times a number that the host multiplies it with. */
static uint32_t allowed(const fp3_advance *a, const char *name, double share) {
    known_table *known = &a->step->known;
    return fp3_dag_known(&a->step->values,
                         fp3_known_make(known, KNOWN_MUL, fp3_known_number(known, share),
                                        fp3_known_param(known, name)));
}

/* ---- where it ends at the latest ---- */

/* The time, if it comes after t and before the limit so far. */
static void add_limit(fp3_advance *a, uint32_t known) {
    dag *g = &a->step->values;
    const uint32_t t = old(a, T), time = fp3_dag_known(g, known);
    const uint32_t first = g->is_abstract
                               ? sel(g, op2(g, FP3_OP_LT, time, a->limit), time, a->limit)
                               : op2(g, FP3_OP_MIN, time, a->limit);
    a->limit = sel(g, op2(g, FP3_OP_LT, t, time), first, a->limit);
}

/* In double-single a time is a pair, and what all objects compare is one word. */
static fp3_status check_own_time(const fp3_advance *a, fp3_error *error) {
    if (!a->is_common || !a->step->values.is_abstract)
        return FP3_OK;
    return fp3_fail(error, FP3_E_PROGRAM,
                    "model '%s': a time that ends steps, and that %s, has two words in "
                    "double-single, and what all objects compare is one: expected %s",
                    a->step->model->name,
                    a->options->coupling ? "one kind has alone" : "each object has for itself",
                    a->options->coupling ? "no condition in t" : "a 'shared' param");
}

/* At `until`, or where a condition in t changes. The condition of an event is evaluated `locate`
 * after its change, so the event is at most that late. */
static fp3_status find_limit(fp3_advance *a, fp3_error *error) {
    known_table *known = &a->step->known;
    uint32_t times[2 * FP3_SWITCHINGS_MOST], count = 0;
    /* A time is one of the object's own params, or of objects of one kind alone. */
    int is_own = fp3_advance_compares(a, FP3_COMPARED_LIMIT);
    for (uint32_t i = 0; i < a->switchings.count; i++) {
        const char kind = a->switchings.kind[a->switchings.expr[i]];
        const uint32_t time = fp3_switching_time(known, &a->switchings, i);
        if (time == FP3_NONE)
            continue;
        if (kind & FP3_TURN_RATE)
            times[count++] = time;
        if (kind & FP3_TURN_CONDITION)
            times[count++] =
                fp3_known_make(known, KNOWN_ADD, time, fp3_known_param(known, "locate"));
    }
    a->limit = until(a);
    if (count && a->step->values.is_abstract) /* as a pair, which those times are */
        a->limit = fp3_dag_known(&a->step->values, fp3_known_param(known, "until"));
    note(a, "where a condition in t changes next");
    for (uint32_t i = 0; i < count; i++) {
        uint32_t k = 0;
        while (times[k] != times[i])
            k++;
        if (k == i)
            add_limit(a, times[i]);
        is_own |= !known->list[times[i]].is_shared || a->options->coupling;
    }
    const fp3_status status = is_own ? check_own_time(a, error) : FP3_OK;
    if (is_own && !status)
        a->limit = fp3_advance_least(a, FP3_COMPARED_LIMIT, a->limit);
    return status;
}

/* A condition in t is computed once, in the middle of the step: the value holds within the step,
 * but not at both ends. */
static fp3_status open_inside(fp3_advance *a, fp3_error *error) {
    if (!a->switchings.count)
        return FP3_OK;
    const fp3_status status = fp3_lower_open(&a->inside, a->step->model, &a->step->values, error);
    a->inside.notes = &a->step->notes;
    a->inside.time = fp3_advance_time(a, &a->step->values, 0.5);
    strcpy(a->inside.place, "middle");
    return status;
}

/* ---- the step ---- */

static uint32_t shorter(dag *g, uint32_t h, uint32_t most) {
    return g->is_abstract ? sel(g, op2(g, FP3_OP_LT, h, most), h, most)
                          : op2(g, FP3_OP_MIN, most, h);
}

/* As the last one has left it, or the longest that there may be. */
static uint32_t meant(const fp3_advance *a) {
    dag *g = &a->step->values;
    known_table *known = &a->step->known;
    const uint32_t h = old(a, H);
    if (a->is_chosen && fp3_model_param(a->step->model, "maxstep") == FP3_NONE)
        return h;
    return shorter(
        g, h,
        fp3_dag_known(g, a->is_chosen ? fp3_known_param(known, "maxstep") : fp3_known_step(known)));
}

static uint32_t cut(const fp3_advance *a) {
    const uint32_t state = fp3_model_state(a->step->model, "h_cut");
    return state == FP3_NONE ? FP3_NONE
                             : fp3_advance_held(a, &a->step->values, ROLE_STATE, state).node;
}

/* Nothing is located. A step whose error is too large is shorter next time, and the search begins
 * again. */
static uint32_t is_found(const fp3_advance *a) {
    dag *g = &a->step->values;
    return a->is_chosen ? sel(g, a->is_small, a->is_in_time, num(g, 1)) : a->is_in_time;
}

/* Likewise, or up to an event. */
static uint32_t tried(const fp3_advance *a) {
    const uint32_t most = cut(a);
    return most == FP3_NONE ? meant(a) : shorter(&a->step->values, meant(a), most);
}

/* Until a time, from t + low; of pairs its first word. */
static uint32_t time_left(const fp3_advance *a, uint32_t t, uint32_t low, uint32_t until) {
    dag *g = &a->step->values;
    const uint32_t left = sub(g, until, t);
    return g->is_abstract ? fp3_dag_first(g, left) : sub(g, left, low);
}

/* What is added to t in place of low: h more, or what leads to the end itself. */
static uint32_t moved_by(const fp3_advance *a, uint32_t t, uint32_t low, uint32_t h, uint32_t end) {
    dag *g = &a->step->values;
    return op2(g, FP3_OP_MIN, add(g, h, low), sub(g, end, t));
}

/* The end of the step is again a sum of two words (Dekker 1971): t + by is rounded to the first
 * word, and the rounding error is the second. If by is limit - t, the first word is the limit,
 * whatever that difference has lost. */
static void find_end(fp3_advance *a, uint32_t by) {
    dag *g = &a->step->values;
    const uint32_t t = a->begin.node;
    note(a, "t at the end of the step");
    a->end = fp3_term(op2(g, FP3_OP_MIN, add(g, t, by), a->limit));
    note(a, "second word of t at the end of the step");
    a->end_low = sub(g, by, sub(g, a->end.node, t));
}

/* In double-single t is a pair as states are, and so is the step. The end is the limit itself where
 * that comes first. */
typedef struct {
    uint32_t h, end, gain;
} move;

static move move_in_pairs(const fp3_advance *a, uint32_t t, uint32_t h, uint32_t limit) {
    dag *g = &a->step->values;
    const uint32_t left = sub(g, limit, t), is_within = op2(g, FP3_OP_LT, h, left);
    const uint32_t step = sel(g, is_within, h, left);
    const uint32_t end = sel(g, is_within, add(g, t, step), limit);
    return (move){step, end, fp3_dag_first(g, sub(g, end, t))};
}

static void begin_in_pairs(fp3_advance *a) {
    note(a, "t at the end of the step, and the step that is tried");
    const move m = move_in_pairs(a, old(a, T), tried(a), a->limit);
    a->begin = fp3_term(old(a, T));
    a->h = fp3_term(m.h);
    a->end = fp3_term(m.end);
    a->gain = m.gain;
}

fp3_status fp3_adaptive_begin(fp3_advance *a, fp3_error *error) {
    const fp3_config *config = a->options->config;
    dag *g = &a->step->values;
    if (!a->is_adaptive)
        return FP3_OK;
    if (config->interleave && !config->sleep && !a->is_common)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "adaptive steps need `sleep`, which configuration '%s' does not have",
                        config->name);
    if (config->storage)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "adaptive steps keep their time in the object's record: records of "
                        "configuration '%s' have 16 bits, which are too coarse",
                        config->name);
    if (config->sleep && !fp3_step_add(a->step, ROLE_SLEPT, FP3_NONE))
        return fp3_no_memory(error);
    fp3_status status = fp3_switchings_find(a->step->model, &a->switchings, error);
    if (!status)
        status = find_limit(a, error);
    if (status)
        return status;
    if (g->is_abstract) {
        begin_in_pairs(a);
        return open_inside(a, error);
    }
    const uint32_t t = old(a, T), low = low_of_time(a), h = tried(a);
    a->begin = fp3_term(t);
    a->begin_low = fp3_term(low);
    note(a, "the step that is tried");
    a->h = fp3_term(op2(g, FP3_OP_MIN, time_left(a, t, low, a->limit), h));
    note(a, "how t moves");
    const uint32_t by = moved_by(a, t, low, h, a->limit);
    find_end(a, by);
    note(a, "what t gains");
    a->gain = sub(g, by, low);
    return open_inside(a, error);
}

/* ---- its error ---- */

static uint32_t count_moved(const fp3_advance *a) {
    uint32_t count = 0;
    for (uint32_t s = 0; s < a->step->model->state_count; s++)
        count += (uint32_t)fp3_fit_is_moved(a->fit, s);
    return count;
}

/* A state's error over what is allowed, times the root of SAFETY^-8/n. */
static uint32_t ratio(const fp3_advance *a, uint32_t s, double share) {
    dag *g = &a->step->values;
    const uint32_t y = fp3_dag_first(g, fp3_advance_held(a, g, ROLE_STATE, s).node);
    g->note = fp3_note(&a->step->notes, "allowed error of %s", fp3_advance_name(a, s));
    const uint32_t size = mul(g, allowed(a, "tolerance", share), op1(g, FP3_OP_ABS, y));
    const uint32_t scale = add(g, size, allowed(a, "absolute", share));
    g->note = fp3_note(&a->step->notes, "error of %s, relative", fp3_advance_name(a, s));
    uint32_t weight = op1(g, FP3_OP_RCP, scale);
    if (a->error_scale.node != FP3_NONE)
        weight = mul(g, weight, fp3_dag_first(g, a->error_scale.node));
    return mul(g, fp3_dag_first(g, a->error[s].node), weight);
}

/* The mean of the squares, times SAFETY^-8. This is no maximum, which would lose a NaN. */
static uint32_t squares(const fp3_advance *a) {
    dag *g = &a->step->values;
    const double share = sqrt(count_moved(a)) * pow(SAFETY, 4);
    uint32_t sum = FP3_NONE;
    for (uint32_t s = 0; s < a->step->model->state_count; s++) {
        if (!fp3_fit_is_moved(a->fit, s) || fp3_advance_rests(a, s))
            continue;
        const uint32_t r = ratio(a, s, share), square = mul(g, r, r);
        note(a, "error of the step, squared");
        sum = sum == FP3_NONE ? square : add(g, sum, square);
    }
    return sum == FP3_NONE ? num(g, 0) : sum;
}

/* x^(-1/8): to become 1, an error e needs e^(-1/4) times the step. `min` and `max` give their
 * second operand if an operand is a NaN, so a NaN gives SHRINK. */
static uint32_t factor(const fp3_advance *a, uint32_t x) {
    dag *g = &a->step->values;
    note(a, "what the next step is longer by");
    for (int i = 0; i < 3; i++)
        x = op1(g, FP3_OP_RSQRT, x);
    const uint32_t damped = add(g, num(g, 1 - SHARE), mul(g, num(g, SHARE), x));
    const uint32_t most = op2(g, FP3_OP_MIN, damped, num(g, GROW));
    return op2(g, FP3_OP_MIN, op2(g, FP3_OP_MAX, x, num(g, SHRINK)), most);
}

static uint32_t is_small_enough(fp3_advance *a) {
    dag *g = &a->step->values;
    const uint32_t own = fp3_advance_moving(a, squares(a), num(g, 0));
    const uint32_t x = fp3_advance_worst(a, FP3_COMPARED_ERROR, own);
    a->by = factor(a, x);
    note(a, "is the error small enough");
    return op2(g, FP3_OP_LE, x, num(g, pow(SAFETY, -8)));
}

/* A fixed step is never too short, and after the end the object sleeps. A stopped object may be
 * woken. */
static int is_always_attempt(const fp3_advance *a) {
    return !a->is_chosen && a->options->config->sleep && !a->fit->has_stop;
}

fp3_status fp3_adaptive_judge(fp3_advance *a, fp3_error *error) {
    dag *g = &a->step->values;
    if (!a->is_adaptive)
        return FP3_OK;
    if (!count_moved(a) && !a->is_common)
        return fp3_fail(error, FP3_E_PROGRAM, "adaptive steps need a state that is observed");
    uint32_t is_good = a->is_chosen ? is_small_enough(a) : num(g, 1);
    const fp3_status status = fp3_locate(a, error);
    if (status)
        return status;
    a->is_small = is_good;
    if (a->is_in_time != FP3_NONE)
        is_good = mul(g, is_good, a->is_in_time);
    note(a, "is there a step at all");
    a->is_attempt =
        is_always_attempt(a) ? num(g, 1) : op2(g, FP3_OP_LE, num(g, FP3_ADAPTIVE_LEAST), a->gain);
    note(a, "is the step accepted");
    a->is_good = mul(g, is_good, a->is_attempt);
    return FP3_OK;
}

/* ---- the new states ---- */

static void select_states(const fp3_advance *a) {
    dag *g = &a->step->values;
    for (uint32_t s = 0; s < a->step->model->state_count; s++) {
        if (!fp3_fit_is_moved(a->fit, s))
            continue;
        g->note = fp3_note(&a->step->notes, "%s, if the step is accepted", fp3_advance_name(a, s));
        const uint32_t y = fp3_advance_held(a, g, ROLE_STATE, s).node;
        a->now[s] = fp3_term(sel(g, a->is_good, fp3_term_value(g, a->now[s]), y));
        if (a->options->arithmetic != FP3_COMPENSATED)
            continue;
        g->note = fp3_note(&a->step->notes, "what is lost of %s", fp3_advance_name(a, s));
        const uint32_t lost = fp3_advance_held(a, g, ROLE_LOST, s).node;
        a->lost[s] = fp3_term(sel(g, a->is_good, fp3_term_value(g, a->lost[s]), lost));
    }
}

static void count(const fp3_advance *a) {
    dag *g = &a->step->values;
    note(a, "steps and attempts so far");
    if (is_live(a, ACCEPTED))
        put(a, ACCEPTED, add(g, old(a, ACCEPTED), a->is_good));
    if (is_live(a, REJECTED))
        put(a, REJECTED, add(g, old(a, REJECTED), sub(g, a->is_attempt, a->is_good)));
    if (a->is_chosen && is_live(a, SMALLEST)) {
        const uint32_t so_far = old(a, SMALLEST);
        put(a, SMALLEST, op2(g, FP3_OP_MIN, so_far, sel(g, a->is_good, meant(a), so_far)));
    }
    if (a->is_chosen && is_live(a, LARGEST))
        put(a, LARGEST,
            op2(g, FP3_OP_MAX, old(a, LARGEST), mul(g, a->is_good, fp3_dag_first(g, a->h.node))));
}

static uint32_t next_cut(const fp3_advance *a) {
    dag *g = &a->step->values;
    note(a, "the longest step up to an event");
    return sel(g, is_found(a), num(g, NO_CUT), a->next);
}

static void keep(const fp3_advance *a, const char *name, uint32_t value) {
    dag *g = &a->step->values;
    note(a, "between which two steps an event is");
    a->now[fp3_model_state(a->step->model, name)] = fp3_term(sel(g, is_found(a), num(g, 0), value));
}

static void keep_bracket(const fp3_advance *a) {
    if (a->is_in_time == FP3_NONE)
        return;
    keep(a, FP3_STATE_BEFORE, a->before);
    keep(a, FP3_STATE_BEHIND, a->behind);
    if (a->root_before == FP3_NONE)
        return;
    keep(a, FP3_STATE_ROOT_BEFORE, a->root_before);
    keep(a, FP3_STATE_ROOT_BEHIND, a->root_behind);
}

/* Whether an event says how long the step is, or the next one. */
static uint32_t is_cut(const fp3_advance *a) {
    dag *g = &a->step->values;
    note(a, "has an event cut the step off");
    const uint32_t was_cut = op2(g, FP3_OP_LT, cut(a), meant(a));
    return mul(g, sel(g, a->is_in_time, was_cut, num(g, 1)), a->is_small);
}

/* left: of the time until the limit. */
static uint32_t next_chosen(const fp3_advance *a, uint32_t left) {
    dag *g = &a->step->values;
    note(a, "the next step; one that the end or an event cut off says nothing about it");
    const uint32_t grown = mul(g, fp3_dag_first(g, a->h.node), a->by);
    const uint32_t h = sel(g, left, grown, old(a, H));
    return a->is_in_time == FP3_NONE ? h : sel(g, is_cut(a), old(a, H), h);
}

/* The longest step, up to an event. An attempt after the end, whose step is 0, changes nothing. */
static uint32_t next_fixed(const fp3_advance *a) {
    dag *g = &a->step->values;
    const uint32_t next = a->is_in_time == FP3_NONE ? old(a, H) : next_cut(a);
    return a->fit->has_stop ? sel(g, a->is_attempt, next, old(a, H)) : next;
}

/* None, if an event stops the object at the end of this step. */
static uint32_t stopped(const fp3_advance *a, uint32_t h) {
    dag *g = &a->step->values;
    if (a->stops == FP3_NONE || a->is_common)
        return h;
    note(a, "no step any more, if an event stops the object");
    return sel(g, a->is_good, sel(g, a->stops, num(g, STOPPED), h), h);
}

/* What tells whether another step follows: what t gains by it, or whether there is time left. */
static fp3_status keep_tested(const fp3_advance *a, uint32_t t, uint32_t low, uint32_t h,
                              fp3_error *error) {
    dag *g = &a->step->values;
    uint32_t first = a->gain, next;
    a->step->rest_note = fp3_note(&a->step->notes, "no step is left");
    a->step->tested = a->step->variable_count;
    a->step->least = fp3_known_number(&a->step->known, FP3_ADAPTIVE_LEAST);
    if (is_always_attempt(a)) {
        note(a, "the time until the end");
        first = time_left(a, old(a, T), g->is_abstract ? FP3_NONE : low_of_time(a), until(a));
        next = time_left(a, t, low, until(a));
    } else {
        note(a, "what t gains by the step that is tried next");
        next = g->is_abstract ? move_in_pairs(a, t, h, until(a)).gain
                              : sub(g, moved_by(a, t, low, h, until(a)), low);
    }
    return fp3_keep(a->step, first, next, error);
}

fp3_status fp3_adaptive_accept(fp3_advance *a, fp3_error *error) {
    dag *g = &a->step->values;
    if (!a->is_adaptive)
        return FP3_OK;
    select_states(a);
    note(a, "new t");
    const uint32_t t = sel(g, a->is_good, a->end.node, a->begin.node);
    put(a, T, t);
    note(a, "the second word of the new t");
    const uint32_t low =
        g->is_abstract ? num(g, 0) : sel(g, a->is_good, a->end_low, a->begin_low.node);
    note(a, "the time until the limit");
    uint32_t left = time_left(a, t, low, a->limit);
    if (!a->options->config->sleep) /* who is stuck makes attempts that must change nothing */
        left = mul(g, a->is_attempt, left);
    const uint32_t h = stopped(a, a->is_chosen ? next_chosen(a, left) : next_fixed(a));
    put(a, H, h);
    if (a->is_chosen && a->is_in_time != FP3_NONE)
        a->now[fp3_model_state(a->step->model, "h_cut")] = fp3_term(next_cut(a));
    keep_bracket(a);
    if (!g->is_abstract)
        a->step->variables[fp3_step_find(a->step, ROLE_LOW, state_of(a, T))].next = low;
    count(a);
    if (a->is_common) /* nobody sleeps, and a step in phases begins with what objects hold */
        return FP3_OK;
    const fp3_status status = keep_tested(a, t, low, h, error);
    return status ? status : fp3_keep_stages(a, error);
}
