/* apply.h - a program's values to an engine. */
#ifndef FP3_SCENE_APPLY_H
#define FP3_SCENE_APPLY_H

#include <fp3/program.h>

/* Objects of an engine that run the program: a group of it. */
typedef struct {
    fp3_engine *engine;
    size_t group, first, objects;
} fp3_apply_to;

/* Writes all that the program declares, as fp3_program_load does. error stays as it is where the
 * engine has said why. */
fp3_status fp3_apply(const fp3_program *program, const fp3_params *params, const fp3_apply_to *to,
                     fp3_error *error);

#endif
