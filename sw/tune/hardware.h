/* hardware.h - what whole processors take on an FPGA. */
#ifndef FP3_TUNE_HARDWARE_H
#define FP3_TUNE_HARDWARE_H

#include <stddef.h>

/* Of an LFE5U-85F of speed grade 6, placed: LUT4 and MHz of docs/synth.json and docs/arithmetic.md, with which tests/tune
 * compares them. */
typedef struct {
    const char *config;
    int luts;
    double mhz;
} fp3_hardware;

extern const fp3_hardware fp3_hardware_known[];
extern const size_t fp3_hardware_count;

/* NULL: there is no figure. */
const fp3_hardware *fp3_hardware_find(const char *config);

#endif
