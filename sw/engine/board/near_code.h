/* SPDX-License-Identifier: Apache-2.0 */
/* near_code.h - programs by which hardware with the key `keep` makes a list of near objects. */
#ifndef FP3_NEAR_CODE_H
#define FP3_NEAR_CODE_H

#include "engine/common/lists.h"

#define FP3_NEAR_CODE_MAX 32 /* of one of these programs */

/* What the programs name: registers, which are words of a record likewise, and shared constants by
 * the register that reads them. */
typedef struct {
    uint32_t dimensions;
    uint32_t at[FP3_NEAR_DIMENSIONS];   /* where the object is */
    uint32_t made[FP3_NEAR_DIMENSIONS]; /* where it was when the list was made */
    uint32_t list, source; /* words of the list, and of one that has everybody who may be near */
    uint32_t moved;        /* constant: the square of how far an object may move */
    uint32_t reach;        /* constant: minus the square of how far the list reaches */
    uint32_t room;         /* constant: how many entries the list has room for */
    uint32_t nowhere;      /* constant: FP3_NEAR_NOWHERE */
} fp3_near_names;

typedef struct {
    uint32_t word[FP3_NEAR_CODE_MAX], count;
} fp3_near_code;

/* Where an object was whose position was a NaN: -infinity. As soon as it has a position, it has
 * moved too far. A difference from a NaN would be a NaN, which raises nothing. */
#define FP3_NEAR_NOWHERE 0xFF800000u

/* A word of a position, as `made` has it. */
static inline uint32_t fp3_near_made(uint32_t word) {
    return (word & 0x7FFFFFFFu) > 0x7F800000u ? FP3_NEAR_NOWHERE : word;
}

/* The only list of near objects, if hardware can make it: all objects of one kind are in it, they
 * are where numbers of one word say, and reach equally far. NULL: there is none, or it cannot. */
const fp3_list *fp3_near_code_list(const fp3_lists *lists);

/* An object raises a flag if it has moved too far since the list was made. It computes in registers
 * below `registers` that nothing else needs. */
void fp3_near_check(const fp3_near_names *names, uint32_t registers, fp3_near_code *code);
/* Objects make their lists of those in the source that are near, in its order, and note where they
 * are. Likewise. */
void fp3_near_renew(const fp3_near_names *names, uint32_t registers, fp3_near_code *code);

/* FP32 bits of the constants: of a distance that an object may move, and of the reach of the rule's
 * list. A list made by squares has all that one made by distances has; a check is as early. No
 * distance is infinite here: an object that comes from infinity has moved farther. */
uint32_t fp3_near_moved(double distance);
uint32_t fp3_near_reached(const fp3_near_rule *rule);

#endif
