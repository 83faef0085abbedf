/* gnuplot.h - runs gnuplot on a script. */
#ifndef FP3_OUTPUT_GNUPLOT_H
#define FP3_OUTPUT_GNUPLOT_H

#include <fp3/status.h>
#include <stdio.h>

/* FP3_E_SYSTEM: it is not installed, or does not start. */
fp3_status fp3_gnuplot_check(fp3_error *error);

/* Draws what the script, from its beginning, says; the picture goes to the stream `to`, whose errors are the
 * caller's to look at. FP3_E_SYSTEM: gnuplot does not start or fails; error has what it said. */
fp3_status fp3_gnuplot_draw(FILE *script, FILE *to, fp3_error *error);

#endif
