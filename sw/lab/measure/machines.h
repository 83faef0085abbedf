/* SPDX-License-Identifier: Apache-2.0 */
/* machines.h - the engines of fp3 that points share. */
#ifndef FP3_MEASURE_MACHINES_H
#define FP3_MEASURE_MACHINES_H

#include <fp3/compile.h>
#include <fp3/engine.h>

typedef struct fp3_measure_machines fp3_measure_machines;

/* is_interpreted: engine fast compiles no native code. *machines is NULL on failure. */
fp3_status fp3_measure_machines_open(int is_interpreted, fp3_measure_machines **machines,
                                     fp3_error *error);
/* Also what was kept. Sets *machines to NULL, which it may be already. */
void fp3_measure_machines_close(fp3_measure_machines **machines);

/* One that is open already, or a new one; what its calls fail with, fp3_measure_machines_error
 * says. threads: of "fast", no others have any. */
fp3_status fp3_measure_machines_engine(fp3_measure_machines *machines, const char *name,
                                       const char *config, unsigned threads, uint64_t objects,
                                       fp3_engine **engine, fp3_error *error);
/* What points use; each is freed in the end, or at once if there is no memory. */
fp3_status fp3_measure_machines_keep(fp3_measure_machines *machines, void *memory,
                                     fp3_error *error);
fp3_status fp3_measure_machines_keep_model(fp3_measure_machines *machines, fp3_model *model,
                                           fp3_error *error);
fp3_status fp3_measure_machines_keep_program(fp3_measure_machines *machines, fp3_compiled *compiled,
                                             fp3_error *error);
const fp3_error *fp3_measure_machines_error(const fp3_measure_machines *machines);

#endif
