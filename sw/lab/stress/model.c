/* SPDX-License-Identifier: Apache-2.0 */
/* model.c - what of the suite applies to any model: its invariants, its errors by step size, the
 * way back, and params over many decades, each beside the same steps in double. */
#include "suite.h"

#include <fp3/compile.h>
#include <fp3/convergence.h>
#include <fp3/truth.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIGMAS 4
#define STEPS_MOST 65536 /* of a run in double */
#define STEPS_QUICK 4096
#define LOOKS 32

typedef struct {
    const fp3_trial *trial;
    const fp3_model *model;
    const fp3_lab_arithmetic *arithmetic;
    fp3_lab *lab;
    double h;
    uint64_t steps;
} subject;

static const double *params_of(const subject *s) { return fp3_lab_params(s->lab, 0); }
static const double *start_of(const subject *s) { return fp3_lab_initial(s->lab, 0); }

static fp3_status open_lab(subject *s, size_t objects, fp3_error *error) {
    const fp3_lab_def def = {s->model, s->trial->run, s->arithmetic,
                             s->h,     objects,       objects > 1 && !s->trial->options->is_quick};
    return fp3_lab_open(&def, &s->lab, error);
}

/* ---- invariants ---- */

static double value_of(const subject *s, uint32_t expr, const double *states, double t,
                       double *values) {
    const fp3_point at = {states, params_of(s), start_of(s), t};
    fp3_model_evaluate(s->model, &at, values);
    return values[expr];
}

/* The square of what one rounding of each state does to it. */
static double sensitivity(const subject *s, uint32_t expr, double *states, double t,
                          double *values) {
    const double here = value_of(s, expr, states, t, values);
    double sum = 0;
    for (uint32_t i = 0; i < s->model->state_count; i++) {
        const double x = states[i], d = fmax(fabs(x), 1e-30) * 1e-6;
        states[i] = x + d;
        const double slope = (value_of(s, expr, states, t, values) - here) / d;
        states[i] = x;
        sum += pow(slope * x * fp3_lab_unit(s->arithmetic), 2);
    }
    return sum;
}

typedef struct {
    double start, single, exact, walk; /* the largest changes, and the random walk of roundings */
} change;

static void follow(const subject *s, uint32_t expr, const uint64_t *steps, const double *single,
                   double *exact, change *c, double *values) {
    const uint32_t n = s->model->state_count;
    double squares = 0;
    uint64_t reached = 0;
    *c = (change){.start = value_of(s, expr, start_of(s), 0, values)};
    /* As far as double goes: a step may be too long for later times. */
    for (int k = 0; k < LOOKS; k++) {
        const double t = (double)steps[k] * s->h;
        if (!isfinite(value_of(s, expr, exact + k * n, t, values)))
            break;
        reached = steps[k];
        c->single = fmax(c->single, fabs(value_of(s, expr, single + k * n, t, values) - c->start));
        c->exact = fmax(c->exact, fabs(value_of(s, expr, exact + k * n, t, values) - c->start));
        squares += sensitivity(s, expr, exact + k * n, t, values) / LOOKS;
    }
    c->walk = sqrt(squares * (double)reached);
}

static fp3_status judge_invariant(const subject *s, uint32_t which, const uint64_t *steps,
                                  const double *single, double *exact, fp3_error *error) {
    const fp3_definition *invariant = &s->model->invariants[which];
    double *values = calloc(s->model->expr_count + 1u, sizeof *values);
    change c;
    if (!values)
        return fp3_no_memory(error);
    follow(s, invariant->expr, steps, single, exact, &c, values);
    free(values);
    fp3_verdict v = fp3_trial_verdict(s->trial, "invariants", s->model->name, s->arithmetic,
                                      "%s: largest change in %" PRIu64
                                      " steps of h = %.6g: that in double, and a walk "
                                      "of roundings",
                                      invariant->name, s->steps, s->h);
    v.relation = FP3_AT_MOST;
    v.expected = c.exact;
    v.measured = c.single;
    v.tolerance = SIGMAS * c.walk + fp3_lab_unit(s->arithmetic) * fabs(c.start);
    return isfinite(c.exact) ? fp3_verdicts_add(s->trial->verdicts, &v, error) : FP3_OK;
}

