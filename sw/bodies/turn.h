/* SPDX-License-Identifier: Apache-2.0 */
/* turn.h - sine and cosine without a library's, so that all machines have the same bits. */
#ifndef FP3_BODIES_TURN_H
#define FP3_BODIES_TURN_H

/* Turns (cosine, sine) by an angle, and makes its length 1 again. Error below 2e-7. */
void fp3_turn2_by(float turn[2], float angle);
/* The cosine and the sine of an angle, within 1e-15 and 2^-52 of the angle. One beyond 1e12, or
 * that is not finite, turns nothing. */
void fp3_turn2_of(double angle, double turn[2]);
/* The angle of a sine and a cosine of any common length, from -pi to pi, within 1e-15; 0 of two
 * zeros. */
double fp3_angle_of(double sine, double cosine);

#endif
