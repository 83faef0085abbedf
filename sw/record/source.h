/* SPDX-License-Identifier: Apache-2.0 */
/* source.h - where a recording gets its values. */
#ifndef FP3_OUTPUT_SOURCE_H
#define FP3_OUTPUT_SOURCE_H

#include <fp3/program.h>

typedef struct {
    const fp3_program *program;
    const fp3_params *params; /* that the program was loaded with */
    fp3_engine *engine;
    size_t group, first, objects; /* the group that is recorded, and its objects of the engine */
    int has_time;                 /* the program has a time step: */
    double h;                     /* in double what it has in FP32, or in double-single */
    double h_given;               /* before it was rounded */
} fp3_source;

/* Asks params and the engine for h. */
fp3_status fp3_source_find_h(fp3_source *source, fp3_error *error);

#endif
