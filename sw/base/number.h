/* SPDX-License-Identifier: Apache-2.0 */
/* number.h - numbers as text, in the locale "C" (base/host.h). fp3/image.h has fp3_number_text. */
#ifndef FP3_NUMBER_H
#define FP3_NUMBER_H

#include "token.h"

/* The token with a NUL behind it. NULL, or what is expected instead of the token. */
enum { FP3_NUMBER_SIZE = 256 };
const char *fp3_number_copy(fp3_token token, char text[FP3_NUMBER_SIZE]);

/* What follows gives NULL, or what is expected instead; reading needs the locale "C". */

/* A decimal without a sign: 2, 0.5, 1.5e-3. */
const char *fp3_number_decimal(const char *text, double *value);
/* The same with a sign, a C hexadecimal float, inf or nan: the numbers of assembly. */
const char *fp3_number_read(const char *text, double *value);
/* Whether a number may become this FP32 number, to which it is rounded: a finite one not an
 * infinity, one other than 0 not 0. */
const char *fp3_number_fits(float rounded, int is_zero, int is_infinite);
/* Rounds once, to nearest. */
const char *fp3_number_single(double value, float *single);
/* Likewise, what the host gives a run: a number that is too small for FP32 becomes 0, as a result
 * of the machine does. */
const char *fp3_number_written(double value, float *single);
/* What equations have of a param or of h, from which all else is computed: the FP32 number nearest
 * to it, or the sum of two words nearest to it. The value itself where FP32 has no normal number
 * for it. */
double fp3_number_given(double value, unsigned words);
/* As fp3_number_single, for the step of an integrator, which is above 0. */
const char *fp3_number_step(double value, float *single);

#endif
