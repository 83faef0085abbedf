/* SPDX-License-Identifier: Apache-2.0 */
/* placed.h - what whole processors take on an FPGA. */
#ifndef FP3_TUNE_PLACED_H
#define FP3_TUNE_PLACED_H

#include <stddef.h>

/* Of an LFE5U-85F of speed grade 6, placed: LUT4 and MHz of docs/synth.json and docs/arithmetic.md,
 * with which tests/tune compares them. */
typedef struct {
    const char *config;
    int luts;
    double mhz;
} fp3_placed;

extern const fp3_placed fp3_placed_known[];
extern const size_t fp3_placed_count;

/* NULL: there is no figure. */
const fp3_placed *fp3_placed_find(const char *config);

#endif
