/* SPDX-License-Identifier: Apache-2.0 */
/* foreseen.h - how many cycles the hardware will take for a run of objects that see each other. */
#ifndef FP3_FORESEEN_H
#define FP3_FORESEEN_H

#include "engine/common/inside.h"

/* The counter CYCLES of a run of so many steps of the engine's configuration, at least 1, whichever
 * backend the engine has. The program's lists are those that the host has given; lists of those
 * that are near have to be made already. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_foreseen_cycles(const fp3_engine *engine, uint32_t steps, uint64_t *cycles);

#endif
