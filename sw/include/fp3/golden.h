/* fp3/golden.h - the ship of the paper's Equations (1), twice and independently of any instruction
 * stream: golden in FP32, for bits; truth in double, for errors.
 *
 *     fp3_ship ship = {.T = 2.9e5f, .C = 4.1e4f, .rm = 1.0f / 8.7e5f, .h = 0.0078125f};
 *     float v = 0.0f, s = 0.0f;
 *     fp3_ship_step(&ship, &v, &s);
 */
#ifndef FP3_GOLDEN_H
#define FP3_GOLDEN_H

#include <fp3/status.h>

typedef struct {
    float T;  /* propeller thrust [N] */
    float C;  /* drag coefficient [kg/s] */
    float rm; /* 1/m [1/kg]; the machine multiplies, as the paper does */
    float h;  /* time step [s] */
} fp3_ship;

/* Equations (1) once: *v [m/s] and *s [m] go from t to t + h. Any values, as IEEE 754 has them. */
void fp3_ship_step(const fp3_ship *ship, float *v, float *s);

/* Speed and position at time t [s] from *v and *s at time 0, by GSL's rk8pd, cross-checked with the
 * closed form: FP3_E_MISMATCH if they differ by more than 1e-10 of their size. T [N], C [kg/s] and
 * m [kg] as above; FP3_E_ARGUMENT unless C > 0, m > 0 and t >= 0. After a failure *v and *s are
 * unchanged.
 * The position of Equations (1), s = s + h*v1, is of first order: against this truth its error is
 * about h/2 times the change of speed, whatever the arithmetic. */
fp3_status fp3_ship_truth(double T, double C, double m, double t, double *v, double *s,
                          fp3_error *error);

#endif
