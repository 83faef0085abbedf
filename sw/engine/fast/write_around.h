/* SPDX-License-Identifier: Apache-2.0 */
/* write_around.h - the function of a program with neighbours, as C: a fp3_fast_around_fn. */
#ifndef FP3_FAST_WRITE_AROUND_H
#define FP3_FAST_WRITE_AROUND_H

#include "write_words.h"

void fp3_write_phases(const fp3_writer *w);

#endif
