/* convert.h - the graph of a step to instructions with operands that name values. */
#ifndef FP3_CONVERT_H
#define FP3_CONVERT_H

#include "build.h"
#include "schedule/code.h"

/* Which additions take a product in before it is rounded to a register. What a chained addition adds
 * to must be there when the product begins: where latency counts, that can make it later. */
typedef enum {
    CHAIN_NONE,
    CHAIN_EARLY, /* where it makes nothing later */
    CHAIN_ALL,
    /* All, and other sums and products go the chain's way as well: a + b as a + 1 b, a b as -0 + a b.
     * Results that are equally late never meet at the write port. */
    CHAIN_SLACK, /* ... that are far from the longest path */
    CHAIN_LONG   /* ... each of them */
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
