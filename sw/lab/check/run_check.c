/* SPDX-License-Identifier: Apache-2.0 */
/* run_check.c - see run_check.h. */
#include "run_check.h"

#include "run_growth.h"

#include "world/lifetime.h"
#include "world/values.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LOOKS 16 /* at the second run, for the size of each state */

/* The object whose invariant has changed most. */
typedef struct {
    size_t object;
    double first, change;
} kept;

struct fp3_run_check {
    fp3_run_part run; /* the one that has ended */
    const fp3_scene_group *group;
    const fp3_engine_def *first;
    const fp3_model *model;
    uint32_t states; /* those of the model, without what adaptive steps add */
    size_t objects;
    double *error, *size; /* rows of a number for each object */
    fp3_compiled *compiled;
    fp3_program program; /* of the second run: its parts, but for the compiled program, are the
                            first one's */
    fp3_params *params;
    fp3_engine *engine;
    fp3_engine_def def;
    fp3_error why; /* the engine's, as long as it is open */
    int is_adaptive, is_chosen;
    int is_blind; /* the two runs are compared, and nothing else is looked at */
    char how[400];
    double end; /* of fixed steps: the time */
    size_t worst_object;
    uint32_t worst_state;
    kept *invariants;
    fp3_run_growth growth; /* the largest of all looks, with the step of the first run */
};

/* ---- the second run ---- */

/* One with room for long programs. */
static const char *config_of(const fp3_run_check *c) {
    return c->run.program->sees_others ? "world" : "many_full";
}

static fp3_status compile(fp3_run_check *c, fp3_arithmetic arithmetic, fp3_error *error) {
    const fp3_program *first = c->run.program;
    fp3_compile_def def = fp3_compile_default();
    def.config = config_of(c);
    def.arithmetic = arithmetic;
    def.is_for_host = 1;
    fp3_compiled_free(&c->compiled);
    const fp3_status status =
        fp3_compile(first->model, first->integrator, &def, &c->compiled, error);
    if (status)
        return status;
    c->program = *first;
    c->program.compiled = c->compiled;
    c->program.image = c->compiled->image;
    return FP3_OK;
}

/* A part of what the run has: of the value that was given, or of the model's. */
static fp3_status scale(fp3_run_check *c, const char *name, double factor, double *value,
                        fp3_error *error) {
    fp3_status status =
        fp3_params_has(c->params, name) ? fp3_params_get(c->params, name, value, error) : FP3_OK;
    *value *= factor;
    return status ? status : fp3_params_put(c->params, name, *value, error);
}

/* Values that are computed from what has been scaled would change the equations. */
static fp3_status check_formulas(const fp3_run_check *c, fp3_error *error) {
    fp3_value_look one;
    for (size_t i = 0; fp3_values_look(c->run.params, i, &one); i++) {
        double first = 0, second = 0;
        fp3_status status =
            one.formula ? fp3_params_get(c->run.params, one.name, &first, error) : FP3_OK;
        if (!status && one.formula)
            status = fp3_params_get(c->params, one.name, &second, error);
        if (status)
            return status;
        if (first != second)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "--check: '%s' is computed from a value that a check changes; give a "
                            "number instead",
                            one.name);
    }
    return FP3_OK;
}

static fp3_status scale_all(fp3_run_check *c, fp3_error *error) {
    const fp3_model *m = c->model;
    double value = m->step;
    fp3_status status = fp3_params_copy(c->run.params, &c->params, error);
    if (!status && !c->is_chosen) {
        status = scale(c, FP3_NAME_STEP, 0.5, &value, error);
        c->end = 2 * value * (double)c->run.steps;
        snprintf(c->how, sizeof c->how, "h = %.9g", value);
        if (!c->is_adaptive)
            snprintf(c->how + strlen(c->how), sizeof c->how - strlen(c->how),
                     " in %" PRIu64 " steps", 2 * c->run.steps);
    }
    static const char *const names[] = {"absolute", "tolerance"};
    for (size_t i = 0; !status && c->is_chosen && i < 2; i++) {
        value = m->params[fp3_model_param(m, names[i])].value;
        status = scale(c, names[i], 0.1, &value, error);
        snprintf(c->how, sizeof c->how, "tolerance %.9g", value);
    }
    return status ? status : check_formulas(c, error);
}

