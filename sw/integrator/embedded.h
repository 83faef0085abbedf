/* embedded.h - pairs of Runge-Kutta methods on the same stages. */
#ifndef FP3_EMBEDDED_H
#define FP3_EMBEDDED_H

#include <fp3/integrator.h>

/* Finds embedded_order and is_first_same_as_last of a table that has its weights. Returns 0 if the two
 * methods are one, which estimates nothing. */
int fp3_embedded_find(fp3_integrator *table);

#endif
