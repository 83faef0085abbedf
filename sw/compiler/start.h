/* SPDX-License-Identifier: Apache-2.0 */
/* start.h - some inputs of a compiled program, for block after block of objects.
 *
 *     fp3_start *start = NULL;
 *     if (fp3_start_open(compiled, is_wanted, 512, &start, error) ||
 *         fp3_start_values(start, params, initial, h, 512, values, error)) ...
 *     fp3_start_close(&start);
 */
#ifndef FP3_START_H
#define FP3_START_H

#include <fp3/compile.h>

typedef struct fp3_start fp3_start;

/* is_wanted: of each input; NULL: all. most: objects at once. compiled must outlive *start. The
 * caller closes *start, which is NULL on failure. */
fp3_status fp3_start_open(const fp3_compiled *compiled, const char *is_wanted, size_t most,
                          fp3_start **start, fp3_error *error);
/* Sets *start to NULL, which it may be already. */
void fp3_start_close(fp3_start **start);

/* As fp3_compiled_inputs of each of count objects, in columns: params[i * count + n] is param i of
 * object n. The values of other inputs stay as they are. The error does not name the object. */
fp3_status fp3_start_values(fp3_start *start, const double *params, const double *initial, double h,
                            size_t count, float *values, fp3_error *error);

/* Whether a param or start, given its default, is small because it decays to 0, and not because the
 * units do not suit FP32. A constant of nature may be small, but is not far below its default. */
int fp3_start_vanishes(double value, double usual);

/* The model whose params and states a program's inputs are made of. */
const fp3_model *fp3_start_model(const fp3_compiled *compiled);
/* The param of the model that the input is a copy of; FP3_NONE: it is another value. */
uint32_t fp3_start_param(const fp3_compiled *compiled, uint32_t input);
/* The param of which it is the second word, in double-single; likewise. */
uint32_t fp3_start_low_param(const fp3_compiled *compiled, uint32_t input);

#endif
