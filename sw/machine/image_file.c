/* SPDX-License-Identifier: Apache-2.0 */
/* Images as words and as files; fp3/image.h says how they are laid out. */
#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/file.h"
#include <fp3/isa.h>

enum { MAGIC, REVISION, TOTAL, CODE, STEP, LAST, CONSTANTS, SYMBOLS, USED };

static void to_bytes(const uint32_t *words, size_t count, unsigned char *bytes) {
    for (size_t i = 0; i < 4 * count; i++)
        bytes[i] = (unsigned char)(words[i / 4] >> i % 4 * 8);
}

static void to_words(const unsigned char *bytes, size_t count, uint32_t *words) {
    for (size_t i = 0; i < count; i++)
        words[i] = bytes[4 * i] | (uint32_t)bytes[4 * i + 1] << 8 |
                   (uint32_t)bytes[4 * i + 2] << 16 | (uint32_t)bytes[4 * i + 3] << 24;
}

static fp3_status checksum(const uint32_t *words, size_t count, uint32_t *sum, fp3_error *error) {
    unsigned char *bytes = malloc(4 * count);
    if (!bytes)
        return fp3_no_memory(error);
    to_bytes(words, count, bytes);
    *sum = (uint32_t)crc32(crc32(0, NULL, 0), bytes, (uInt)(4 * count));
    free(bytes);
    return FP3_OK;
}

static fp3_status check_frame(const uint32_t *words, size_t count, fp3_error *error) {
    if (count == 0 || words[MAGIC] != FP3_IMAGE_MAGIC)
        return fp3_fail(error, FP3_E_PROGRAM, "not an FP3 image");
    if (count < FP3_IMAGE_HEADER_WORDS)
        return fp3_fail(error, FP3_E_PROGRAM, "truncated: %zu of %d header words", count,
                        FP3_IMAGE_HEADER_WORDS);
    if (words[REVISION] != FP3_ISA_REVISION)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "made for revision %u of the instruction set; this is revision %d",
                        words[REVISION], FP3_ISA_REVISION);
    if (count < words[TOTAL])
        return fp3_fail(error, FP3_E_PROGRAM, "truncated: %zu of %u words", count, words[TOTAL]);
    if (count > words[TOTAL])
        return fp3_fail(error, FP3_E_PROGRAM, "%zu words after the end of the image",
                        count - words[TOTAL]);
    uint64_t sum = FP3_IMAGE_HEADER_WORDS + (uint64_t)words[CODE] +
                   FP3_IMAGE_CONSTANT_WORDS * (uint64_t)words[CONSTANTS] +
                   FP3_IMAGE_SYMBOL_WORDS * (uint64_t)words[SYMBOLS] + 1;
    if (sum != count)
        return fp3_fail(error, FP3_E_PROGRAM, "damaged: its parts have %llu words, the image %zu",
                        (unsigned long long)sum, count);
    uint32_t crc;
    fp3_status status = checksum(words, count - 1, &crc, error);
    if (!status && crc != words[count - 1])
        status = fp3_fail(error, FP3_E_PROGRAM, "damaged: CRC 0x%08x, expected 0x%08x", crc,
                          words[count - 1]);
    return status;
}

fp3_status fp3_image_decode(const uint32_t *words, size_t count, fp3_image **image,
                            fp3_error *error) {
    *image = NULL;
    fp3_status status = check_frame(words, count, error);
    if (status)
        return status;
    const uint32_t *const first_constant = words + FP3_IMAGE_HEADER_WORDS + words[CODE];
    const uint32_t *const first_symbol =
        first_constant + FP3_IMAGE_CONSTANT_WORDS * words[CONSTANTS];
    fp3_constant *constants = calloc(words[CONSTANTS] + 1, sizeof *constants);
    fp3_symbol *symbols = calloc(words[SYMBOLS] + 1, sizeof *symbols);
    if (!constants || !symbols) {
        status = fp3_no_memory(error);
        goto end;
    }
    for (uint32_t i = 0; i < words[CONSTANTS]; i++) {
        const uint32_t *from = first_constant + FP3_IMAGE_CONSTANT_WORDS * i;
        constants[i] = (fp3_constant){.index = from[0], .bits = from[1]};
    }
    for (uint32_t i = 0; i < words[SYMBOLS]; i++) {
        const uint32_t *from = first_symbol + FP3_IMAGE_SYMBOL_WORDS * i;
        symbols[i].symbol_class = (fp3_symbol_class)(from[0] >> 24);
        symbols[i].index = from[0] & 0xffffff;
        to_bytes(from + 1, FP3_NAME_SIZE / 4, (unsigned char *)symbols[i].name);
    }
    const fp3_image draft = {.code_count = words[CODE],
                             .step = words[STEP],
                             .last = words[LAST],
                             .constant_count = words[CONSTANTS],
                             .symbol_count = words[SYMBOLS],
                             .words = words[USED] >> 24,
                             .code = words + FP3_IMAGE_HEADER_WORDS,
                             .constants = constants,
                             .symbols = symbols};
    status = fp3_image_make(&draft, image, error);
    if (status)
        goto end;
    /* An image has one form: another order, count or byte after a name is damage. */
    uint32_t *again = NULL;
    size_t again_count = 0;
    status = fp3_image_encode(*image, &again, &again_count, error);
    for (size_t i = 0; !status && i < count; i++)
        if (again[i] != words[i])
            status = fp3_fail(error, FP3_E_PROGRAM, "damaged: word %zu is 0x%08x, expected 0x%08x",
                              i, words[i], again[i]);
    free(again);
    if (status)
        fp3_image_free(image);
end:
    free(constants);
    free(symbols);
    return status;
}

