/* SPDX-License-Identifier: Apache-2.0 */
/* visit.h - a program as one visit of an object executes it: loads, the program, stores.
 *
 * Between visits an object is a record in the object store, word r for register r; while it is
 * visited, its registers are a context's, and hold at first what another object left there. So a
 * visit begins with the loads of all that the program may read before it writes it, and ends with
 * the stores of all that it writes and something reads later: the next visit or the host.
 *
 *     fp3_visit *visit = NULL;
 *     if (fp3_visit_make(image, &visit, &error))
 *         return fp3_fail(...);
 *     ... visit->code[0 .. visit->code_count) is what instruction memory holds ...
 *     fp3_visit_free(&visit);
 */
#ifndef FP3_VISIT_H
#define FP3_VISIT_H

#include "operation.h"

#include <fp3/image.h>

typedef struct {
    uint32_t *code;
    fp3_decoded *decoded;                   /* each word of code */
    uint32_t code_count, step, last;        /* as in an image, loads and stores included */
    uint32_t loads_in_front, stores_behind; /* words that the image does not have */
    uint64_t loaded, stored; /* by these words or the image's own: bit r for register r */
    /* The registers that have a value between visits, in record words below 1 << log2. What else
     * the host writes into an object, no visit sees. */
    uint64_t kept;
    uint32_t log2;
    int slept; /* the register that sleep writes, or -1 */
} fp3_visit;

/* The image must have passed fp3_image_make. One that has an ld, lds or st of its own is taken as
 * it is. The caller frees *visit. FP3_E_PROGRAM: with loads and stores it has more than
 * FP3_IMAGE_CODE_LIMIT words (what a configuration holds is the caller's to check). */
fp3_status fp3_visit_make(const fp3_image *image, fp3_visit **visit, fp3_error *error);
/* Sets *visit to NULL; that it was NULL before does no harm. */
void fp3_visit_free(fp3_visit **visit);

#endif
