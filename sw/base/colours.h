/* SPDX-License-Identifier: Apache-2.0 */
/* colours.h - contacts of a colour share no body that moves.
 *
 * Each contact, in the order of their numbers, gets the first colour that both of its bodies do not
 * have yet. Bodies that do not move never block. So colours depend on the list alone.
 */
#ifndef FP3_COLOURS_H
#define FP3_COLOURS_H

#include <fp3/status.h>
#include <stdint.h>

#define FP3_COLOURS_MASKED 64 /* beyond these each contact is a colour of its own */

typedef struct {
    uint32_t count;  /* colours */
    uint32_t *first; /* block of each; one more behind the last */
    uint32_t room;
    uint64_t *taken; /* of each body */
    uint32_t body_room;
} fp3_colours;

/* a and b: the two bodies of each contact; those from `movable` on never block. colour[i] receives
 * the colour of contact i, place[i] its block times `wide` and its lane: colours begin a block, and
 * have contacts in their order. A colour has a multiple of
 * `together` blocks. */
fp3_status fp3_colours_find(fp3_colours *colours, const uint32_t *a, const uint32_t *b,
                            uint32_t count, uint32_t movable, uint32_t wide, uint32_t together,
                            uint32_t *colour, uint32_t *place, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_colours_free(fp3_colours *colours);

#endif
