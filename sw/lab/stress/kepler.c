/* SPDX-License-Identifier: Apache-2.0 */
/* kepler.c - see kepler.h. */
#include "kepler.h"

#include <math.h>
#include <stdlib.h>

#define TURN 2.399963229728653 /* the golden angle: no two objects are alike */

const char fp3_kepler_text[] = "model kepler\nstate v[2] = (0, 1)\nstate r[2] = (1, 0)\nstep 1\n"
                               "v' = -r/norm(r)^3\nr' = v\n";

fp3_status fp3_kepler_fill(fp3_lab *lab, size_t objects, double eccentricity, fp3_error *error) {
    static const char *const names[FP3_KEPLER_STATES] = {"v_x", "v_y", "r_x", "r_y"};
    const double r = 1 - eccentricity, v = sqrt((1 + eccentricity) / (1 - eccentricity));
    double *column = calloc(objects, sizeof *column);
    fp3_status status = column ? FP3_OK : fp3_no_memory(error);
    for (int s = 0; !status && s < FP3_KEPLER_STATES; s++) {
        for (size_t i = 0; i < objects; i++) {
            const double c = cos(TURN * (double)i), n = sin(TURN * (double)i);
            column[i] = s == 0 ? -v * n : s == 1 ? v * c : s == 2 ? r * c : r * n;
        }
        status = fp3_lab_fill(lab, names[s], column, error);
    }
    free(column);
    return status;
}

double fp3_kepler_energy(const double *row) {
    return (row[0] * row[0] + row[1] * row[1]) / 2 - 1 / hypot(row[2], row[3]);
}

double fp3_kepler_momentum(const double *row) { return row[2] * row[1] - row[3] * row[0]; }

void fp3_kepler_truth(const double *start, double t, double *row) {
    const double r0 = hypot(start[2], start[3]), a = -0.5 / fp3_kepler_energy(start);
    const double n = 1 / (a * sqrt(a)), s = (start[0] * start[2] + start[1] * start[3]) / sqrt(a);
    const double m = remainder(n * t, 2 * M_PI);
    double e = m; /* how far the eccentric anomaly has come, without whole turns */
    for (int i = 0; i < 50; i++) {
        const double f = e + s * (1 - cos(e)) - (1 - r0 / a) * sin(e) - m;
        e -= f / (1 + s * sin(e) - (1 - r0 / a) * cos(e));
    }
    const double r = a * (1 - (1 - r0 / a) * cos(e)) + a * s * sin(e);
    const double f = 1 - a / r0 * (1 - cos(e)), g = (m - e + sin(e)) / n;
    const double df = -sqrt(a) / (r * r0) * sin(e), dg = 1 - a / r * (1 - cos(e));
    for (int j = 0; j < 2; j++) {
        row[2 + j] = f * start[2 + j] + g * start[j];
        row[j] = df * start[2 + j] + dg * start[j];
    }
}