static fp3_status judge_invariants(subject *s, fp3_error *error) {
    const uint32_t n = s->model->state_count;
    uint64_t steps[LOOKS];
    double *single = calloc(LOOKS * n + 1u, sizeof *single),
           *exact = calloc(LOOKS * n + 1u, sizeof *exact);
    fp3_status status = single && exact ? FP3_OK : fp3_no_memory(error);
    for (int k = 0; k < LOOKS; k++)
        steps[k] = s->steps * (uint64_t)(k + 1) / LOOKS;
    if (!status)
        status = fp3_lab_start(s->lab, error);
    for (int k = 0; !status && k < LOOKS; k++) {
        status = fp3_lab_run(s->lab, steps[k] - (k ? steps[k - 1] : 0), error);
        if (!status)
            status = fp3_lab_read_all(s->lab, single + k * n, error);
    }
    if (!status)
        status = fp3_compiled_exact(fp3_lab_program(s->lab), params_of(s), start_of(s), s->h, steps,
                                    LOOKS, exact, error);
    for (uint32_t i = 0; !status && i < s->model->invariant_count; i++)
        status = judge_invariant(s, i, steps, single, exact, error);
    free(single);
    free(exact);
    return status;
}

/* ---- errors by step size ---- */

#define ORDER_OFF 0.2
#define FLOOR_OFF 0.01 /* where the smallest error is the method's */

/* How far two starts part on the way, in double, at most, by how far they were apart: what becomes
 * of a rounding. */
static fp3_status amplification(const subject *s, const fp3_ladder *ladder, double *most,
                                fp3_error *error) {
    const uint32_t n = s->model->state_count;
    const unsigned last = ladder->count - 1;
    const fp3_compiled *program = fp3_lab_program(s->lab);
    uint64_t steps[FP3_LOOKS];
    double rows[FP3_LOOKS * 64], moved[FP3_LOOKS * 64], start[64];
    for (unsigned k = 0; k < FP3_LOOKS; k++)
        steps[k] = ladder->steps[last] * (k + 1) / FP3_LOOKS;
    fp3_status status = fp3_compiled_exact(program, ladder->params, ladder->initial,
                                           ladder->h[last], steps, FP3_LOOKS, rows, error);
    *most = 1;
    for (uint32_t i = 0; !status && i < n; i++) {
        const double apart = 1e-7 * (ladder->scale[i] > 0 ? ladder->scale[i] : 1);
        memcpy(start, ladder->initial, n * sizeof *start);
        start[i] += apart;
        status = fp3_compiled_exact(program, ladder->params, start, ladder->h[last], steps,
                                    FP3_LOOKS, moved, error);
        for (uint32_t k = 0; !status && k < FP3_LOOKS * n; k++)
            if (ladder->scale[k % n] > 0)
                *most = fmax(*most, fabs(moved[k] - rows[k]) / ladder->scale[k % n] / 1e-7);
    }
    return status;
}

static fp3_status judge_curve(const subject *s, const fp3_ladder *ladder, double *floor,
                              fp3_error *error) {
    fp3_convergence c;
    fp3_status status =
        fp3_converge(ladder, fp3_lab_program(s->lab), fp3_lab_program(s->lab)->order, &c, error);
    if (status)
        return status;
    fp3_verdict v = fp3_trial_verdict(s->trial, "steps", s->model->name, s->arithmetic,
                                      "order: slope of the error, beside that in double");
    v.expected = c.method_order;
    v.measured = c.order;
    v.tolerance = ORDER_OFF;
    if (isfinite(c.order))
        status = fp3_verdicts_add(s->trial->verdicts, &v, error);
    unsigned last = ladder->count - 1;
    while (last && isnan(c.noise[last]))
        last--;
    double grows;
    if (!status)
        status = amplification(s, ladder, &grows, error);
    if (status)
        return status;
    v = fp3_trial_verdict(s->trial, "steps", s->model->name, s->arithmetic,
                          "what roundings do in %" PRIu64
                          " steps: at most all in one direction, times %.3g, by "
                          "which starts part",
                          ladder->steps[last], grows);
    v.relation = FP3_AT_MOST;
    v.expected = fp3_lab_unit(s->arithmetic) * (double)ladder->steps[last] * grows;
    v.measured = c.noise[last];
    if (!status && isfinite(v.measured))
        status = fp3_verdicts_add(s->trial->verdicts, &v, error);
    if (!status && s->arithmetic->update == FP3_COMPENSATED) {
        v = fp3_trial_verdict(s->trial, "steps", s->model->name, s->arithmetic,
                              "smallest error, at most that of plain updates");
        v.relation = FP3_AT_MOST;
        v.expected = *floor;
        v.tolerance = fp3_lab_unit(s->arithmetic) + FLOOR_OFF * *floor;
        v.measured = c.floor;
        status = s->model->event_count ? FP3_OK : fp3_verdicts_add(s->trial->verdicts, &v, error);
    }
    *floor = c.floor;
    return status;
}

