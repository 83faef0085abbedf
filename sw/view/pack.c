/* SPDX-License-Identifier: Apache-2.0 */
/* pack.c - see pack.h. */
#include "pack.h"
#include "base/bits.h"

#include <math.h>
#include <stdlib.h>
#include <zlib.h>

#define CODE_MOST 65534.0 /* of a finite value */
#define LEVEL 6

/* ---- codes ---- */

fp3_view_scale fp3_view_scale_of(const float *values, size_t count, int is_exact) {
    fp3_view_scale s = {.is_float = is_exact};
    int is_whole = 1, is_any = 0;
    for (size_t i = 0; i < count; i++) {
        const double value = (double)values[i];
        if (!isfinite(value)) {
            s.has_holes = 1;
            continue;
        }
        s.least = is_any && s.least < value ? s.least : value;
        s.most = is_any && s.most > value ? s.most : value;
        is_whole &= value == rint(value);
        is_any = 1;
    }
    s.low = s.least;
    s.step = is_whole && s.most - s.least <= CODE_MOST ? 1 : (s.most - s.least) / CODE_MOST;
    s.bound = is_exact || s.step == 1 ? 0 : s.step / 2;
    return s;
}

uint32_t fp3_view_code(const fp3_view_scale *s, float value) {
    if (s->is_float)
        return fp3_bits_of(value);
    if (!isfinite(value))
        return FP3_VIEW_HOLE;
    return s->step > 0 ? (uint32_t)rint(((double)value - s->low) / s->step) : 0;
}

/* ---- differences ---- */

/* What a code is expected to be: from the rows before it, in the first row from the one to the
 * left. */
static uint32_t expected(const uint32_t *codes, size_t row, size_t i, size_t count, int order) {
    const uint32_t *at = codes + row * count + i;
    if (row == 0)
        return i ? at[-1] : 0;
    return row == 1 || order == 1 ? at[-(ptrdiff_t)count]
                                  : 2 * at[-(ptrdiff_t)count] - at[-2 * (ptrdiff_t)count];
}

static uint32_t fold(uint32_t difference, int is_wide) {
    const int32_t d = is_wide ? (int32_t)difference : (int16_t)(uint16_t)difference;
    const uint32_t folded = ((uint32_t)d << 1) ^ (uint32_t) - (d < 0);
    return is_wide ? folded : folded & 0xffff;
}

/* The order of which the differences are smaller, in bits. */
static int better_order(const uint32_t *codes, size_t rows, size_t count, int is_wide) {
    double bits[3] = {0};
    for (int order = 1; order <= 2; order++)
        for (size_t row = 2; row < rows; row++)
            for (size_t i = 0; i < count; i += 7) {
                const uint32_t d = codes[row * count + i] - expected(codes, row, i, count, order);
                bits[order] += log2(1 + (double)fold(d, is_wide));
            }
    return bits[2] < bits[1] ? 2 : 1;
}

/* From the end, so that what is expected is still there. */
static void make_differences(uint32_t *codes, size_t rows, size_t count, int order, int is_wide) {
    for (size_t row = rows; row-- > 0;)
        for (size_t i = count; i-- > 0;)
            codes[row * count + i] =
                fold(codes[row * count + i] - expected(codes, row, i, count, order), is_wide);
}

/* ---- text ---- */

static void write_base64(const unsigned char *bytes, size_t size, FILE *out) {
    static const char signs[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        const size_t left = size - i;
        const uint32_t group = (uint32_t)bytes[i] << 16 |
                               (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) |
                               (left > 2 ? (uint32_t)bytes[i + 2] : 0);
        const char text[4] = {signs[group >> 18], signs[group >> 12 & 63],
                              left > 1 ? signs[group >> 6 & 63] : '=',
                              left > 2 ? signs[group & 63] : '='};
        fwrite(text, sizeof text, 1, out);
    }
}

static void fill_planes(const uint32_t *codes, size_t count, int is_wide, unsigned char *planes) {
    const unsigned bytes = is_wide ? 4 : 2;
    for (unsigned byte = 0; byte < bytes; byte++)
        for (size_t i = 0; i < count; i++)
            *planes++ = (unsigned char)(codes[i] >> (8 * byte));
}

fp3_status fp3_view_pack(uint32_t *codes, size_t rows, size_t count, int is_wide, FILE *out,
                         fp3_error *error) {
    const size_t size = 1 + rows * count * (is_wide ? 4 : 2);
    uLongf packed = compressBound(size);
    unsigned char *planes = malloc(size), *made = malloc(packed);
    const int order = better_order(codes, rows, count, is_wide);
    if (planes && made) {
        make_differences(codes, rows, count, order, is_wide);
        planes[0] = (unsigned char)order;
        fill_planes(codes, rows * count, is_wide, planes + 1);
    }
    const int is_good = planes && made && compress2(made, &packed, planes, size, LEVEL) == Z_OK;
    if (is_good)
        write_base64(made, packed, out);
    free(planes);
    free(made);
    return is_good ? FP3_OK : fp3_no_memory(error);
}
