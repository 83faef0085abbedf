/* SPDX-License-Identifier: Apache-2.0 */
/* others.h - the equations of objects in double, with the neighbours that they have in an engine
 * after a run.
 *
 *     fp3_others *o = NULL;
 *     if (!fp3_others_open(program, params, objects, looked, columns, &o, error))
 *         fp3_others_evaluate(o, 3, &point, NULL, NULL, values);
 *     fp3_others_close(&o);
 *
 * It shares no code with the compiler. A model without relations is the case without neighbours.
 * Pairs remember nothing, and relations see objects of the own group.
 */
#ifndef FP3_CHECK_OTHERS_H
#define FP3_CHECK_OTHERS_H

#include <fp3/program.h>

typedef struct fp3_others fp3_others;

/* Finds the neighbours of the first `looked` of the objects of a part, whose states are columns of
 * `objects` numbers. The columns must outlive it, and may change: neighbours then have other
 * states, but stay the same objects. The caller closes *others, which is NULL on failure. */
fp3_status fp3_others_open(const fp3_program *program, const fp3_params *params, size_t objects,
                           size_t looked, const double *columns, fp3_others **others,
                           fp3_error *error);
/* Sets *others to NULL, which it may be already. */
void fp3_others_close(fp3_others **others);

/* Sees each expression with its value, and returns the value to use instead: it is stored, and the
 * expressions after it are computed from it. */
typedef double fp3_others_fn(const void *user, uint32_t expr, double value);

/* The values of all expressions of a looked object, whose own states are the point's. had: NULL, or
 * called for each value before it is stored. */
void fp3_others_evaluate(const fp3_others *others, size_t object, const fp3_point *point,
                         fp3_others_fn *had, const void *user, double *values);

#endif
