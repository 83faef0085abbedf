/* emit.h - a schedule as assembly that a person can read. */
#ifndef FP3_EMIT_H
#define FP3_EMIT_H

#include "convert.h"

/* Names of what the program declares. */
typedef struct {
    char (*object)[FP3_NAME_SIZE];   /* of each object register */
    char (*constant)[FP3_NAME_SIZE]; /* of each shared constant; a number stands for itself */
    uint32_t object_count, constant_count;
} emit_names;

/* FP3_E_SYSTEM, or FP3_E_PROGRAM: a number is too large for FP32. The caller closes, after a failure too. */
fp3_status fp3_emit_names(const build *b, const conversion *c, const fp3_schedule *schedule,
                          emit_names *names, fp3_error *error);
void fp3_emit_names_close(emit_names *names);

/* The caller frees *text. head: comment lines for the top, each beginning with '#'. */
fp3_status fp3_emit(const build *b, const conversion *c, const fp3_schedule *schedule,
                    const emit_names *names, const char *head, char **text, fp3_error *error);

#endif
