/* SPDX-License-Identifier: Apache-2.0 */
/* format.h - numbers as words of the machine. The host speaks binary32; what a register or a
 * constant holds, the configuration says.
 *
 *     uint32_t word;
 *     const char *wrong = fp3_format_word(config, 1e-39f, &word);
 *     float back = fp3_format_value(config, word);
 *
 * Another format is a row of the table in format.c. Words that are no numbers, as those of sleep
 * registers, are not converted.
 */
#ifndef FP3_FORMAT_H
#define FP3_FORMAT_H

#include "config.h"

#include <stdint.h>

/* Whether words are binary32: both functions then give the bits that they get. */
int fp3_format_is_float(const fp3_config *config);

/* NULL: *word is the number, rounded to a word. Else what is wrong with it ("is nearer to 0 than
 * ..."), and *word is unchanged. Infinities and NaN have words. */
const char *fp3_format_word(const fp3_config *config, float value, uint32_t *word);
/* The same for what the host writes in a run: a number that is too small for a word becomes 0. */
const char *fp3_format_written(const fp3_config *config, float value, uint32_t *word);
/* Likewise rounded. */
float fp3_format_value(const fp3_config *config, uint32_t word);
/* The number itself, to the precision of a double: logarithms are no floats. */
double fp3_format_number(const fp3_config *config, uint32_t word);

/* How far a program counts by adding 1, in words and from record to record: to here, from 0 on, a
 * count is off by less than FP3_FORMAT_OFF. */
int64_t fp3_format_counts(const fp3_config *config);
#define FP3_FORMAT_OFF 0.0625

#endif
