/* SPDX-License-Identifier: Apache-2.0 */
/* turn.c - see turn.h. */
#include "turn.h"

#include <math.h>

/* Taylor's polynomials; below 1/2 what is left out is below 2^-26. */
static void small_turn(float x, float turn[2]) {
    const float y = x * x;
    turn[0] = 1 - y * (0.5f - y * (1.0f / 24 - y * (1.0f / 720 - y * (1.0f / 40320))));
    turn[1] = x - x * y * (1.0f / 6 - y * (1.0f / 120 - y * (1.0f / 5040)));
}

/* pi/2 in three parts, of which the first two have 33 bits, as in Cody and Waite. */
#define QUARTER_1 1.57079632673412561417
#define QUARTER_2 6.07710050630396597660e-11
#define QUARTER_3 2.02226624879595063154e-21
#define TWO_OVER_PI 0.63661977236758134308
#define FARTHEST 1e12 /* beyond it no digit of a turn is left */

void fp3_turn2_of(double angle, double turn[2]) {
    if (!(fabs(angle) <= FARTHEST)) {
        turn[0] = 1;
        turn[1] = 0;
        return;
    }
    const double n = floor(angle * TWO_OVER_PI + 0.5);
    const double x = ((angle - n * QUARTER_1) - n * QUARTER_2) - n * QUARTER_3, y = x * x;
    double c = 1, s = 1;
    for (int k = 10; k > 0; k--) {
        c = 1 - y * c / ((2 * k - 1) * (2 * k));
        s = 1 - y * s / ((2 * k) * (2 * k + 1));
    }
    s *= x;
    const int quarter = (int)((long long)n & 3);
    turn[0] = quarter == 0 ? c : quarter == 1 ? -s : quarter == 2 ? -c : s;
    turn[1] = quarter == 0 ? s : quarter == 1 ? c : quarter == 2 ? -s : -c;
}

#define PI 3.14159265358979323846

/* Half of the angle three times; then the series of the arctangent. */
double fp3_angle_of(double sine, double cosine) {
    double y = fabs(sine), x = cosine, length = sqrt(x * x + y * y), sum = 0;
    if (!(length > 0))
        return 0;
    if (x < 0 && y == 0)
        return PI;
    for (int k = 0; k < 3; k++) { /* tan a/2 = y/(length + x) */
        const double far = length + x;
        if (far <= 0)
            return sine < 0 ? -PI : PI;
        y /= far;
        x = 1;
        length = sqrt(1 + y * y);
    }
    const double z = y * y; /* tan pi/8: below 0.172 */
    for (int k = 21; k > 0; k -= 2)
        sum = 1.0 / k - z * sum;
    return (sine < 0 ? -8 : 8) * y * sum;
}

void fp3_turn2_by(float turn[2], float angle) {
    float by[2];
    if (fabsf(angle) <= 0.5f) {
        small_turn(angle, by);
    } else {
        double large[2];
        fp3_turn2_of((double)angle, large);
        by[0] = (float)large[0];
        by[1] = (float)large[1];
    }
    const float c = turn[0] * by[0] - turn[1] * by[1], s = turn[1] * by[0] + turn[0] * by[1];
    const float length = sqrtf(c * c + s * s);
    turn[0] = c / length;
    turn[1] = s / length;
}
