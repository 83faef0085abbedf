/* view_options.h - the command line of fp3 view. */
#ifndef FP3_CLI_VIEW_OPTIONS_H
#define FP3_CLI_VIEW_OPTIONS_H

#include "view/page.h"

typedef struct {
    const char *recording, *output;
    char *own_output; /* the output's name where nobody gave one */
    fp3_view_wishes wishes;
    uint64_t every; /* snapshots */
    fp3_view_page page;
} fp3_view_options;

/* Ends with 2 and a message if they are wrong. */
void fp3_view_options_parse(int argc, char **argv, fp3_view_options *o);
void fp3_view_options_free(fp3_view_options *o);

#endif
