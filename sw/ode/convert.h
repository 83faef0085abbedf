/* convert.h - the graph of a step to instructions with operands that name values. */
#ifndef FP3_CONVERT_H
#define FP3_CONVERT_H

#include "build.h"
#include "code.h"

/* Which additions take a product in before it is rounded to a register. What a chained addition adds to must be
 * there when the product begins: where latency counts, that can make it later. */
typedef enum {
    CHAIN_ALL,
    CHAIN_EARLY, /* where it makes nothing later */
    CHAIN_NONE
} chain_policy;

/* Where a known value is kept. */
typedef struct {
    fp3_place at; /* PARAM or CONSTANT; NOWHERE: it is not needed */
    uint32_t index;
} known_slot;

typedef struct {
    fp3_step step;
    known_slot *slots; /* of each known value */
    uint32_t *params;  /* which known value each is */
    uint32_t *constants;
    uint32_t operations; /* of the step part; a chained one is two */
} conversion;

/* The caller closes, after a failure too. */
fp3_status fp3_convert(const build *b, const fp3_config *config, chain_policy policy,
                       conversion *made, fp3_error *error);
void fp3_convert_close(conversion *made);

#endif
