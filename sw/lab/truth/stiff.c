/* SPDX-License-Identifier: Apache-2.0 */
/* stiff.c - eigenvalues by GSL, where the norm of the Jacobian allows large ones. */
#include "stiff.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <math.h>

/* No eigenvalue is larger than the largest sum of a row, or of a column. */
static double bound(const gsl_matrix *m) {
    double rows = 0, columns = 0;
    for (size_t i = 0; i < m->size1; i++) {
        double row = 0, column = 0;
        for (size_t k = 0; k < m->size1; k++) {
            row += fabs(gsl_matrix_get(m, i, k));
            column += fabs(gsl_matrix_get(m, k, i));
        }
        rows = fmax(rows, row);
        columns = fmax(columns, column);
    }
    return fmin(rows, columns);
}

static double largest_damping(const gsl_vector_complex *values, double h) {
    double most = 0;
    for (size_t i = 0; i < values->size; i++) {
        const gsl_complex z = gsl_vector_complex_get(values, i);
        if (h * GSL_REAL(z) < 0)
            most = fmax(most, fabs(h) * hypot(GSL_REAL(z), GSL_IMAG(z)));
    }
    return most;
}

int fp3_stiff_reach(const gsl_odeiv2_system *system, double t, double h, const double *y,
                    double least, double *reach) {
    const size_t count = system->dimension;
    gsl_matrix *m = gsl_matrix_alloc(count, count);
    gsl_vector *by_time = gsl_vector_alloc(count);
    gsl_vector_complex *values = gsl_vector_complex_alloc(count);
    gsl_eigen_nonsymm_workspace *room = gsl_eigen_nonsymm_alloc(count);
    int result = m && by_time && values && room ? GSL_SUCCESS : GSL_ENOMEM;
    *reach = 0;
    if (!result) {
        const int has = system->jacobian(t, y, m->data, by_time->data, system->params);
        if (has == GSL_ENOMEM)
            result = has;
        else if (!has && fabs(h) * bound(m) >= least && !gsl_eigen_nonsymm(m, values, room))
            *reach = largest_damping(values, h);
    }
    gsl_matrix_free(m);
    gsl_vector_free(by_time);
    gsl_vector_complex_free(values);
    gsl_eigen_nonsymm_free(room);
    return result;
}
