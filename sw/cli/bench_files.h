/* SPDX-License-Identifier: Apache-2.0 */
/* bench_files.h - what fp3 bench MODEL measured, as files. */
#ifndef FP3_CLI_BENCH_FILES_H
#define FP3_CLI_BENCH_FILES_H

#include "record/gnuplot.h"

#include <jansson.h>

/* All points: a row for each, a column for each of their keys. */
fp3_status fp3_bench_csv(const char *path, const json_t *points, fp3_error *error);

/* What the printed tables show, curve by curve: {"model", "engine", "curve", "how", "step",
 * "error", "worst", "unit" (ns or cycles), "cost"}. A picture has a panel for each model and unit.
 * FP3_E_FAILED: no point can be drawn. */
fp3_status fp3_bench_plot(const char *path, const json_t *shown, fp3_error *error);

#endif
