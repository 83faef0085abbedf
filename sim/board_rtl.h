/* SPDX-License-Identifier: Apache-2.0 */
/* board_rtl.h - one simulated board: rtl/board/fp3_board_top.v with a configuration, seen from its
 * serial line.
 *
 * sim/board_shim.cpp, compiled once for each configuration that has a board, is a library,
 * fp3_board_<configuration>.so, that exports one table, fp3_board_table.
 */
#ifndef FP3_BOARD_RTL_H
#define FP3_BOARD_RTL_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fp3_board fp3_board;

/* Raise it with every change of this header. */
#define FP3_BOARD_VERSION 1u

typedef struct {
    /* FP3_BOARD_VERSION and sizeof(fp3_board_ops), where the table was compiled. */
    uint32_t version, size;
    /* Clocked through reset; NULL: out of memory, or it never ends. */
    fp3_board *(*open)(void);
    void (*close)(fp3_board *board);
    /* Clocks `cycles` cycles. The line takes what it has time for of size bytes: *taken says how
     * many. Returns how many bytes came from the board, into `out`, which has room for cycles / 32
     * + 1. */
    size_t (*clock)(fp3_board *board, uint64_t cycles, const uint8_t *in, size_t size,
                    size_t *taken, uint8_t *out);
} fp3_board_ops;

#ifdef __cplusplus
}
#endif
#endif
