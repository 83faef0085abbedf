/* engine.h - fp3's own engines, and the cycles of hardware. */
#ifndef FP3_MEASURE_ENGINE_H
#define FP3_MEASURE_ENGINE_H

#include "machines.h"
#include "options.h"

fp3_status fp3_measure_add_engine(fp3_measure_points *points, const fp3_measure_problem *problem,
                                  const fp3_measure_options *options,
                                  fp3_measure_machines *machines, fp3_error *error);

#endif
