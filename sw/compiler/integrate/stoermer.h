/* SPDX-License-Identifier: Apache-2.0 */
/* stoermer.h - a step that finds positions from the two before (Stoermer, Verlet). */
#ifndef FP3_STOERMER_H
#define FP3_STOERMER_H

#include "compiler/step/advance.h"

/* a->now and a->lost become those after the step. */
fp3_status fp3_stoermer(fp3_advance *a, fp3_error *error);

#endif
