/* SPDX-License-Identifier: Apache-2.0 */
/* hardware.h - finds and loads the simulated hardware of a configuration.
 *
 *     fp3_hardware hardware;
 *     fp3_status status = fp3_hardware_load("many", &hardware, error);
 *     fp3_rtl *rtl = hardware.ops->open(&watch);
 *     ...
 *     fp3_hardware_unload(&hardware);
 *
 * Each configuration under Verilator is a library of its own, fp3_<configuration>.so, so that a
 * program that never opens the rtl engine needs neither Verilator nor a C++ library.
 */
#ifndef FP3_HARDWARE_H
#define FP3_HARDWARE_H

#include "fp3_rtl.h"

#include <fp3/status.h>

typedef struct {
    void *library;
    const fp3_rtl_ops *ops;
} fp3_hardware;

/* If the environment variable FP3_RTL_DIR is set, looks in that directory only. Otherwise looks in
 * fp3/ beside this library, in ../lib/fp3/ beside the program, and where `make install` puts it.
 * FP3_E_SYSTEM: there is none, it cannot be loaded, or it was built for another libfp3; then
 * *hardware is {0}. */
fp3_status fp3_hardware_load(const char *config, fp3_hardware *hardware, fp3_error *error);
/* Whether there is one to be tried. */
int fp3_hardware_is_there(const char *config);
/* Does nothing to {0}. Everything that ops opened must be closed before. */
void fp3_hardware_unload(fp3_hardware *hardware);

#endif
