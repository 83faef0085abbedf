/* SPDX-License-Identifier: Apache-2.0 */
/* png.c - see png.h. libpng as it is released writes no animations, and a PNG without them is four
 * chunks around what zlib makes.
 */
#include "png.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define LEVEL 6

static void put_32(uint8_t *to, uint32_t value) {
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(value >> (24 - 8 * i));
}

static void put_16(uint8_t *to, uint16_t value) {
    to[0] = (uint8_t)(value >> 8);
    to[1] = (uint8_t)value;
}

/* Length, name, contents in two parts, CRC-32 of all but the length. */
static void write_chunk(FILE *out, const char *name, const uint8_t *first, uint32_t first_size,
                        const uint8_t *rest, uint32_t rest_size) {
    uint8_t word[4];
    uLong crc = crc32(0, (const Bytef *)name, 4);
    crc = first_size ? crc32(crc, first, first_size) : crc;
    crc = rest_size ? crc32(crc, rest, rest_size) : crc;
    put_32(word, first_size + rest_size);
    fwrite(word, sizeof word, 1, out);
    fwrite(name, 4, 1, out);
    fwrite(first, 1, first_size, out);
    fwrite(rest, 1, rest_size, out);
    put_32(word, (uint32_t)crc);
    fwrite(word, sizeof word, 1, out);
}

void fp3_view_png_begin(fp3_view_png *png, FILE *out) {
    static const uint8_t mark[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    uint8_t head[13] = {[8] = 8, [9] = 2}; /* bits of a sample; red, green and blue */
    uint8_t control[8] = {0};              /* pictures; 0: for ever */
    put_32(head, png->width);
    put_32(head + 4, png->height);
    fwrite(mark, sizeof mark, 1, out);
    write_chunk(out, "IHDR", head, sizeof head, head, 0);
    put_32(control, png->pictures);
    if (png->pictures > 1)
        write_chunk(out, "acTL", control, sizeof control, control, 0);
}

static void write_frame_control(fp3_view_png *png, FILE *out) {
    uint8_t control[26] = {0};
    put_32(control, png->number++);
    put_32(control + 4, png->width);
    put_32(control + 8, png->height);
    put_16(control + 20, 1);
    put_16(control + 22, png->rate);
    write_chunk(out, "fcTL", control, sizeof control, control, 0);
}

/* Each row begins with its filter: 1, the difference from the pixel to the left, 3 bytes before. */
static void filter(const uint8_t *pixels, size_t width, size_t height, uint8_t *rows) {
    for (size_t y = 0; y < height; y++) {
        const uint8_t *from = pixels + y * width * 3;
        *rows++ = 1;
        for (size_t i = 0; i < width * 3; i++)
            *rows++ = (uint8_t)(from[i] - (i < 3 ? 0 : from[i - 3]));
    }
}

fp3_status fp3_view_png_add(fp3_view_png *png, const uint8_t *pixels, FILE *out, fp3_error *error) {
    const size_t size = (size_t)png->height * (3 * (size_t)png->width + 1);
    uLongf packed = compressBound(size);
    uint8_t *rows = malloc(size), *made = malloc(packed), number[4];
    if (rows)
        filter(pixels, png->width, png->height, rows);
    const int is_good = rows && made && compress2(made, &packed, rows, size, LEVEL) == Z_OK;
    if (is_good && png->pictures > 1)
        write_frame_control(png, out);
    if (is_good && !png->drawn)
        write_chunk(out, "IDAT", made, (uint32_t)packed, made, 0);
    else if (is_good) {
        put_32(number, png->number++);
        write_chunk(out, "fdAT", number, sizeof number, made, (uint32_t)packed);
    }
    png->drawn++;
    free(rows);
    free(made);
    return is_good ? FP3_OK : fp3_no_memory(error);
}

void fp3_view_png_end(FILE *out) {
    write_chunk(out, "IEND", (const uint8_t *)"", 0, (const uint8_t *)"", 0);
}
