/* SPDX-License-Identifier: Apache-2.0 */
/* fp3_rtl.h - one simulated FP3: its clock, its bus, what it issues and retires.
 *
 * sim/fp3_shim.cpp, compiled once per configuration, is the only code that knows Verilator. With
 * its Verilated hardware it is a library, fp3_<configuration>.so, that exports one table,
 * fp3_rtl_table.
 */
#ifndef FP3_RTL_H
#define FP3_RTL_H

#include <fp3/engine.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fp3_rtl fp3_rtl;

/* An instruction issues, once for all lanes of its scheduler. */
typedef struct {
    uint64_t cycle;
    uint32_t scheduler, context, pc, word;
} fp3_rtl_issue;

/* An instruction ends in a lane. Of `result` register, bits and flags mean something only if
 * has_result; object is the number within the lane. */
typedef struct {
    fp3_retirement result;
    fp3_outcome outcome;
    int has_result;
} fp3_rtl_end;

/* Who watches, NULL where nobody does. The ends of one cycle come lane by lane, after its issues.
 */
typedef struct {
    void (*issue)(void *user, const fp3_rtl_issue *issue);
    void (*end)(void *user, const fp3_rtl_end *end);
    void *user;
} fp3_rtl_watch;

/* Raise it with every change of this header, or of a structure that it takes from elsewhere. */
#define FP3_RTL_VERSION 4u

/* One transfer on the bus. */
typedef struct {
    uint32_t address, data; /* data: to be written, or what was read */
    uint8_t is_write;
    uint8_t is_refused; /* it was answered with an error, or the address is outside of the
                           processor's window */
} fp3_rtl_word;

/* A memory on the port of a configuration with `master`: one data bus of this many words in 1,000
 * cycles, reads and writes together, though the port takes one of each in a cycle. */
typedef struct {
    uint32_t words;   /* from byte address 0 on; beyond them it answers with DECERR */
    uint32_t rate;    /* above 0 */
    uint32_t latency; /* cycles from an address to the first word, and from the last one to the
                         response */
} fp3_rtl_memory;

typedef struct {
    /* FP3_RTL_VERSION and sizeof(fp3_rtl_ops), where the table was compiled. */
    uint32_t version, size;
    const char *config;
    /* Clocked through reset; NULL: out of memory. waits: a seed for how long the master of the bus
     * lets each channel wait in each transfer, 0 to 3 cycles; 0: never. */
    fp3_rtl *(*open)(const fp3_rtl_watch *watch, uint64_t waits);
    void (*close)(fp3_rtl *rtl);
    /* Transfers on the AXI4-Lite bus: the writes in their order, the reads in theirs, both at the
     * same time; the master waits for no response before it goes on. Returns when all are answered.
     * -1: one was not, or against the rules of the bus. */
    int (*transfer)(fp3_rtl *rtl, fp3_rtl_word *words, size_t count);
    /* Clocks until nothing has issued or retired, in any scheduler, for quiet cycles in a row;
     * cycles at most. */
    void (*clock)(fp3_rtl *rtl, uint64_t cycles, uint64_t quiet);
    /* Puts a memory there, all 0, instead of the one before. Its words, which the hardware may
     * change in each cycle; NULL: there is no such port, or out of memory. Until then there is a
     * memory of no word. With waits of open each channel waits by chance. */
    uint32_t *(*memory)(fp3_rtl *rtl, const fp3_rtl_memory *how);
    /* Cycles since open, those of transfers included. */
    uint64_t (*now)(const fp3_rtl *rtl);
} fp3_rtl_ops;

/* One alone: 0: done; 1: refused; -1: see transfer. */
static inline int fp3_rtl_transfer_one(const fp3_rtl_ops *ops, fp3_rtl *rtl, int is_write,
                                       uint32_t address, uint32_t *data) {
    fp3_rtl_word word = {address, is_write ? *data : 0, (uint8_t)(is_write != 0), 0};
    const int result = ops->transfer(rtl, &word, 1);
    if (!is_write && !result)
        *data = word.data;
    return result ? result : word.is_refused;
}

#ifdef __cplusplus
}
#endif
#endif
