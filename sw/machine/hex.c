/* SPDX-License-Identifier: Apache-2.0 */
/* hex.c - an image as text that $readmemh reads, with the meaning of each word. */
#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"

/* What word i of the file means, for the reader of the text form. */
static void comment(FILE *out, const fp3_image *image, size_t i, uint32_t word) {
    static const char *const header[] = {"magic",      "revision", "words",
                                         "code words", "step",     "last",
                                         "constants",  "symbols",  "shared << 16 | registers"};
    size_t code = FP3_IMAGE_HEADER_WORDS, constant = code + image->code_count;
    size_t symbol = constant + FP3_IMAGE_CONSTANT_WORDS * image->constant_count;
    size_t end = symbol + FP3_IMAGE_SYMBOL_WORDS * image->symbol_count;
    char text[FP3_WORD_TEXT_SIZE] = "";
    if (i < code) {
        fprintf(out, "  // %s\n", header[i]);
    } else if (i < constant) {
        if (fp3_word_text(word, image, text, NULL))
            snprintf(text, sizeof text, "illegal");
        fprintf(out, "  // %zu: %s\n", i - code, text);
    } else if (i < symbol && (i - constant) % FP3_IMAGE_CONSTANT_WORDS == 0) {
        fprintf(out, "  // shared constant\n");
    } else if (i < symbol) {
        fp3_number_text(word, text);
        fprintf(out, "  // %s\n", text);
    } else if (i < end && (i - symbol) % FP3_IMAGE_SYMBOL_WORDS == 0) {
        const fp3_symbol *s = &image->symbols[(i - symbol) / FP3_IMAGE_SYMBOL_WORDS];
        fprintf(out, "  // %s %s\n", fp3_class_name(s->symbol_class), s->name);
    } else {
        fprintf(out, i < end ? "\n" : "  // CRC-32\n");
    }
}

fp3_status fp3_image_save_hex(const fp3_image *image, const char *path, fp3_error *error) {
    uint32_t *words = NULL;
    size_t count = 0;
    fp3_status status = fp3_image_encode(image, &words, &count, error);
    if (status)
        return status;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    for (size_t i = 0; out && i < count; i++) {
        fprintf(out, "%08x", words[i]);
        comment(out, image, i, words[i]);
    }
    free(words);
    if (!out || fclose(out))
        status = fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    else
        status = fp3_file_write(path, text, size, error);
    free(text);
    return status;
}
