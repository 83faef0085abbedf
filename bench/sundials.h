/* sundials.h - CVODE and ARKODE, each with a sweep of tolerances. */
#ifndef BENCH_SUNDIALS_H
#define BENCH_SUNDIALS_H

#include "lab/measure/measure.h"

fp3_measure_solver_fn bench_add_sundials;

#endif