/* Without a truth that is what is told. */
static fp3_status open_ladder(const subject *s, fp3_ladder **ladder, fp3_error *error) {
    const fp3_status status = fp3_ladder_open(s->model, 0, s->steps, ladder, error);
    fp3_verdict v = fp3_trial_verdict(s->trial, "steps", s->model->name, s->arithmetic,
                                      "solutions in double by two methods that agree");
    const fp3_error because = *error;
    v.expected = 1;
    v.measured = !status;
    v.because = because.text;
    return status == FP3_E_ARGUMENT || status == FP3_E_MISMATCH
               ? fp3_verdicts_add(s->trial->verdicts, &v, error)
               : status;
}

/* ---- the way back ---- */

/* Whether it runs backwards when all velocities are turned: their derivatives do not feel it, those
 * of positions turn. */
static int is_reversible(const subject *s, const char *is_velocity) {
    const fp3_model *m = s->model;
    double *values = calloc(m->expr_count + 1u, sizeof *values),
           *states = calloc(m->state_count, sizeof *states);
    double *before = calloc(m->state_count, sizeof *before);
    int is = values && states && before && !m->event_count;
    uint64_t seed = 6;
    for (int probe = 0; is && probe < 8; probe++) {
        for (int turned = 0; is && turned < 2; turned++) {
            for (uint32_t i = 0; i < m->state_count; i++)
                states[i] = turned ? is_velocity[i] ? -states[i] : states[i]
                                   : start_of(s)[i] + 0.1 * (fp3_trial_chance(&seed) - 0.5);
            const fp3_point at = {states, params_of(s), start_of(s), probe};
            fp3_model_evaluate(m, &at, values);
            for (uint32_t i = 0; i < m->state_count; i++) {
                const double d =
                    values[m->states[i].derivative] * (turned && !is_velocity[i] ? -1 : 1);
                is &= !turned || fabs(d - before[i]) <= 1e-9 * (fabs(d) + 1e-9);
                before[i] = d;
            }
        }
    }
    /* A right-hand side with t: the second half would have to run through its times backwards. */
    for (uint32_t i = 0; i < m->expr_count; i++)
        is &= m->exprs[i].op != FP3_EXPR_TIME || m->exprs[i].is_known;
    free(values);
    free(states);
    free(before);
    return is;
}

static double distance(const subject *s, const double *a, const double *b) {
    double sum = 0, size = 0;
    for (uint32_t i = 0; i < s->model->state_count; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
        size += b[i] * b[i];
    }
    return sqrt(sum / (size > 0 ? size : 1));
}

static fp3_status turn(subject *s, const char *is_velocity, double *row, fp3_error *error) {
    fp3_status status = fp3_lab_read_all(s->lab, row, error);
    for (uint32_t i = 0; !status && i < s->model->state_count; i++)
        if (is_velocity[i]) {
            row[i] = -row[i];
            status = fp3_lab_write(s->lab, s->model->states[i].name, &row[i], error);
        }
    return status;
}

/* The largest distance between FP32 and double on the way through as many steps without a turn. */
static fp3_status rounding_on_the_way(subject *s, double *noise, fp3_error *error) {
    double row[64], exact[LOOKS * 64];
    uint64_t steps[LOOKS];
    *noise = 0;
    for (uint64_t k = 0; k < LOOKS; k++)
        steps[k] = s->steps / 2 * 2 * (k + 1) / LOOKS;
    fp3_status status = fp3_compiled_exact(fp3_lab_program(s->lab), params_of(s), start_of(s), s->h,
                                           steps, LOOKS, exact, error);
    if (!status)
        status = fp3_lab_start(s->lab, error);
    for (int k = 0; !status && k < LOOKS; k++) {
        status = fp3_lab_run(s->lab, steps[k] - (k ? steps[k - 1] : 0), error);
        if (!status)
            status = fp3_lab_read_all(s->lab, row, error);
        if (!status)
            *noise = fmax(*noise, distance(s, row, exact + (size_t)k * s->model->state_count));
    }
    return status;
}

