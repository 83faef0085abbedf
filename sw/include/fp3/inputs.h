/* fp3/inputs.h - what the host writes before a run of a compiled program. */
#ifndef FP3_INPUTS_H
#define FP3_INPUTS_H

#include <fp3/api.h>
#include <fp3/image.h>
#include <stdint.h>

FP3_API_BEGIN

typedef struct {
    char name[FP3_NAME_SIZE];
    int is_shared;   /* a .shared; else a .state or .param of each object */
    uint32_t state;  /* start of this state of the model; FP3_NONE: another value */
    uint32_t low_of; /* double-single: the second word of the start of this state; else FP3_NONE */
    char *formula;   /* as a reader sees it, "1/m"; cut where it is long */
    /* The same for fp3_formula_read, of h, params of the model and numbers. NULL: a state's start, or
     * what no such formula gives, or only a very long one. */
    char *rule;
    /* What the value depends on: params of the model, a bit each, from bit 0; h; where states start and
     * when (`steps`). */
    uint64_t params;
    int has_h, has_start;
} fp3_input;

FP3_API_END

#endif
