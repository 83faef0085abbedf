/* SPDX-License-Identifier: Apache-2.0 */
/* header.c - an image as a C header, for sw/bare. */
#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "visit.h"
#include <fp3/isa.h>

#define LEAST_RECORD 3u /* docs/registers.md, record */

static void write_words(FILE *out, const char *name, const fp3_image *image,
                        const fp3_visit *visit) {
    fprintf(out, "static const uint32_t %s_words[] = {\n", name);
    for (uint32_t i = 0; i < visit->code_count; i++) {
        char text[FP3_WORD_TEXT_SIZE];
        if (fp3_word_text(visit->code[i], image, text, NULL))
            snprintf(text, sizeof text, "illegal");
        fprintf(out, "    0x%08xu, /* %u: %s */\n", visit->code[i], i, text);
    }
    fprintf(out, "};\n");
}

static void write_constants(FILE *out, const char *name, const fp3_image *image) {
    if (image->constant_count == 0)
        return;
    fprintf(out, "static const fp3_bare_constant %s_constants[] = {\n", name);
    for (uint32_t i = 0; i < image->constant_count; i++) {
        char text[FP3_NUMBER_TEXT_SIZE];
        fp3_number_text(image->constants[i].bits, text);
        fprintf(out, "    {%u, 0x%08xu}, /* %s */\n", image->constants[i].index,
                image->constants[i].bits, text);
    }
    fprintf(out, "};\n");
}

static void write_program(FILE *out, const char *name, const fp3_image *image,
                          const fp3_visit *visit) {
    fprintf(out,
            "static const fp3_bare_program %s_program = {\n"
            "    .words = %s_words,\n    .word_count = %u,\n    .loads = %u,\n    .stores = %u,\n"
            "    .step = %u,\n    .last = %u,\n",
            name, name, visit->code_count, visit->loads_in_front, visit->stores_behind, visit->step,
            visit->last);
    if (image->constant_count > 0)
        fprintf(out, "    .constants = %s_constants,\n    .constant_count = %u,\n", name,
                image->constant_count);
    fprintf(out,
            "    .registers = %u,\n    .shared = %u,\n    .record = %u,\n    .revision = %d,\n"
            "    .arithmetic = %u,\n};\n",
            image->registers, image->shared,
            visit->log2 < LEAST_RECORD ? LEAST_RECORD : visit->log2, FP3_ISA_REVISION,
            image->words);
}

/* What the host gives, and reads back. */
static void write_names(FILE *out, const char *name, const fp3_image *image) {
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        const fp3_symbol *s = &image->symbols[i];
        if (FP3_CLASS(s->symbol_class) & FP3_CLASSES_HOST)
            fprintf(out, "#define %s_%s_%s %uu\n", name, fp3_class_name(s->symbol_class), s->name,
                    s->index);
    }
    if (fp3_image_slept(image) >= 0)
        fprintf(out,
                "/* 0: the object is awake; the host writes it before it lists the object. */\n"
                "#define %s_asleep %du\n",
                name, fp3_image_slept(image));
}

static void write_all(FILE *out, const char *name, const fp3_image *image, const fp3_visit *visit) {
    fprintf(
        out,
        "/* The program %s for fp3_bare.h; written by fp3 dis --header. */\n"
        "#ifndef FP3_PROGRAM_%s\n#define FP3_PROGRAM_%s\n\n#include \"fp3_bare.h\"\n\n"
        "/* Registers of an object (state, param), and shared constants that the host gives. */\n",
        name, name, name);
    write_names(out, name, image);
    fprintf(out, "\n");
    write_words(out, name, image, visit);
    write_constants(out, name, image);
    write_program(out, name, image, visit);
    fprintf(out, "\n#endif\n");
}

fp3_status fp3_image_header(const fp3_image *image, const char *name, char **text,
                            fp3_error *error) {
    *text = NULL;
    if (!fp3_name_valid(name))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "found '%s' for a program's name, expected letters, digits or _, and none "
                        "of first, step, last, inf, nan",
                        name);
    if (image->words == FP3_WORDS_LOGARITHMS || image->words >= FP3_WORDS_FEWER) {
        char made[FP3_WORDS_NAME_SIZE];
        return fp3_fail(error, FP3_E_PROGRAM,
                        "the program is made for %s: sw/bare gives hardware binary32",
                        fp3_image_words_said(image->words, made));
    }
    fp3_visit *visit = NULL;
    fp3_status status = fp3_visit_make(image, &visit, error);
    if (status)
        return status;
    size_t size = 0;
    FILE *out = open_memstream(text, &size);
    if (out)
        write_all(out, name, image, visit);
    fp3_visit_free(&visit);
    if (!out || fclose(out)) {
        free(*text);
        *text = NULL;
        return fp3_no_memory(error);
    }
    return FP3_OK;
}
