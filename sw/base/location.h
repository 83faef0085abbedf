/* SPDX-License-Identifier: Apache-2.0 */
/* location.h - a line and a column of a source. */
#ifndef FP3_LOCATION_H
#define FP3_LOCATION_H

typedef struct {
    unsigned line, column; /* from 1; line 0: nowhere */
} fp3_location;

static inline int fp3_location_before(fp3_location a, fp3_location b) {
    return a.line != b.line ? a.line < b.line : a.column < b.column;
}

#endif
