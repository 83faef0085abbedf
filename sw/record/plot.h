/* SPDX-License-Identifier: Apache-2.0 */
/* plot.h - a recording as a picture, SVG or PNG. */
#ifndef FP3_OUTPUT_PLOT_H
#define FP3_OUTPUT_PLOT_H

#include "sink.h"

/* The subject must outlive the sink; the caller closes it. FP3_E_ARGUMENT: the name does not end in
 * .svg or .png, or there is too much to draw; FP3_E_SYSTEM: gnuplot is not installed. */
fp3_status fp3_plot_open(const fp3_subject *subject, fp3_sink **sink, fp3_error *error);

#endif