/* The same times in twice the steps. */
static fp3_status double_steps(const fp3_run_check *c, const char *what, fp3_scene_steps *steps,
                               fp3_error *error) {
    const uint64_t apart =
        steps->last > steps->first ? steps->last - steps->first : steps->first - steps->last;
    if (steps->first == FP3_FOREVER)
        return FP3_OK;
    if (c->objects > 1 && apart % (c->objects - 1))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--check: the %s of %zu objects from step %" PRIu64 " to %" PRIu64
                        " are rounded to whole steps, and with half the step to other times",
                        what, c->objects, steps->first, steps->last);
    steps->first *= 2;
    steps->last *= 2;
    return FP3_OK;
}

static fp3_status live(const fp3_run_check *c, fp3_error *error) {
    fp3_scene_group second = *c->group;
    second.first = 0;
    fp3_status status = double_steps(c, "births", &second.born, error);
    if (!status)
        status = double_steps(c, "ends", &second.gone, error);
    return status ? status : fp3_lifetime_apply(&second, c->engine);
}

static fp3_status open_engine(fp3_run_check *c, fp3_error *error) {
    const fp3_engine_def *first = c->first;
    c->def = fp3_engine_default();
    c->def.engine = "fast";
    c->def.config = config_of(c);
    c->def.objects = (uint32_t)c->objects;
    c->def.threads = first->threads;
    c->def.is_interpreted = strcmp(first->engine, "fast") != 0 || first->native;
    c->def.is_without_compiler = c->def.is_interpreted;
    c->def.error = error;
    fp3_engine_close(&c->engine);
    fp3_status status = fp3_engine_open(&c->def, &c->engine);
    if (!status)
        status = fp3_program_load(&c->program, c->params, c->engine, error);
    return status || !c->group ? status : live(c, error);
}

static fp3_status look_for_growth(fp3_run_check *c, double t, fp3_error *error) {
    const fp3_program *first = c->run.program;
    fp3_run_growth found;
    if (!first->sees_others || c->is_blind)
        return FP3_OK;
    const fp3_status status = fp3_run_growth_find(
        &(fp3_run_moment){first, c->run.params, c->error, c->objects, t}, &found, error);
    if (!status && found.factor > c->growth.factor)
        c->growth = found;
    return status;
}

/* Notes how large each state is, and leaves the states in c->error. */
static fp3_status look(fp3_run_check *c, double share, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t s = 0; !status && s < c->states; s++) {
        double *row = c->error + s * c->objects, *size = c->size + s * c->objects;
        status = fp3_run_state_read(&c->program, c->engine, s, 0, c->objects, row, error);
        for (size_t i = 0; !status && i < c->objects; i++)
            size[i] = fmax(size[i], fabs(row[i]));
    }
    return status ? status : look_for_growth(c, share * c->end, error);
}

static fp3_status run_again(fp3_run_check *c, fp3_error *error) {
    const uint64_t all = 2 * c->run.steps, parts = c->is_adaptive ? 1 : LOOKS;
    fp3_status status = look(c, 0, error);
    for (uint64_t i = 0; !status && i < parts; i++) {
        const uint64_t steps =
            c->is_adaptive ? 10 * c->run.steps : all * (i + 1) / parts - all * i / parts;
        status = fp3_adaptive_run(c->engine, steps < UINT32_MAX ? steps : UINT32_MAX, NULL);
        if (!status)
            status = look(c, (double)(i + 1) / (double)parts, error);
    }
    return status;
}

/* ---- estimates ---- */

/* Of a method of order p the error falls by 2^p with half the step. An event that is seen at the
 * end of a step, and not located, is of first order, and so is what pairs remember of it. */
static double share_of(const fp3_run_check *c) {
    const int is_first =
        (c->model->event_count && !c->is_adaptive) || fp3_model_remembers(c->model);
    const unsigned order = is_first ? 1 : c->compiled->order;
    return c->is_chosen || !order ? 1 : 1 / (1 - pow(0.5, order));
}

/* *is_lost: the second run has no number where the first has one. */
static fp3_status compare_states(fp3_run_check *c, uint32_t state, double *first, int *is_lost,
                                 fp3_error *error) {
    double *row = c->error + state * c->objects, *size = c->size + state * c->objects;
    fp3_status status = fp3_run_state_read(c->run.program, c->run.engine, state, c->run.first,
                                           c->objects, first, error);
    for (size_t i = 0; !status && i < c->objects; i++) {
        *is_lost |= isfinite(first[i]) && !isfinite(row[i]);
        row[i] = fabs(first[i] - row[i]) * share_of(c);
        size[i] = fmax(size[i], fabs(first[i]));
    }
    return status;
}