/* In double, and in FP32. */
static fp3_status go_back(subject *s, const char *is_velocity, double *single, double *exact,
                          fp3_error *error) {
    const uint32_t n = s->model->state_count;
    const uint64_t once = s->steps / 2;
    double row[64], there[64], end[64];
    const fp3_compiled *program = fp3_lab_program(s->lab);
    fp3_status status =
        fp3_compiled_exact(program, params_of(s), start_of(s), s->h, &once, 1, there, error);
    for (uint32_t i = 0; i < n; i++)
        there[i] *= is_velocity[i] ? -1 : 1;
    if (!status)
        status = fp3_compiled_exact(program, params_of(s), there, s->h, &once, 1, end, error);
    if (!status)
        status = fp3_lab_start(s->lab, error);
    for (int half = 0; !status && half < 2; half++) {
        status = fp3_lab_run(s->lab, once, error);
        if (!status)
            status = turn(s, is_velocity, row, error);
    }
    if (status)
        return status;
    for (uint32_t i = 0; i < n; i++)
        end[i] *= is_velocity[i] ? -1 : 1;
    *single = distance(s, row, start_of(s));
    *exact = distance(s, end, start_of(s));
    return FP3_OK;
}

static fp3_status judge_reversal(subject *s, fp3_error *error) {
    char is_velocity[64] = {0};
    int count = 0;
    double noise = 0;
    for (uint32_t i = 0; i < s->model->state_count; i++)
        if (s->model->states[i].velocity != FP3_NONE)
            count++, is_velocity[s->model->states[i].velocity] = 1;
    if (!count || s->trial->run->kind == FP3_STOERMER || !is_reversible(s, is_velocity))
        return FP3_OK;
    fp3_verdict v = fp3_trial_verdict(s->trial, "reversal", s->model->name, s->arithmetic,
                                      "distance from the start after %" PRIu64
                                      " steps forth and back, relative: that in "
                                      "double, and 4 times what roundings do in as many",
                                      s->steps / 2);
    fp3_status status = rounding_on_the_way(s, &noise, error);
    if (!status)
        status = go_back(s, is_velocity, &v.measured, &v.expected, error);
    v.relation = FP3_AT_MOST;
    v.tolerance = SIGMAS * noise;
    return status ? status : fp3_verdicts_add(s->trial->verdicts, &v, error);
}

/* ---- params over decades ---- */

#define OBJECTS 512
#define CHANCE_STEPS 512
#define DECADES 2 /* to both sides */
#define LARGEST 3.4028234663852886e38
#define SHARE_OFF 0.02

/* Those whose values FP32 cannot hold keep the model's. */
static fp3_status draw(subject *s, size_t *refused, fp3_error *error) {
    const fp3_model *m = s->model;
    const uint32_t n = m->param_count;
    const fp3_compiled *program = fp3_lab_program(s->lab);
    double *rows = calloc((size_t)OBJECTS * n + 1, sizeof *rows), column[OBJECTS];
    float *inputs = calloc(program->input_count + 1u, sizeof *inputs);
    uint64_t seed = 7;
    fp3_status status = rows && inputs ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < OBJECTS; i++) {
        double *row = rows + i * n;
        for (uint32_t p = 0; p < n; p++)
            row[p] = (float)(m->params[p].value *
                             (m->params[p].is_shared
                                  ? 1
                                  : pow(10, DECADES * (2 * fp3_trial_chance(&seed) - 1))));
        fp3_error ignored;
        if (fp3_compiled_inputs(program, row, start_of(s), s->h, inputs, &ignored)) {
            memcpy(row, params_of(s), n * sizeof *row);
            ++*refused;
        }
    }
    for (uint32_t p = 0; !status && p < n; p++) {
        for (size_t i = 0; i < OBJECTS; i++)
            column[i] = rows[i * n + p];
        if (!m->params[p].is_shared)
            status = fp3_lab_fill(s->lab, m->params[p].name, column, error);
    }
    free(rows);
    free(inputs);
    return status;
}

typedef struct {
    size_t refused, failed, expected, untold, alone, first; /* alone: in FP32 and not in double */
} fate;

static int is_lost(const double *row, uint32_t count, double most) {
    for (uint32_t i = 0; i < count; i++)
        if (!(fabs(row[i]) <= most))
            return 1;
    return 0;
}

