/* SPDX-License-Identifier: Apache-2.0 */
/* orbit.h - one way of an object from time 0 to an end, by a method of GSL's, with its events and
 * the turns of its equations. */
#ifndef FP3_TRUTH_ORBIT_H
#define FP3_TRUTH_ORBIT_H

#include <gsl/gsl_odeiv2.h>

#include "path.h"
#include "slopes.h"

/* Beside GSL's own codes and those of crossing.h: the model is stiff. */
enum { FP3_ORBIT_STIFF = 2000 };

/* The estimated error of a step may be tolerance (|y| + slope h |y'| + floor S), S being the size
 * of a state. */
typedef struct {
    const gsl_odeiv2_step_type *step;
    const gsl_odeiv2_step_type *within; /* for parts of a step: needs no step before it */
    double tolerance, slope, floor;
    unsigned most; /* steps */
    double
        stable; /* |h lambda| up to which all that should decay does; 0: there is no such bound */
} fp3_method;

typedef struct {
    fp3_slopes *slopes;
    const double *times; /* below 0 if it is only one */
    size_t count;        /* of them; the last is the end */
    double *peak;        /* largest size of each state so far */
    double *y;           /* the states on the way */
    double reached;      /* time */
    double stopped;      /* the time at which an event stopped the object, or INFINITY */
    unsigned steps;      /* to there */
    unsigned
        limited; /* looks at steps that were as long as the stability of the method lets them be */
    fp3_path *path; /* NULL: only the states at the times are of interest */
} fp3_orbit;

/* The states at each time become a row of rows. sizes: of each state. path: NULL, or where to keep
 * how it goes. Returns GSL's codes, those of crossing.h, or FP3_ORBIT_STIFF: steps have long been
 * limited by stability. */
int fp3_orbit_go(fp3_orbit *o, const fp3_method *how, double tolerance, const double *sizes,
                 double *rows, fp3_path **path);

#endif