/* An object that has not ended has no estimate. */
static fp3_status judge_ends(fp3_run_check *c, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && c->is_adaptive && i < c->objects; i++) {
        fp3_adaptive_object first, second;
        status = fp3_adaptive_look(c->run.engine, c->run.first + i, &first);
        if (!status)
            status = fp3_adaptive_look(c->engine, i, &second);
        if (!status && first.until != second.until)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "--check: the run ends at %.9g, its last snapshot, not at %.9g, the "
                            "time of --until",
                            (double)first.until, (double)second.until);
        const int has_ended =
            !status && fp3_adaptive_is_over(first.end) && fp3_adaptive_is_over(second.end);
        for (uint32_t s = 0; !status && !has_ended && s < c->states; s++)
            c->error[s * c->objects + i] = NAN;
    }
    return status;
}

/* values: of the model's expressions, twice. */
static void note_invariants(fp3_run_check *c, size_t object, const fp3_run_lost *found,
                            double *values) {
    const fp3_model *m = c->model;
    double *const end = values + m->expr_count;
    fp3_point at = {.states = found->start, .params = found->params, .initial = found->start};
    fp3_model_evaluate(m, &at, values);
    at.states = found->states;
    at.t = found->t;
    fp3_model_evaluate(m, &at, end);
    for (uint32_t i = 0; i < m->invariant_count; i++) {
        const uint32_t e = m->invariants[i].expr;
        const double change = end[e] - values[e];
        if (object == 0 || !(fabs(change) <= fabs(c->invariants[i].change)))
            c->invariants[i] = (kept){object, values[e], change};
    }
}

/* Both runs underflow alike. */
static fp3_status look_at_ends(fp3_run_check *c, fp3_error *error) {
    fp3_run_loss *loss = NULL;
    double *values = calloc(2u * c->model->expr_count + 1u, sizeof *values);
    fp3_status status = values ? fp3_run_loss_open(&c->run, &loss, error) : fp3_no_memory(error);
    for (size_t i = 0; !status && i < fp3_run_loss_looked(loss); i++) {
        fp3_run_lost found;
        status = fp3_run_loss_look(loss, i, &found, error);
        for (uint32_t s = 0; !status && s < c->states; s++) {
            const size_t at = s * c->objects + i;
            c->error[at] += found.lost[s];
            c->size[at] = fmax(c->size[at], found.lost[s]);
        }
        if (!status)
            note_invariants(c, i, &found, values);
    }
    fp3_run_loss_close(&loss);
    free(values);
    return status;
}

static double relative(const fp3_run_check *c, size_t at) {
    return c->error[at] == 0 ? 0 : c->error[at] / c->size[at];
}

/* NaN is worse than any number. */
static void find_worst(fp3_run_check *c) {
    double worst = -1;
    for (size_t i = 0; i < c->objects; i++)
        for (uint32_t s = 0; s < c->states; s++) {
            const double error = relative(c, s * c->objects + i);
            if (isnan(worst) || error <= worst)
                continue;
            worst = error;
            c->worst_object = i;
            c->worst_state = s;
        }
}

/* Before a long run that would be refused in the end. */
static fp3_status check_count(const fp3_run_check *c, fp3_error *error) {
    if (c->is_adaptive || fp3_image_steps(c->program.image) < 0 ||
        c->run.steps <= FP3_STEPS_LIMIT / 2)
        return FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "--check: half the step takes %" PRIu64
                    " steps, and a program with t counts %d at most",
                    2 * c->run.steps, FP3_STEPS_LIMIT);
}

static fp3_status run_in(fp3_run_check *c, fp3_arithmetic arithmetic, double *first, int *is_lost,
                         fp3_error *error) {
    memset(c->size, 0, c->objects * c->states * sizeof *c->size);
    c->growth = (fp3_run_growth){.factor = 1};
    *is_lost = 0;
    fp3_status status = compile(c, arithmetic, error);
    if (!status)
        status = check_count(c, error);
    if (!status)
        status = open_engine(c, error);
    if (!status)
        status = run_again(c, error);
    for (uint32_t s = 0; !status && s < c->states; s++)
        status = compare_states(c, s, first, is_lost, error);
    return status ? status : judge_ends(c, error);
}

/* Double-single has no room for products near the ends of FP32, and its programs are long. */
static fp3_status run_in_best(fp3_run_check *c, double *first, fp3_error *error) {
    static const fp3_arithmetic tried[] = {FP3_DOUBLE_SINGLE, FP3_COMPENSATED, FP3_PLAIN};
    fp3_status status = FP3_E_PROGRAM;
    int is_lost = 0;
    for (size_t i = 0; (status == FP3_E_PROGRAM || is_lost) && i < sizeof tried / sizeof *tried;
         i++)
        if (fp3_arithmetic_applies(tried[i], c->run.program->integrator, c->is_chosen))
            status = run_in(c, tried[i], first, &is_lost, error);
    return status;
}