static fp3_status compare(subject *s, fate *f, fp3_error *error) {
    const uint32_t n = s->model->state_count;
    const uint64_t steps = CHANCE_STEPS;
    double *rows = calloc((size_t)OBJECTS * n, sizeof *rows), end[64];
    fp3_object_status *of = calloc(OBJECTS, sizeof *of);
    fp3_status status = rows && of ? fp3_lab_read_all(s->lab, rows, error) : fp3_no_memory(error);
    if (!status)
        status = fp3_lab_status(s->lab, of, error);
    for (size_t i = 0; !status && i < OBJECTS; i++) {
        status = fp3_compiled_exact(fp3_lab_program(s->lab), fp3_lab_params(s->lab, i),
                                    fp3_lab_initial(s->lab, i), s->h, &steps, 1, end, error);
        const int is_expected = is_lost(end, n, LARGEST);
        f->expected += is_expected;
        f->failed += of[i].failed != 0;
        f->untold += is_lost(rows + i * n, n, LARGEST) && !of[i].failed;
        if (of[i].failed && !is_expected && !f->alone++)
            f->first = i;
    }
    free(rows);
    free(of);
    return status;
}

static fp3_status judge_chance(subject *s, fp3_error *error) {
    fate f = {0};
    fp3_failure failure;
    char said[FP3_FAILURE_TEXT_SIZE] = "", because[FP3_FAILURE_TEXT_SIZE + 96];
    fp3_status status = draw(s, &f.refused, error);
    if (!status)
        status = fp3_lab_start(s->lab, error);
    if (!status)
        status = fp3_lab_run(s->lab, CHANCE_STEPS, error);
    if (!status)
        status = compare(s, &f, error);
    if (!status)
        status = fp3_lab_failure(s->lab, &failure, said, error);
    snprintf(because, sizeof because,
             "%zu fail in FP32 alone, the first of them object %zu; first of all %s", f.alone,
             f.first, said);
    fp3_verdict v = fp3_trial_verdict(
        s->trial, "chance", s->model->name, s->arithmetic,
        "share of %d objects that fail in %d steps, each param 10^-%d to 10^%d of its own: "
        "that in double (%zu refused)",
        OBJECTS, CHANCE_STEPS, DECADES, DECADES, f.refused);
    v.expected = (double)f.expected / OBJECTS;
    v.measured = (double)f.failed / OBJECTS;
    v.tolerance = SHARE_OFF;
    v.because = because;
    if (!status)
        status = fp3_verdicts_add(s->trial->verdicts, &v, error);
    v = fp3_trial_verdict(s->trial, "chance", s->model->name, s->arithmetic,
                          "objects that are NaN or infinite and are not told");
    v.measured = (double)f.untold;
    return status ? status : fp3_verdicts_add(s->trial->verdicts, &v, error);
}

/* ---- all ---- */

static fp3_status run(const fp3_trial *trial, const fp3_model *model, fp3_error *error) {
    const uint64_t most = trial->options->is_quick ? STEPS_QUICK : STEPS_MOST;
    double floor = INFINITY;
    fp3_ladder *ladder = NULL;
    fp3_status status = FP3_OK;
    for (int i = FP3_LAB_PLAIN; !status && i <= FP3_LAB_COMPENSATED; i++) {
        subject s = {trial, model, &fp3_lab_arithmetics[i], NULL, (float)model->step, 0};
        s.steps = (uint64_t)fmin(fmax(16 * model->span / s.h, LOOKS), (double)most);
        status = open_lab(&s, 1, error);
        if (!status)
            status = judge_invariants(&s, error);
        if (!status)
            status = judge_reversal(&s, error);
        if (!status && !i)
            status = open_ladder(&s, &ladder, error);
        if (!status && ladder)
            status = judge_curve(&s, ladder, &floor, error);
        fp3_lab_close(&s.lab);
        if (!status && !i)
            status = open_lab(&s, OBJECTS, error);
        if (!status && !i)
            status = judge_chance(&s, error);
        fp3_lab_close(&s.lab);
    }
    fp3_ladder_close(&ladder);
    return status;
}

fp3_status fp3_stress_model(const fp3_stress_options *options, const fp3_model *model,
                            const char *integrator, fp3_verdicts *verdicts, fp3_error *error) {
    fp3_integrator *table = NULL;
    if (options->say)
        options->say(options->say_user, model->name, integrator);
    fp3_status status = fp3_integrator_find(integrator, &table, error);
    const fp3_trial trial = {options, table, table, verdicts};
    if (!status)
        status = run(&trial, model, error);
    fp3_integrator_free(&table);
    return status;
}
