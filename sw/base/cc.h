/* SPDX-License-Identifier: Apache-2.0 */
/* cc.h - the C compiler of this machine, for text that is compiled while a program runs. */
#ifndef FP3_CC_H
#define FP3_CC_H

#include <fp3/status.h>

/* What the environment variable FP3_CC names, or "cc". */
const char *fp3_cc(void);

/* Compiles C text to the file `path`, by fp3_cc with these options (ended by NULL). No shell reads
 * any of it. is_told: what the compiler says goes to standard error, else nowhere. FP3_E_SYSTEM:
 * there is no compiler, it fails or takes longer than two minutes, or there is no room for the
 * text. */
fp3_status fp3_cc_compile(const char *text, const char *const *options, const char *path,
                          int is_told, fp3_error *error);

#endif
