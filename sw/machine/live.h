/* SPDX-License-Identifier: Apache-2.0 */
/* live.h - which registers of a program something reads later.
 *
 * Between two steps a state may be in its register or, in a program with loads and stores of its
 * own, in its word of the object's record, while the register holds something else or nothing.
 */
#ifndef FP3_LIVE_H
#define FP3_LIVE_H

#include "placement.h"

/* The registers that are live before a word, from those that are live behind it. */
uint64_t fp3_live_before(const fp3_decoded *word, uint64_t live);

/* The registers that a step leaves to the next one or to the last part. A state that is not among
 * them is in its record then. */
uint64_t fp3_live_between(const fp3_code *program);

#endif