static fp3_status make(fp3_run_check *c, fp3_error *error) {
    double *first = malloc(c->objects * sizeof *first);
    c->error = calloc(c->objects * c->states, sizeof *c->error);
    c->size = calloc(c->objects * c->states, sizeof *c->size);
    c->invariants = calloc(c->model->invariant_count + 1u, sizeof *c->invariants);
    fp3_status status =
        first && c->error && c->size && c->invariants ? scale_all(c, error) : fp3_no_memory(error);
    if (!status)
        status = run_in_best(c, first, error);
    free(first);
    if (!status && !c->is_blind)
        status = look_at_ends(c, error);
    if (!status && c->run.program->sees_others)
        fp3_run_common_size(c->model, c->states, c->objects, c->size);
    if (!status)
        find_worst(c);
    return status;
}

fp3_status fp3_run_check_make(const fp3_run_part *part, const fp3_scene_group *group,
                              const fp3_engine_def *def, fp3_run_check **check, fp3_error *error) {
    *check = NULL;
    if (!part->program->model)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--check: %s is no model, so its use of the step is unknown", group->path);
    if (fp3_model_is_map(part->program->model))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--check: '%s' has no equations, so its steps have no length to halve",
                        part->program->model->name);
    if (fp3_params_has(part->params, FP3_NAME_STEPS))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--check: found a value of 'steps', but with half the step an object that "
                        "starts at this number of steps starts at another time");
    fp3_run_check *c = *check = calloc(1, sizeof *c);
    if (!c)
        return fp3_no_memory(error);
    c->run = *part;
    c->group = group;
    c->first = def;
    c->model = part->program->model;
    c->is_adaptive = fp3_adaptive_is(part->program->image);
    c->is_chosen = fp3_model_chooses_steps(c->model);
    c->states = c->is_adaptive ? fp3_model_adapted(c->model) : c->model->state_count;
    c->objects = part->objects;
    c->is_blind =
        fp3_run_loss_is_blind(part) || (part->program->sees_others && fp3_model_removes(c->model));
    const fp3_status status = make(c, &c->why);
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
    fp3_engine_close(&c->engine);
    fp3_compiled_free(&c->compiled);
    fp3_params_free(&c->params);
    free(c->error);
    free(c->size);
    free(c->invariants);
    free(c);
    *check = NULL;
}

/* ---- what is said ---- */

void fp3_run_check_print_state(const fp3_run_check *c, const char *name, size_t object) {
    const uint32_t state = c ? fp3_model_state(c->model, name) : FP3_NONE;
    if (state == FP3_NONE || state >= c->states)
        return;
    const size_t at = state * c->objects + object - c->run.first;
    printf("   error %.1e, relative %.1e", c->error[at], relative(c, at));
}

static void print_growth(const fp3_run_check *c) {
    char text[FP3_RUN_GROWTH_TEXT_SIZE];
    if (!(c->growth.factor > 1))
        return;
    fp3_run_growth_text(&c->growth, c->run.program, c->run.first, text);
    printf("%-16s %s\n", "unstable", text);
}

void fp3_run_check_print(const fp3_run_check *c) {
    if (!c)
        return;
    const size_t at = c->worst_state * c->objects + c->worst_object;
    printf("%-16s %s, %s; %s\n", "check", c->how, fp3_arithmetic_of(c->compiled->arithmetic)->text,
           fp3_engine_how(c->engine));
    printf("%-16s object %zu, %s: error %.1e, relative %.1e\n", "worst",
           c->run.first + c->worst_object, c->model->states[c->worst_state].name, c->error[at],
           relative(c, at));
    if (c->is_blind)
        printf("%-16s what underflows, invariants, unstable steps\n", "not looked at");
    for (uint32_t i = 0; !c->is_blind && i < c->model->invariant_count; i++)
        printf("%-16s object %zu, %s: was %.9g, changed by %.1e\n", "invariant",
               c->run.first + c->invariants[i].object, c->model->invariants[i].name,
               c->invariants[i].first, c->invariants[i].change);
    print_growth(c);
}

fp3_status fp3_run_check_judge(const fp3_run_check *c, double bound, fp3_error *error) {
    const size_t at = c ? c->worst_state * c->objects + c->worst_object : 0;
    return !c || relative(c, at) <= bound
               ? FP3_OK
               : fp3_fail(error, FP3_E_FAILED,
                          "object %zu, %s: relative error %.2g, and --strict allows %.2g",
                          c->run.first + c->worst_object, c->model->states[c->worst_state].name,
                          relative(c, at), bound);
}
