/* adaptive.h - programs of adaptive steps on fp3's engines: points with a tolerance in place of a time step. */
#ifndef FP3_MEASURE_ADAPTIVE_H
#define FP3_MEASURE_ADAPTIVE_H

#include "machines.h"
#include "options.h"

/* What the points use; NULL before the first. */
typedef struct fp3_measure_adaptive fp3_measure_adaptive;

/* Every integrator that estimates its error, plain and compensated: "dopri5 adaptive". */
fp3_status fp3_measure_add_adaptive(fp3_measure_points *points, const fp3_measure_problem *problem,
                                    const fp3_measure_options *options,
                                    fp3_measure_machines *machines, fp3_measure_adaptive **adaptive,
                                    fp3_error *error);
/* After the points. Sets *adaptive to NULL. */
void fp3_measure_adaptive_close(fp3_measure_adaptive **adaptive);

#endif
