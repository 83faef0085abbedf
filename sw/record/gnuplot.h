/* SPDX-License-Identifier: Apache-2.0 */
/* gnuplot.h - runs gnuplot on a script. */
#ifndef FP3_OUTPUT_GNUPLOT_H
#define FP3_OUTPUT_GNUPLOT_H

#include <fp3/status.h>
#include <stdio.h>

/* FP3_E_SYSTEM: it is not installed, or does not start. */
fp3_status fp3_gnuplot_check(fp3_error *error);

/* Whether the name is that of a picture, too. FP3_E_ARGUMENT: it ends in neither .svg nor .png. */
fp3_status fp3_gnuplot_check_picture(const char *path, fp3_error *error);

/* Of curve number i, from 0: eight that everybody tells apart, then the same again. */
const char *fp3_gnuplot_colour(size_t i);

/* Writes a script, and in it every number with a point, whatever the user's language. */
typedef void fp3_gnuplot_script_fn(const void *user, FILE *script);

/* The first lines of a script: the kind of picture, by its name, and its size in pixels; a grid,
 * and the legend to the right of `right`, a share of the width. */
void fp3_gnuplot_begin(FILE *script, const char *path, int width, int height, double right);

/* Draws what the script says into a stream. FP3_E_SYSTEM: gnuplot does not start or fails, and
 * error has what it said; what cannot be written, the stream remembers. */
fp3_status fp3_gnuplot_write(fp3_gnuplot_script_fn *script, const void *user, FILE *to,
                             fp3_error *error);

#endif
