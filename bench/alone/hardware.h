/* SPDX-License-Identifier: Apache-2.0 */
/* hardware.h - simulated hardware with a memory, and the bare driver on its bus. */
#ifndef FP3_ALONE_HARDWARE_H
#define FP3_ALONE_HARDWARE_H

#include "bare/fp3_bare_moves.h"
#include "engine/board/hardware.h"

#include <stdio.h>
#include <stdlib.h>

#define POLLS UINT32_MAX

#define NEED(what)                                                                                 \
    do {                                                                                           \
        if (!(what)) {                                                                             \
            fprintf(stderr, "alone: %s, line %d: not so: %s\n", __FILE__, __LINE__, #what);        \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

typedef struct {
    fp3_hardware hardware;
    fp3_rtl *rtl;
    fp3_rtl_memory shape;
    uint32_t *memory;
    uint64_t accesses; /* of the host, through AXI4-Lite, but those that ask whether words move */
    fp3_bare fp3;
} alone;

/* Ends the program where something is not there. waits: a seed for waits on all channels, 0: none.
 */
void alone_open(alone *a, const char *config, const fp3_rtl_memory *shape, uint64_t waits);
void alone_close(alone *a);
uint64_t alone_now(const alone *a);
/* Rows of a lane, there or back, until all have moved. */
void alone_move(alone *a, fp3_bare_direction direction, uint32_t lane, uint32_t row, uint32_t rows,
                uint32_t memory);

#endif
