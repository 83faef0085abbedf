/* SPDX-License-Identifier: Apache-2.0 */
/* turned.c - see turned.h. */
#include "turned.h"

#include <math.h>

#define DEGREE 0.017453292519943295
#define TERMS 15

/* The series: within 1e-15 up to 90 degrees, and the same on every machine. */
static double series(double x, double term, int first) {
    double sum = term;
    for (int i = 0; i < TERMS; i++) {
        term = -term * x * x / ((first + 2 * i + 1) * (first + 2 * i + 2));
        sum += term;
    }
    return sum;
}

/* Into -180 .. 180 degrees. */
static double wrapped(double degrees) { return degrees - 360 * floor(degrees / 360 + 0.5); }

void fp3_view_turned(double degrees, double cosine_sine[2]) {
    const double x = wrapped(degrees) * DEGREE;
    cosine_sine[0] = series(x, 1, 0);
    cosine_sine[1] = series(x, x, 1);
}