fp3_status fp3_image_encode(const fp3_image *image, uint32_t **words, size_t *count,
                            fp3_error *error) {
    *words = NULL;
    *count = 0;
    size_t total = FP3_IMAGE_HEADER_WORDS + (size_t)image->code_count +
                   FP3_IMAGE_CONSTANT_WORDS * (size_t)image->constant_count +
                   FP3_IMAGE_SYMBOL_WORDS * (size_t)image->symbol_count + 1;
    uint32_t *made = malloc(total * sizeof *made);
    if (!made)
        return fp3_no_memory(error);
    made[MAGIC] = FP3_IMAGE_MAGIC;
    made[REVISION] = FP3_ISA_REVISION;
    made[TOTAL] = (uint32_t)total;
    made[CODE] = image->code_count;
    made[STEP] = image->step;
    made[LAST] = image->last;
    made[CONSTANTS] = image->constant_count;
    made[SYMBOLS] = image->symbol_count;
    made[USED] = image->registers | image->shared << 16 | image->words << 24;
    uint32_t *to = made + FP3_IMAGE_HEADER_WORDS;
    memcpy(to, image->code, image->code_count * sizeof *to);
    to += image->code_count;
    for (uint32_t i = 0; i < image->constant_count; i++) {
        *to++ = image->constants[i].index;
        *to++ = image->constants[i].bits;
    }
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        unsigned char name[FP3_NAME_SIZE] = {0};
        memcpy(name, image->symbols[i].name, strlen(image->symbols[i].name));
        *to++ = (uint32_t)image->symbols[i].symbol_class << 24 | image->symbols[i].index;
        to_words(name, FP3_NAME_SIZE / 4, to);
        to += FP3_NAME_SIZE / 4;
    }
    fp3_status status = checksum(made, total - 1, to, error);
    if (status) {
        free(made);
        return status;
    }
    *words = made;
    *count = total;
    return FP3_OK;
}

static fp3_status prefix(fp3_error *error, const char *path, fp3_status status) {
    return error ? fp3_fail(error, status, "%s: %s", path, error->text) : status;
}

fp3_status fp3_image_load(const char *path, fp3_image **image, fp3_error *error) {
    *image = NULL;
    char *bytes = NULL;
    size_t size = 0;
    fp3_status status = fp3_file_read(path, &bytes, &size, error);
    if (status)
        return status;
    size_t count = size / 4;
    uint32_t *words = malloc(size + 4);
    if (!words) {
        status = fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    } else {
        to_words((const unsigned char *)bytes, count, words);
        if (count > 0 && words[MAGIC] == FP3_IMAGE_MAGIC && size % 4)
            status =
                fp3_fail(error, FP3_E_PROGRAM, "truncated: %zu bytes are not whole words", size);
        else
            status = fp3_image_decode(words, count, image, error);
        if (status)
            prefix(error, path, status);
    }
    free(words);
    free(bytes);
    return status;
}

fp3_status fp3_image_save(const fp3_image *image, const char *path, fp3_error *error) {
    uint32_t *words = NULL;
    size_t count = 0;
    fp3_status status = fp3_image_encode(image, &words, &count, error);
    if (status)
        return prefix(error, path, status);
    unsigned char *bytes = malloc(4 * count);
    if (bytes) {
        to_bytes(words, count, bytes);
        status = fp3_file_write(path, bytes, 4 * count, error);
    } else {
        status = fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    }
    free(bytes);
    free(words);
    return status;
}
