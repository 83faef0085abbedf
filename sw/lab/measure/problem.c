/* SPDX-License-Identifier: Apache-2.0 */
/* problem.c - a model, its variants, and where they really end. */
#include "problem.h"

#include "lab/bench/variants.h"

#include <fp3/convergence.h>
#include <fp3/truth.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The scale is that of fp3/tune.h, of the first variant. */
static fp3_status find_scale(fp3_measure_problem *p, fp3_error *error) {
    fp3_ladder *ladder = NULL;
    const fp3_status status = fp3_ladder_open(p->model, p->end, FP3_LOOKS, &ladder, error);
    if (!status)
        memcpy(p->scale, ladder->scale, p->model->state_count * sizeof *p->scale);
    fp3_ladder_close(&ladder);
    return status;
}

fp3_status fp3_measure_problem_open(const fp3_model *model, unsigned variants,
                                    fp3_measure_problem *problem, fp3_error *error) {
    const size_t params = model->param_count, states = model->state_count;
    *problem =
        (fp3_measure_problem){.model = model, .end = (float)model->span, .variants = variants};
    problem->params = calloc(variants * params + 1, sizeof(double));
    problem->initial = calloc(variants * states + 1, sizeof(double));
    problem->truth = calloc(variants * states + 1, sizeof(double));
    problem->scale = calloc(states + 1, sizeof(double));
    if (!problem->params || !problem->initial || !problem->truth || !problem->scale) {
        fp3_measure_problem_close(problem);
        return fp3_no_memory(error);
    }
    fp3_status status = find_scale(problem, error);
    for (unsigned v = 0; !status && v < variants; v++) {
        fp3_bench_variant(model, v, problem->params + v * params, problem->initial + v * states);
        status = fp3_model_truth(model, problem->params + v * params, problem->initial + v * states,
                                 problem->end, problem->truth + v * states, error);
    }
    if (status)
        fp3_measure_problem_close(problem);
    return status;
}

void fp3_measure_problem_close(fp3_measure_problem *problem) {
    free(problem->params);
    free(problem->initial);
    free(problem->truth);
    free(problem->scale);
    *problem = (fp3_measure_problem){0};
}

static double error_of(const fp3_measure_problem *p, unsigned variant, const double *ends) {
    const size_t states = p->model->state_count;
    double sum = 0;
    unsigned terms = 0;
    for (size_t i = 0; i < states; i++) {
        const double d = ends[variant * states + i] - p->truth[variant * states + i];
        if (!isfinite(d))
            return INFINITY;
        if (p->scale[i] > 0) {
            sum += d / p->scale[i] * (d / p->scale[i]);
            terms++;
        }
    }
    return sqrt(sum / (terms ? terms : 1));
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

uint64_t fp3_measure_steps(unsigned rung) { return 1ull << rung; }

double fp3_measure_median(const double *values, unsigned count) {
    double *sorted = calloc(count + 1u, sizeof *sorted);
    if (!sorted)
        return NAN;
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare);
    const double median = count ? (sorted[(count - 1) / 2] + sorted[count / 2]) / 2 : NAN;
    free(sorted);
    return median;
}

void fp3_measure_problem_errors(const fp3_measure_problem *problem, const double *ends,
                                double *median, double *worst) {
    double *errors = calloc(problem->variants, sizeof *errors);
    *median = *worst = errors ? 0 : NAN;
    for (unsigned v = 0; errors && v < problem->variants; v++) {
        errors[v] = error_of(problem, v, ends);
        *worst = fmax(*worst, errors[v]);
    }
    if (errors)
        *median = fp3_measure_median(errors, problem->variants);
    free(errors);
}
