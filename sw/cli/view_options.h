/* SPDX-License-Identifier: Apache-2.0 */
/* view_options.h - the command line of fp3 view. */
#ifndef FP3_CLI_VIEW_OPTIONS_H
#define FP3_CLI_VIEW_OPTIONS_H

#include "view/picture.h"

typedef struct {
    const char *recording, *output; /* output: NULL where pictures alone are asked for */
    char *own_output;               /* its name if none is given */
    const char *png, *film;         /* NULL: not asked for */
    double at;                      /* the time of the picture */
    int has_at;
    uint16_t rate;   /* of the film: snapshots a second; 0: as many as in the recording's time */
    double range[2]; /* of colours */
    int has_range;
    fp3_view_look look;
    fp3_view_wishes wishes;
    uint64_t every; /* snapshots */
    fp3_view_page page;
} fp3_view_options;

/* Ends with 2 and a message if they are wrong. */
void fp3_view_options_parse(int argc, char **argv, fp3_view_options *o);
void fp3_view_options_free(fp3_view_options *o);

#endif
