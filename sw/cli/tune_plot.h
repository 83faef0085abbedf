/* SPDX-License-Identifier: Apache-2.0 */
/* tune_plot.h - what fp3 tune tried, as a picture: error against cost. */
#ifndef FP3_CLI_TUNE_PLOT_H
#define FP3_CLI_TUNE_PLOT_H

#include <fp3/tune.h>

/* FP3_E_FAILED: no run has an error; FP3_E_SYSTEM: gnuplot fails, or the file cannot be written. */
fp3_status fp3_tune_plot(const char *path, const fp3_tune_def *def, const fp3_tuning *tuning,
                         fp3_error *error);

#endif
