/* SPDX-License-Identifier: Apache-2.0 */
/* bench_files.h - what fp3 bench MODEL measured, as a file. */
#ifndef FP3_CLI_BENCH_FILES_H
#define FP3_CLI_BENCH_FILES_H

#include <fp3/status.h>
#include <jansson.h>

/* All points: a row for each, a column for each of their keys. */
fp3_status fp3_bench_csv(const char *path, const json_t *points, fp3_error *error);

#endif
