/* SPDX-License-Identifier: Apache-2.0 */
/* run_check.c - see run_check.h. */
#include "run_check.h"

#include "run_invariants.h"
#include "second.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The object whose invariant has changed most. */
typedef struct {
    size_t object;
    double first, change;
} kept;

/* What is said of a group. */
typedef struct {
    const fp3_second_part *of;
    double *error; /* rows as of `now`, which become estimates */
    kept *invariants;
    size_t worst_object;
    uint32_t worst_state;
} judged;

struct fp3_run_check {
    fp3_second second;
    judged *parts;
    fp3_run_invariants *invariants;
    fp3_error why; /* the engine's, as long as it is open */
};

/* ---- estimates ---- */

/* Of a method of order p the error falls by 2^p with half the step. An event that is seen at the
 * end of a step, and not located, is of first order, and so is what pairs remember of it. */
static double share_of(const fp3_run_check *c, const fp3_second_part *p) {
    unsigned order = p->program.compiled->order;
    for (size_t i = 0; i < c->second.count; i++) {
        const fp3_second_part *other = &c->second.parts[i];
        const unsigned its = other->program.compiled->order;
        const int is_first =
            (other->model->event_count && !other->is_adaptive) || fp3_model_remembers(other->model);
        order = is_first && order ? 1 : its && its < order ? its : order;
    }
    return p->is_chosen || !order ? 1 : 1 / (1 - pow(0.5, order));
}

/* *is_lost: the second run has no number where the first has one. */
static fp3_status compare_states(fp3_run_check *c, judged *j, uint32_t state, double *first,
                                 int *is_lost) {
    const fp3_second_part *p = j->of;
    double *row = j->error + state * p->objects, *size = p->size + state * p->objects;
    fp3_status status = fp3_run_state_read(p->run->program, p->run->engine, state, p->run->first,
                                           p->objects, first, &c->why);
    for (size_t i = 0; !status && i < p->objects; i++) {
        *is_lost |= isfinite(first[i]) && !isfinite(row[i]);
        row[i] = fabs(first[i] - row[i]) * share_of(c, p);
        size[i] = fmax(size[i], fabs(first[i]));
    }
    return status;
}

/* An object that has not ended has no estimate. */
static fp3_status judge_ends(fp3_run_check *c, judged *j) {
    const fp3_second_part *p = j->of;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && p->is_adaptive && i < p->objects; i++) {
        fp3_adaptive_object first, second;
        status = fp3_adaptive_look(p->run->engine, p->run->first + i, &first);
        if (!status)
            status = fp3_adaptive_look(c->second.engine, p->first + i, &second);
        if (!status && first.until != second.until)
            return fp3_fail(&c->why, FP3_E_ARGUMENT,
                            "--check: the run ends at %.9g, its last snapshot, not at %.9g, the "
                            "time of --until",
                            (double)first.until, (double)second.until);
        const int has_ended =
            !status && fp3_adaptive_is_over(first.end) && fp3_adaptive_is_over(second.end);
        for (uint32_t s = 0; !status && !has_ended && s < p->states; s++)
            j->error[s * p->objects + i] = NAN;
    }
    return status;
}

/* values: of the model's expressions, twice. */
static void note_invariants(judged *j, size_t object, const fp3_run_lost *found, double *values) {
    const fp3_model *m = j->of->model;
    double *const end = values + m->expr_count;
    fp3_point at = {.states = found->start, .params = found->params, .initial = found->start};
    fp3_model_evaluate(m, &at, values);
    at.states = found->states;
    at.t = found->t;
    fp3_model_evaluate(m, &at, end);
    for (uint32_t i = 0; i < m->invariant_count; i++) {
        const uint32_t e = m->invariants[i].expr;
        const double change = end[e] - values[e];
        if (object == 0 || !(fabs(change) <= fabs(j->invariants[i].change)))
            j->invariants[i] = (kept){object, values[e], change};
    }
}

/* Both runs underflow alike. */
static fp3_status look_at_ends(fp3_run_check *c, judged *j) {
    const fp3_second_part *p = j->of;
    fp3_run_loss *loss = NULL;
    double *values = calloc(2u * p->model->expr_count + 1u, sizeof *values);
    fp3_status status = values ? fp3_run_loss_open(p->run, &loss, &c->why) : fp3_no_memory(&c->why);
    for (size_t i = 0; !status && i < fp3_run_loss_looked(loss); i++) {
        fp3_run_lost found;
        status = fp3_run_loss_look(loss, i, &found, &c->why);
        for (uint32_t s = 0; !status && s < p->states; s++) {
            const size_t at = s * p->objects + i;
            j->error[at] += found.lost[s];
            p->size[at] = fmax(p->size[at], found.lost[s]);
        }
        if (!status)
            note_invariants(j, i, &found, values);
    }
    fp3_run_loss_close(&loss);
    free(values);
    return status;
}

