/* SPDX-License-Identifier: Apache-2.0 */
/* guess.h - a guess of joints gives no energy.
 *
 * Joints begin a substep with the impulses that they had in the last one. Where arms turn far in a
 * substep, or two joints hold the same bodies against each other, those are so wrong that one pass
 * does not mend them, and energy grows from substep to substep. An impulse that holds takes energy;
 * so where the guesses of bodies that are joined would raise their kinetic energy by more than a
 * fiftieth, they are made smaller, by one factor for all of them. Passes find what is missing.
 *
 * Springs and motors give energy, and so do bodies that the caller moves: guesses of bodies that
 * are joined by one of these stay. No engine does it, so all engines have the same bits.
 */
#ifndef FP3_BODIES_GUESS_H
#define FP3_BODIES_GUESS_H

#include "own.h"

/* Of a step, behind rows of joints: who is joined. */
fp3_status fp3_guess_begin(fp3_bodies *bodies);
/* Whether there is anything to do in this step. */
int fp3_guess_has(const fp3_bodies *bodies);
/* Before joints give their guesses, and behind that. */
void fp3_guess_note(fp3_bodies *bodies);
void fp3_guess_check(fp3_bodies *bodies);
void fp3_guess_free(fp3_bodies *bodies);

#endif
