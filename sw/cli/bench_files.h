/* bench_files.h - what fp3 bench MODEL measured, as a table and as a picture. */
#ifndef FP3_CLI_BENCH_FILES_H
#define FP3_CLI_BENCH_FILES_H

#include <fp3/status.h>
#include <jansson.h>

/* All points: a row for each, a column for each of their keys. */
fp3_status fp3_bench_csv(const char *path, const json_t *points, fp3_error *error);

/* Before anything is measured. FP3_E_ARGUMENT: the name is not that of a picture; FP3_E_SYSTEM: no gnuplot. */
fp3_status fp3_bench_plot_check(const char *path, fp3_error *error);

/* The points that the tables show: {"model", "curve", "unit", "cost", "error"}, curve by curve. */
fp3_status fp3_bench_plot(const char *path, const json_t *shown, fp3_error *error);

#endif
