/* SPDX-License-Identifier: Apache-2.0 */
/* pack.h - numbers as text in a page: 16 bits of each, or all 32, as differences that deflate makes
 * small, in base64.
 *
 * The page undoes it (page/data.js). A stream is deflated; its first byte is the order of the
 * differences, then come all lowest bytes, all next ones, and so on. A difference d is stored as 2
 * d, or -2 d - 1 if it is negative.
 */
#ifndef FP3_VIEW_PACK_H
#define FP3_VIEW_PACK_H

#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* How a column becomes codes. */
typedef struct {
    int is_float;       /* codes are the bits of FP32 */
    double low, step;   /* else a value is low + code * step, */
    double bound;       /* wrong by this at most */
    int has_holes;      /* some values are no finite numbers: FP3_VIEW_HOLE */
    double least, most; /* of the finite ones; both 0 if there are none */
} fp3_view_scale;

#define FP3_VIEW_HOLE 65535u

/* is_exact: keep all bits. Whole numbers that have room are exact in 16 bits, too. */
fp3_view_scale fp3_view_scale_of(const float *values, size_t count, int is_exact);
uint32_t fp3_view_code(const fp3_view_scale *scale, float value);

/* Writes rows x count codes of 16 bits, or of 32 if is_wide, which it changes. FP3_E_SYSTEM: out of
 * memory; the stream says for itself whether it could be written. */
fp3_status fp3_view_pack(uint32_t *codes, size_t rows, size_t count, int is_wide, FILE *out,
                         fp3_error *error);

#endif
