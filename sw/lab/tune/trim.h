/* SPDX-License-Identifier: Apache-2.0 */
/* trim.h - of a configuration only what a program needs. */
#ifndef FP3_TUNE_TRIM_H
#define FP3_TUNE_TRIM_H

#include <fp3/tune.h>

/* The best row's program on the tuner's configuration, without what it does not use: lines as in
 * isa/configs.toml, and LUTs in lines that begin with #. objects: for which the store has room. The
 * caller frees *text. FP3_E_ARGUMENT: there is no best row. */
fp3_status fp3_tuning_hardware(const fp3_tune_def *def, const fp3_tuning *tuning, uint32_t objects,
                               char **text, fp3_error *error);

#endif
