/* fp3_rtl.h - one simulated FP3: its clock, its host port, its retirements.
 *
 * sim/fp3_shim.cpp, compiled once per configuration, is the only code that knows Verilator; it
 * exports one table, fp3_rtl_<configuration>.
 */
#ifndef FP3_RTL_H
#define FP3_RTL_H

#include <fp3/engine.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fp3_rtl fp3_rtl;

typedef struct {
    const char *config;
    /* Clocked through reset; NULL: out of memory. retire may be NULL. */
    fp3_rtl *(*open)(fp3_retire_fn *retire, void *user);
    void (*close)(fp3_rtl *rtl);
    /* One request and its response on the host port. 0: done; 1: the hardware answered with an
     * error; -1: it did not answer. */
    int (*transfer)(fp3_rtl *rtl, int is_write, uint32_t address, uint32_t *data);
    /* Clocks until nothing has retired for quiet cycles in a row; cycles at most. Returns
     * the number of cycles. */
    uint64_t (*clock)(fp3_rtl *rtl, uint64_t cycles, uint64_t quiet);
} fp3_rtl_ops;

#ifdef __cplusplus
}
#endif
#endif
