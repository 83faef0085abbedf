/* truth.c - where the ship really is: GSL at a tight tolerance, and the closed form to check it. */
#include <fp3/golden.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>

#define TOLERANCE 1e-13 /* of GSL's steps, absolute and relative */
#define AGREEMENT 1e-10 /* of the two ways, relative */

typedef struct {
    double T, C, m;
} ship;

static int derivative(double t, const double y[], double dydt[], void *parameters) {
    (void)t;
    const ship *p = parameters;
    dydt[0] = (p->T - p->C * y[0]) / p->m;
    dydt[1] = y[0];
    return GSL_SUCCESS;
}

static int apart(double a, double b) {
    return !(fabs(a - b) <= AGREEMENT * fmax(fabs(a), fabs(b)));
}

fp3_status fp3_ship_truth(double T, double C, double m, double t, double *v, double *s,
                          fp3_error *error) {
    if (!(C > 0 && m > 0 && t >= 0))
        return fp3_fail(error, FP3_E_ARGUMENT, "a ship needs C > 0 and m > 0: C = %g, m = %g", C,
                        m);

    /* m v' = T - C v: v falls to its final speed T/C with the rate C/m, and s is its integral. */
    const double final = T / C, rate = C / m;
    const double closed_v = final + (*v - final) * exp(-rate * t);
    const double closed_s = *s + final * t - (*v - final) * expm1(-rate * t) / rate;

    ship parameters = {T, C, m};
    gsl_odeiv2_system system = {derivative, NULL, 2, &parameters};
    gsl_error_handler_t *handler = gsl_set_error_handler_off(); /* GSL's own ends the program */
    gsl_odeiv2_driver *driver =
        gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-6, TOLERANCE, TOLERANCE);
    double now = 0, y[2] = {*v, *s};
    const int result = driver ? gsl_odeiv2_driver_apply(driver, &now, t, y) : GSL_ENOMEM;
    if (driver)
        gsl_odeiv2_driver_free(driver);
    gsl_set_error_handler(handler);
    if (result != GSL_SUCCESS)
        return fp3_fail(error, FP3_E_SYSTEM, "GSL: %s", gsl_strerror(result));
    if (apart(y[0], closed_v) || apart(y[1], closed_s))
        return fp3_fail(
            error, FP3_E_MISMATCH,
            "two truths: GSL says v = %.17g, s = %.17g, the closed form v = %.17g, s = %.17g", y[0],
            y[1], closed_v, closed_s);
    *v = y[0];
    *s = y[1];
    return FP3_OK;
}
