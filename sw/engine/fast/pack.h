/* SPDX-License-Identifier: Apache-2.0 */
/* pack.h - lists of neighbours as native code goes through them: see fp3_fast_list. */
#ifndef FP3_FAST_PACK_H
#define FP3_FAST_PACK_H

#include "place.h"

#include <fp3/status.h>
#include <stdint.h>

/* One list of each object of a group, as the host gives it. */
typedef struct {
    const uint32_t *begin; /* objects + 1; NULL: all others */
    const uint32_t *other;
    uint32_t *field;
    uint32_t fields, objects, rows; /* rows: of all that may be a neighbour */
    uint32_t first, end;            /* without begin: neighbours are these rows, but for oneself */
    int is_written;                 /* a program writes fields */
    int is_fixed; /* it lasts: worth a search for neighbours that stand side by side */
} fp3_fast_given;

typedef struct {
    fp3_fast_given given; /* what it was made of, which must outlive it */
    fp3_fast_list list;
    int is_gathered; /* it has neighbours that do not stand side by side */
    unsigned long *start;
    int *tape;
} fp3_fast_packed;

/* For vectors of so many lanes, at most 16; 0: no native code will go through it. FP3_E_SYSTEM: out
 * of memory. The caller frees, after a failure too. */
fp3_status fp3_fast_pack(const fp3_fast_given *given, unsigned lanes, fp3_fast_packed *packed,
                         fp3_error *error);
void fp3_fast_pack_free(fp3_fast_packed *packed);

#endif
