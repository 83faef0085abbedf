/* speed_runs.c - see speed.h. */
#include "speed.h"

#include "lab/measure/measure.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

fp3_status speed_run_loop(const speed_runner *runner, const bench_ships *ships,
                          const speed_runs *runs, double *seconds, fp3_error *error) {
    (void)error;
    const double begin = fp3_measure_now();
    for (uint64_t i = 0; i < runs->count; i++)
        runner->loop->run(ships, runs->steps);
    *seconds = fp3_measure_now() - begin;
    return FP3_OK;
}

const char *speed_config(const speed_runner *runner, size_t objects) {
    return runner->config ? runner->config : objects == 1 ? "single_full" : "many_full";
}

static fp3_status write_start(fp3_engine *engine, const fp3_image *image,
                              const bench_ships *ships) {
    const struct {
        const char *name;
        const float *values;
    } columns[] = {
        {"T", ships->T}, {"C", ships->C}, {"rm", ships->rm}, {"v", ships->v}, {"s", ships->s}};
    fp3_status status = fp3_engine_load(engine, image);
    for (size_t i = 0; !status && i < sizeof columns / sizeof *columns; i++) {
        const fp3_symbol *s = fp3_image_find(image, columns[i].name, FP3_CLASSES_HOST);
        status = fp3_engine_write(engine, 0, ships->objects, s->index, columns[i].values);
    }
    return status ? status : fp3_engine_set(engine, "h", ships->h);
}

fp3_status speed_run_engine(const speed_runner *runner, const bench_ships *ships,
                            const speed_runs *runs, double *seconds, fp3_error *error) {
    fp3_engine *engine = NULL;
    fp3_status status = fp3_measure_machines_engine(
        runner->machines, runner->engine, speed_config(runner, ships->objects), runner->threads,
        ships->objects, &engine, error);
    if (status)
        return status;
    if (runner->is_interpreter) /* read when a program is loaded */
        setenv("FP3_FAST", "interpreter", 1);
    for (int i = 0; !status && i < 2; i++) { /* twice: what a program needs once is not timed */
        status = write_start(engine, runner->image, ships);
        if (!status && i == 0)
            status = fp3_engine_run(engine, 1, NULL);
    }
    if (runner->is_interpreter)
        unsetenv("FP3_FAST");
    const double begin = fp3_measure_now();
    for (uint64_t i = 0; !status && i < runs->count; i++)
        status = fp3_engine_run(engine, runs->steps, NULL);
    *seconds = fp3_measure_now() - begin;
    const struct {
        const char *name;
        float *values;
    } ends[] = {{"v", ships->v}, {"s", ships->s}};
    for (int i = 0; !status && i < 2; i++) {
        const fp3_symbol *s = fp3_image_find(runner->image, ends[i].name, FP3_CLASSES_HOST);
        status = fp3_engine_read(engine, 0, ships->objects, s->index, ends[i].values);
    }
    return status
               ? fp3_fail(error, status, "%s", fp3_measure_machines_error(runner->machines)->text)
               : FP3_OK;
}

fp3_status speed_run_bodies(const speed_runner *runner, const bench_ships *ships,
                            const speed_runs *runs, double *seconds, fp3_error *error) {
    void *world = runner->bodies->make(ships);
    if (!world)
        return fp3_no_memory(error);
    const double begin = fp3_measure_now();
    runner->bodies->step(world, ships, runs->steps * runs->count);
    *seconds = fp3_measure_now() - begin;
    runner->bodies->end(world, ships);
    return FP3_OK;
}

static int slopes(double t, const double y[], double f[], void *self) {
    (void)t;
    const double *p = self; /* T, C, rm */
    f[0] = (p[0] - p[1] * y[0]) * p[2];
    f[1] = y[0];
    return GSL_SUCCESS;
}

fp3_status speed_run_gsl(const speed_runner *runner, const bench_ships *ships,
                         const speed_runs *runs, double *seconds, fp3_error *error) {
    double p[3], estimate[2];
    gsl_odeiv2_system system = {slopes, NULL, 2, p};
    gsl_odeiv2_step *step = gsl_odeiv2_step_alloc(
        strcmp(runner->method, "rk4") ? gsl_odeiv2_step_rk8pd : gsl_odeiv2_step_rk4, 2);
    if (!step)
        return fp3_no_memory(error);
    int result = GSL_SUCCESS;
    const double begin = fp3_measure_now();
    for (size_t i = 0; !result && i < ships->objects; i++) {
        double y[] = {(double)ships->v[i], (double)ships->s[i]};
        p[0] = (double)ships->T[i];
        p[1] = (double)ships->C[i];
        p[2] = (double)ships->rm[i];
        gsl_odeiv2_step_reset(step);
        for (uint64_t n = 0; !result && n < runs->steps * runs->count; n++)
            result = gsl_odeiv2_step_apply(step, (double)n * (double)ships->h, (double)ships->h, y,
                                           estimate, NULL, NULL, &system);
        ships->v[i] = (float)y[0];
        ships->s[i] = (float)y[1];
    }
    *seconds = fp3_measure_now() - begin;
    gsl_odeiv2_step_free(step);
    return result ? fp3_fail(error, FP3_E_ARGUMENT, "%s", gsl_strerror(result)) : FP3_OK;
}
