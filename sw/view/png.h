/* SPDX-License-Identifier: Apache-2.0 */
/* png.h - pictures as PNG, and several of them as an animated one (APNG, which everything that
 * shows a PNG shows the first picture of). Pixels are 3 bytes: red, green, blue.
 */
#ifndef FP3_VIEW_PNG_H
#define FP3_VIEW_PNG_H

#include <fp3/status.h>
#include <stdint.h>
#include <stdio.h>

typedef struct {
    uint32_t width, height;
    uint32_t pictures; /* 1: no film */
    uint16_t rate;     /* pictures a second, of a film */
    uint32_t number;   /* of the next chunk of the animation */
    uint32_t drawn;    /* pictures that are written */
} fp3_view_png;

/* The stream says for itself whether it could be written. */
void fp3_view_png_begin(fp3_view_png *png, FILE *out);
/* As many pictures as there are, each of width * height pixels. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_view_png_add(fp3_view_png *png, const uint8_t *pixels, FILE *out, fp3_error *error);
void fp3_view_png_end(FILE *out);

#endif
