/* SPDX-License-Identifier: Apache-2.0 */
/* ship.h - the ship of the paper's Equations (1) in FP32, independently of any instruction
 * stream.
 *
 *     fp3_ship ship = {.T = 2.9e5f, .C = 4.1e4f, .rm = 1.0f / 8.7e5f, .h = 0.0078125f};
 *     float v = 0.0f, s = 0.0f;
 *     fp3_ship_step(&ship, &v, &s);
 */
#ifndef FP3_GOLDEN_SHIP_H
#define FP3_GOLDEN_SHIP_H

typedef struct {
    float T;  /* propeller thrust [N] */
    float C;  /* drag coefficient [kg/s] */
    float rm; /* 1/m [1/kg]; the machine multiplies, as the paper does */
    float h;  /* time step [s] */
} fp3_ship;

/* Equations (1) once: *v [m/s] and *s [m] go from t to t + h. Any values, as IEEE 754 has them. The
 * position, s = s + h*v1, is of first order: its error is about h/2 times the change of speed,
 * whatever the arithmetic. */
void fp3_ship_step(const fp3_ship *ship, float *v, float *s);

#endif
