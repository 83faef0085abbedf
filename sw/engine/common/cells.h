/* SPDX-License-Identifier: Apache-2.0 */
/* cells.h - registers and constants, written without a check of their place. */
#ifndef FP3_CELLS_H
#define FP3_CELLS_H

#include "backend.h"

/* A register of those objects of a group that are among first .. first+count-1; its count may be 0.
 */
fp3_cells fp3_cells_of(const fp3_members *group, uint32_t reg, size_t first, size_t count);

/* Sleep registers may be among them: the host's copy of them, and what the next run begins with,
 * follow. */
fp3_status fp3_cells_write(fp3_engine *engine, fp3_cells cells, const void *words);
/* Numbers, converted to words (machine/format.h). FP3_E_ARGUMENT: one has no word; nothing is
 * written. */
fp3_status fp3_cells_write_numbers(fp3_engine *engine, fp3_cells cells, const float *values);
/* The same word in all. */
fp3_status fp3_cells_fill(fp3_engine *engine, fp3_cells cells, uint32_t bits);

#endif
