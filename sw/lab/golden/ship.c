/* SPDX-License-Identifier: Apache-2.0 */
/* ship.c - Equations (1) of the paper, line by line, in FP32.
 *
 * Must be compiled without contraction (-ffp-contract=off): a fused a*b + c has other bits.
 */
#include "ship.h"

#include <float.h>

#if FLT_EVAL_METHOD != 0
#error "float expressions must be evaluated as float"
#endif

/* k = h*a, where m*a = T - C*v. */
static float k_at(const fp3_ship *ship, float v) {
    const float F = ship->T - ship->C * v;
    const float a = F * ship->rm;
    return ship->h * a;
}

void fp3_ship_step(const fp3_ship *ship, float *v, float *s) {
    const float v0 = *v;
    const float k1 = k_at(ship, v0);
    const float k2 = k_at(ship, v0 + 0.5f * k1);
    const float k3 = k_at(ship, v0 + 0.5f * k2);
    const float k4 = k_at(ship, v0 + k3);
    const float v1 = v0 + 0.16666667f * (((k1 + 2.0f * k2) + 2.0f * k3) + k4);
    *v = v1;
    *s = *s + ship->h * v1;
}
