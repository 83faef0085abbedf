/* SPDX-License-Identifier: Apache-2.0 */
/* room.c - whose memory a world's is. */
#include "own.h"

#include <stdlib.h>

void fp3_identity_give_back(uint32_t *identity) {
    if (identity && --*identity == 0)
        free(identity);
}
