/* speed.h - who makes the steps of the ship. */
#ifndef BENCH_SPEED_H
#define BENCH_SPEED_H

#include "bodies.h"
#include "lab/measure/machines.h"
#include "ship.h"

#include <stdint.h>

/* As a game calls: one run after the other, each of these steps. A short one alone is not to be
 * timed. */
typedef struct {
    uint64_t steps, count;
} speed_runs;

typedef struct speed_runner speed_runner;
struct speed_runner {
    const char *engine, *method; /* method: or NULL */
    unsigned threads;
    int has_flags; /* exceptions and the first failing step are kept for each object */
    int is_exact;  /* has the bits of the loop by hand ... */
    double apart;  /* ... or differs by so much at most, relative: another method, or doubles */
    double ns;     /* of an object-step, roughly: what takes too long is left out */
    const bench_ship_loop *loop;
    const bench_bodies *bodies;
    const char *config; /* of the engine; NULL: by the number of objects */
    int is_interpreter; /* "fast" without native code */
    fp3_status (*run)(const speed_runner *runner, const bench_ships *ships, const speed_runs *runs,
                      double *seconds, fp3_error *error);
    fp3_measure_machines *machines;
    const fp3_image *image;
};

/* Of an engine. */
const char *speed_config(const speed_runner *runner, size_t objects);

/* Advances the ships from where they start, and leaves where they end. *seconds is of the steps
 * alone. */
fp3_status speed_run_loop(const speed_runner *runner, const bench_ships *ships,
                          const speed_runs *runs, double *seconds, fp3_error *error);
fp3_status speed_run_engine(const speed_runner *runner, const bench_ships *ships,
                            const speed_runs *runs, double *seconds, fp3_error *error);
fp3_status speed_run_bodies(const speed_runner *runner, const bench_ships *ships,
                            const speed_runs *runs, double *seconds, fp3_error *error);
fp3_status speed_run_gsl(const speed_runner *runner, const bench_ships *ships,
                         const speed_runs *runs, double *seconds, fp3_error *error);

#endif
