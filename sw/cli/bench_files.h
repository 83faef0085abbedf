/* SPDX-License-Identifier: Apache-2.0 */
/* bench_files.h - what fp3 bench MODEL measured, as files. */
#ifndef FP3_CLI_BENCH_FILES_H
#define FP3_CLI_BENCH_FILES_H

#include "record/gnuplot.h"

#include <jansson.h>

/* All points: a row for each, a column for each of their keys. */
fp3_status fp3_bench_csv(const char *path, const json_t *points, fp3_error *error);

/* What the printed tables show, curve by curve: {"model", "engine", "curve", "how", "step", "error", "worst", "unit" (ns or
 * cycles), "cost"}. A picture has a panel for each model and unit. FP3_E_FAILED: no point can be drawn. */
fp3_status fp3_bench_plot(const char *path, const json_t *shown, fp3_error *error);

/* The same as a page that loads nothing: pictures and tables. */
typedef struct {
    const char *path;
    int argc;
    char **argv;            /* the command */
    const json_t *problems; /* of fp3_measure_json */
    const json_t *shown;
} fp3_bench_page;
fp3_status fp3_bench_html(const fp3_bench_page *page, fp3_error *error);

/* Of a model (NULL: of all) and a unit (NULL: both) the panels as SVG or as PNG, by the ending of path; for fp3_gnuplot_write. */
typedef struct {
    const char *path, *model, *unit;
    const json_t *shown;
} fp3_bench_picture;
void fp3_bench_script(const void *picture, FILE *script);
/* How many points it has. */
size_t fp3_bench_drawn(const fp3_bench_picture *picture);
/* Whether a point is in the picture, whose axes have no room for 0. */
int fp3_bench_is_drawn(const fp3_bench_picture *picture, const json_t *point);

#endif
