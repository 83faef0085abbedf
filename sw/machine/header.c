/* SPDX-License-Identifier: Apache-2.0 */
/* header.c - an image as a C header, for sw/bare. */
#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "neighbours.h"
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

/* Of objects that see each other: their lists, and the phases of a step. */
static void write_lists(FILE *out, const char *name, const fp3_image *image, const fp3_visit *visit,
                        const fp3_neighbourhood *around) {
    const fp3_code code = {.code = visit->code,
                           .decoded = visit->decoded,
                           .count = visit->code_count,
                           .step = visit->step,
                           .last = visit->last};
    uint32_t first, end;
    if (!around->list_count)
        return;
    fprintf(out, "static const fp3_bare_shape %s_lists[] = {\n", name);
    for (uint32_t i = 0; i < around->list_count; i++) {
        const char *list = fp3_image_name(image, around->lists[i].reg);
        fprintf(out, "    {%u, %u}, /* %s */\n", around->lists[i].reg, around->lists[i].fields,
                list ? list : "?");
    }
    fprintf(out, "};\nstatic const fp3_bare_phase %s_phases[] = {\n", name);
    for (uint32_t i = 0; fp3_neighbourhood_phase(&code, i, &first, &end); i++)
        fprintf(out, "    {%u, %u},\n", first, end);
    fprintf(out, "};\n");
}

static void write_around(FILE *out, const char *name, uint64_t published) {
    fprintf(out,
            "    .lists = %s_lists,\n    .phases = %s_phases,\n"
            "    .list_count = sizeof %s_lists / sizeof %s_lists[0],\n"
            "    .phase_count = sizeof %s_phases / sizeof %s_phases[0],\n"
            "    .published = {0x%xu, 0x%xu},\n",
            name, name, name, name, name, name, (uint32_t)published, (uint32_t)(published >> 32));
}

static void write_program(FILE *out, const char *name, const fp3_image *image,
                          const fp3_visit *visit, const fp3_neighbourhood *around) {
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
            "    .arithmetic = %u,\n",
            image->registers, image->shared,
            visit->log2 < LEAST_RECORD ? LEAST_RECORD : visit->log2, FP3_ISA_REVISION,
            image->words);
    if (around->list_count)
        write_around(out, name, around->published & visit->stored);
    fprintf(out, "};\n");
}

/* What the host gives, and reads back. */
static void write_names(FILE *out, const char *name, const fp3_image *image,
                        const fp3_neighbourhood *around) {
    for (uint32_t i = 0; i < around->list_count; i++) {
        const char *list = fp3_image_name(image, around->lists[i].reg);
        if (list)
            fprintf(out, "#define %s_list_%s %uu\n", name, list, around->lists[i].reg);
    }
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

static void write_all(FILE *out, const char *name, const fp3_image *image, const fp3_visit *visit,
                      const fp3_neighbourhood *around) {
    fprintf(out,
            "/* The program %s for fp3_bare.h; written by fp3 dis --header. */\n"
            "#ifndef FP3_PROGRAM_%s\n#define FP3_PROGRAM_%s\n\n#include \"fp3_bare.h\"\n\n"
            "/* Registers of an object (list, state, param), and shared constants that the host "
            "gives. */\n",
            name, name, name);
    write_names(out, name, image, around);
    fprintf(out, "\n");
    write_words(out, name, image, visit);
    write_constants(out, name, image);
    write_lists(out, name, image, visit, around);
    write_program(out, name, image, visit, around);
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
    fp3_neighbourhood around;
    fp3_status status = fp3_neighbourhood_find(image, &around, error);
    if (!status && around.worst)
        status = fp3_fail(error, FP3_E_PROGRAM,
                          "the program compares a word of all objects between phases: sw/bare "
                          "does not");
    if (!status && fp3_image_rest(image) >= 0)
        status = fp3_fail(error, FP3_E_PROGRAM,
                          "the program's objects may rest: the host decides after each step who "
                          "sleeps and who wakes, and sw/bare does not");
    if (!status && around.list_count && fp3_image_removed(image) >= 0)
        status = fp3_fail(error, FP3_E_PROGRAM,
                          "the program removes objects that others see: lists change with it, and "
                          "sw/bare does not look");
    if (!status)
        status = fp3_visit_make(image, &visit, error);
    if (status)
        return status;
    size_t size = 0;
    FILE *out = open_memstream(text, &size);
    if (out)
        write_all(out, name, image, visit, &around);
    fp3_visit_free(&visit);
    if (!out || fclose(out)) {
        free(*text);
        *text = NULL;
        return fp3_no_memory(error);
    }
    return FP3_OK;
}
