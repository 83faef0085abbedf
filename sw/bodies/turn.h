/* SPDX-License-Identifier: Apache-2.0 */
/* turn.h - sine and cosine without a library's, so that all machines have the same bits. */
#ifndef FP3_BODIES_TURN_H
#define FP3_BODIES_TURN_H

/* Turns (cosine, sine) by an angle, and makes its length 1 again. Error below 2e-7 for |angle| up
 * to 1; beyond, 2e-7 for each doubling. A NaN gives NaN. */
void fp3_turn2_by(float turn[2], float angle);
/* The cosine and the sine of any angle, within 1e-15; of one that is not finite NaN. */
void fp3_turn2_of(double angle, double turn[2]);

#endif