static double relative(const judged *j, size_t at) {
    return j->error[at] == 0 ? 0 : j->error[at] / j->of->size[at];
}

static double worst(const judged *j) {
    return relative(j, j->worst_state * j->of->objects + j->worst_object);
}

/* NaN is worse than any number. */
static void find_worst(judged *j) {
    double worst_so_far = -1;
    for (size_t i = 0; i < j->of->objects; i++)
        for (uint32_t s = 0; s < j->of->states; s++) {
            const double error = relative(j, s * j->of->objects + i);
            if (isnan(worst_so_far) || error <= worst_so_far)
                continue;
            worst_so_far = error;
            j->worst_object = i;
            j->worst_state = s;
        }
}

/* ---- the second run ---- */

static fp3_status run_in(fp3_run_check *c, fp3_arithmetic arithmetic, int *is_lost) {
    fp3_status status = fp3_second_run(&c->second, arithmetic);
    *is_lost = 0;
    for (size_t k = 0; !status && k < c->second.count; k++) {
        judged *j = &c->parts[k];
        double *first = malloc(j->of->objects * sizeof *first);
        status = first ? FP3_OK : fp3_no_memory(&c->why);
        for (uint32_t s = 0; !status && s < j->of->states; s++)
            status = compare_states(c, j, s, first, is_lost);
        free(first);
        if (!status)
            status = judge_ends(c, j);
    }
    return status;
}

static int applies(const fp3_run_check *c, fp3_arithmetic arithmetic) {
    int is_good = 1;
    for (size_t i = 0; i < c->second.count; i++)
        is_good &= fp3_arithmetic_applies(arithmetic, c->second.parts[i].run->program->integrator,
                                          c->second.parts[i].is_chosen);
    return is_good;
}

/* Double-single has no room for products near the ends of FP32, and its programs are long. */
static fp3_status run_in_best(fp3_run_check *c) {
    static const fp3_arithmetic tried[] = {FP3_DOUBLE_SINGLE, FP3_COMPENSATED, FP3_PLAIN};
    fp3_status status = FP3_E_PROGRAM;
    int is_lost = 0;
    for (size_t i = 0; (status == FP3_E_PROGRAM || is_lost) && i < sizeof tried / sizeof *tried;
         i++)
        if (applies(c, tried[i]))
            status = run_in(c, tried[i], &is_lost);
    return status;
}

static fp3_status look_at_invariants(fp3_run_check *c) {
    fp3_status status = fp3_run_invariants_open(c->second.set, 0, &c->invariants, &c->why);
    if (!status)
        status = fp3_run_invariants_end(c->invariants, &c->why);
    return status ? status : fp3_run_invariants_end_again(c->invariants, &c->second, &c->why);
}

static fp3_status make(fp3_run_check *c, const fp3_run_set *set, const fp3_engine_def *def) {
    fp3_status status = fp3_second_open(set, def, &c->second, &c->why);
    c->parts = calloc(set->count, sizeof *c->parts);
    if (!status && !c->parts)
        status = fp3_no_memory(&c->why);
    for (size_t i = 0; !status && i < set->count; i++) {
        const fp3_second_part *p = &c->second.parts[i];
        kept *invariants = calloc(p->model->invariant_count + 1u, sizeof *invariants);
        c->parts[i] = (judged){.of = p, .error = p->now, .invariants = invariants};
        status = invariants ? FP3_OK : fp3_no_memory(&c->why);
    }
    if (!status)
        status = run_in_best(c);
    for (size_t i = 0; !status && i < set->count; i++) {
        judged *j = &c->parts[i];
        if (!c->second.is_blind)
            status = look_at_ends(c, j);
        if (j->of->run->program->sees_others)
            fp3_run_common_size(j->of->model, j->of->states, j->of->objects, j->of->size);
        find_worst(j);
    }
    return status ? status : look_at_invariants(c);
}

static fp3_status check_part(const fp3_run_set *set, size_t number, fp3_error *error) {
    const fp3_run_part *part = &set->parts[number];
    const fp3_model *model = part->program->model;
    if (!model)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--check: %s is no model, so its use of the step is unknown",
                        set->groups[number]->path);
    if (fp3_model_is_map(model))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--check: '%s' has no equations, so its steps have no length to halve",
                        model->name);
    if (fp3_params_has(part->params, FP3_NAME_STEPS))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--check: found a value of 'steps', but with half the step an object that "
                        "starts at this number of steps starts at another time");
    return FP3_OK;
}

fp3_status fp3_run_check_make(const fp3_run_set *set, const fp3_engine_def *def,
                              fp3_run_check **check, fp3_error *error) {
    fp3_status status = FP3_OK;
    *check = NULL;
    for (size_t i = 0; !status && i < set->count; i++)
        status = check_part(set, i, error);
    if (status)
        return status;
    fp3_run_check *c = *check = calloc(1, sizeof *c);
    if (!c)
        return fp3_no_memory(error);
    status = make(c, set, def);
    if (!status)
        return FP3_OK;
    const fp3_error why = c->why;
    fp3_run_check_free(check);
    return fp3_fail(error, status, "%s%s", strncmp(why.text, "--check", 7) ? "--check: " : "",
                    why.text);
}

