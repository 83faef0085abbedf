/* plain - what plain C in FP32 reaches on a model, beside the compiler's program.
 *
 *     plain MODEL.ode STEPS    the smallest error of each by rk4 with up to that number of steps,
 * and at which step: one line
 *
 * The loop is the one that somebody writes by hand (lab/bench/loop.h). Its steps and the truth are
 * those of fp3/tune.h.
 */
#include "lab/bench/loop.h"

#include <fp3/convergence.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* As fp3_convergence.error. */
static double error_at(const fp3_bench_loop *loop, const fp3_ladder *ladder, unsigned rung,
                       const float *p, float *y) {
    const uint32_t count = ladder->model->state_count;
    double sum = 0;
    unsigned terms = 0;
    uint64_t made = 0;
    for (uint32_t i = 0; i < count; i++)
        y[i] = (float)ladder->initial[i];
    for (unsigned look = 0; look < FP3_LOOKS; look++) {
        const uint64_t until = ladder->steps[rung] * (look + 1) / FP3_LOOKS;
        loop->one(p, y, made, until - made, ladder->h[rung]);
        made = until;
        for (uint32_t i = 0; i < count; i++)
            if (ladder->scale[i] > 0) {
                const double d = (y[i] - ladder->truth[rung][look * count + i]) / ladder->scale[i];
                sum += d * d;
                terms++;
            }
    }
    return sqrt(sum / terms);
}

static void *room(size_t count) {
    void *made = calloc(count + 1, sizeof(float));
    if (!made)
        abort();
    return made;
}

static void report(const fp3_bench_loop *loop, const fp3_ladder *ladder,
                   const fp3_convergence *ours) {
    const fp3_model *model = ladder->model;
    float *p = room(model->param_count), *y = room(model->state_count);
    double floor = INFINITY;
    unsigned best = 0;
    for (uint32_t i = 0; i < model->param_count; i++)
        p[i] = (float)ladder->params[i];
    for (unsigned i = 0; i < ladder->count; i++) {
        const double error = error_at(loop, ladder, i, p, y);
        if (error < floor) {
            floor = error;
            best = i;
        }
    }
    printf("%s plain %.3e at %g ours %.3e at %g ratio %.2f\n", model->name, floor,
           (double)ladder->h[best], ours->floor, (double)ladder->h[ours->best],
           ours->floor / floor);
    free(p);
    free(y);
}

int main(int argc, char **argv) {
    fp3_error error = {.text = ""};
    fp3_model *model = NULL;
    fp3_integrator *rk4 = NULL;
    fp3_compiled *program = NULL;
    fp3_ladder *ladder = NULL;
    fp3_convergence ours;
    char *text = NULL;
    static const char *const flags[] = {"-O2", "-ffp-contract=off", "-DLIBM_POWERS", NULL};
    fp3_bench_loop loop = {0};
    const fp3_compile_def def = fp3_compile_default();
    if (argc != 3)
        return 2;
    fp3_status status = fp3_model_load(argv[1], &model, &text, &error);
    if (!status)
        status = fp3_integrator_find("rk4", &rk4, &error);
    if (!status)
        status = fp3_compile(model, rk4, &def, &program, &error);
    if (!status)
        status = fp3_ladder_open(model, 0, strtoul(argv[2], NULL, 10), &ladder, &error);
    if (!status)
        status = fp3_converge(ladder, program, program->order, &ours, &error);
    if (!status)
        status = fp3_bench_loop_open(model, flags, &loop, &error);
    if (!status)
        report(&loop, ladder, &ours);
    else
        fprintf(stderr, "%s\n", text ? text : error.text);
    fp3_bench_loop_close(&loop);
    fp3_ladder_close(&ladder);
    fp3_compiled_free(&program);
    fp3_integrator_free(&rk4);
    fp3_model_free(&model);
    free(text);
    return fp3_exit_code(status);
}
