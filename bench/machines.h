/* machines.h - the engines of fp3 that points share. */
#ifndef BENCH_MACHINES_H
#define BENCH_MACHINES_H

#include <fp3/compile.h>
#include <fp3/engine.h>

typedef struct bench_machines bench_machines;

/* *machines is NULL on failure. */
fp3_status bench_machines_open(bench_machines **machines, fp3_error *error);
/* Also what was kept. Sets *machines to NULL, which it may be already. */
void bench_machines_close(bench_machines **machines);

/* One that is open already, or a new one; what its calls fail with, bench_machines_error says. threads:
 * of "fast", no others have any. */
fp3_status bench_machines_engine(bench_machines *machines, const char *name, const char *config,
                                 unsigned threads, uint64_t objects, fp3_engine **engine,
                                 fp3_error *error);
/* Frees it in the end. */
fp3_status bench_machines_keep(bench_machines *machines, fp3_compiled *compiled, fp3_error *error);
const fp3_error *bench_machines_error(const bench_machines *machines);

#endif