void fp3_run_check_free(fp3_run_check **check) {
    fp3_run_check *c = *check;
    if (!c)
        return;
    for (size_t i = 0; c->parts && i < c->second.count; i++)
        free(c->parts[i].invariants);
    free(c->parts);
    fp3_run_invariants_close(&c->invariants);
    fp3_second_close(&c->second);
    free(c);
    *check = NULL;
}

/* ---- what is said ---- */

/* The part that has an object. */
static const judged *part_of(const fp3_run_check *c, size_t object) {
    for (size_t i = 0; i < c->second.count; i++)
        if (object - c->second.parts[i].run->first < c->second.parts[i].objects)
            return &c->parts[i];
    return NULL;
}

void fp3_run_check_print_state(const fp3_run_check *c, const char *name, size_t object) {
    const judged *j = c ? part_of(c, object) : NULL;
    const uint32_t state = j ? fp3_model_state(j->of->model, name) : FP3_NONE;
    if (state == FP3_NONE || state >= j->of->states)
        return;
    const size_t at = state * j->of->objects + object - j->of->run->first;
    printf("   error %.1e, relative %.1e", j->error[at], relative(j, at));
}

static void print_growth(const fp3_second *s) {
    char text[FP3_RUN_GROWTH_TEXT_SIZE];
    fp3_run_growth_text(s->growth, text);
    if (*text)
        printf("%-16s %s\n", "unstable", text);
}

/* Of objects that see each other all are judged together. */
static void print_all_objects(const judged *j) {
    const fp3_second_part *p = j->of;
    for (uint32_t s = 0; p->run->program->sees_others && s < p->states; s++) {
        double squares = 0, largest = -1;
        size_t object = 0;
        for (size_t i = 0; i < p->objects; i++) {
            const double error = j->error[s * p->objects + i];
            squares += error * error;
            if (!(error <= largest) && !isnan(largest)) {
                largest = error;
                object = i;
            }
        }
        printf("%-16s %s: error %.1e RMS, %.1e at most, of object %zu\n", "all objects",
               p->model->states[s].name, sqrt(squares / (double)p->objects), largest,
               p->run->first + object);
    }
}

void fp3_run_check_print(const fp3_run_check *c, size_t first) {
    const judged *j = c ? part_of(c, first) : NULL;
    if (!j)
        return;
    const fp3_second_part *p = j->of;
    const size_t at = j->worst_state * p->objects + j->worst_object;
    printf("%-16s %s, %s; %s\n", "check", p->how,
           fp3_arithmetic_of(p->program.compiled->arithmetic)->text,
           fp3_engine_how(c->second.engine));
    print_all_objects(j);
    printf("%-16s object %zu, %s: error %.1e, relative %.1e\n", "worst",
           p->run->first + j->worst_object, p->model->states[j->worst_state].name, j->error[at],
           worst(j));
    for (uint32_t i = 0; !c->second.is_blind && i < p->model->invariant_count; i++)
        printf("%-16s object %zu, %s: was %.9g, changed by %.1e\n", "invariant",
               p->run->first + j->invariants[i].object, p->model->invariants[i].name,
               j->invariants[i].first, j->invariants[i].change);
    if (j != &c->parts[c->second.count - 1])
        return;
    fp3_run_invariants_print(c->invariants);
    if (c->second.is_blind)
        printf("%-16s what underflows, and invariants%s\n", "not looked at",
               c->invariants ? " of an object" : "");
    print_growth(&c->second);
}

fp3_status fp3_run_check_judge(const fp3_run_check *c, double bound, fp3_error *error) {
    char text[FP3_RUN_INVARIANTS_TEXT_SIZE] = "", grows[FP3_RUN_GROWTH_TEXT_SIZE] = "";
    for (size_t i = 0; c && i < c->second.count; i++) {
        const judged *j = &c->parts[i];
        if (!(worst(j) <= bound))
            return fp3_fail(error, FP3_E_FAILED,
                            "object %zu, %s: relative error %.2g, and --strict allows %.2g",
                            j->of->run->first + j->worst_object,
                            j->of->model->states[j->worst_state].name, worst(j), bound);
    }
    if (c)
        fp3_run_growth_text(c->second.growth, grows);
    if (*grows)
        return fp3_fail(error, FP3_E_FAILED, "%s", grows);
    if (c)
        fp3_run_invariants_judge(c->invariants, bound, text);
    return *text ? fp3_fail(error, FP3_E_FAILED, "%s, and --strict allows %.2g", text, bound)
                 : FP3_OK;
}
