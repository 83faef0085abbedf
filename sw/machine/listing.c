/* SPDX-License-Identifier: Apache-2.0 */
#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fp3/isa.h>

static void write_registers(const fp3_image *image, FILE *out) {
    char text[FP3_NUMBER_TEXT_SIZE];
    fprintf(out, "\nregister class   name and value\n");
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        const fp3_symbol *s = &image->symbols[i];
        if (s->symbol_class == FP3_SYMBOL_LABEL)
            continue;
        int object = fp3_class_is_object(s->symbol_class);
        text[0] = 0;
        if (s->symbol_class == FP3_SYMBOL_CONST)
            fp3_number_text(*fp3_image_value(image, s->index), text);
        fprintf(out, "%c%-7u .%-6s %s%s%s\n",
                object ? FP3_BANK_OBJECT_PREFIX : FP3_BANK_SHARED_PREFIX, s->index,
                fp3_class_name(s->symbol_class), s->name, *text ? " " : "", text);
    }
    for (uint32_t i = 0; i < image->constant_count; i++) {
        if (fp3_image_name(image, FP3_BANK_SHARED_BASE + image->constants[i].index))
            continue;
        fp3_number_text(image->constants[i].bits, text);
        fprintf(out, "%c%-7u         %s\n", FP3_BANK_SHARED_PREFIX, image->constants[i].index,
                text);
    }
}

fp3_status fp3_listing(const fp3_assembly *assembly, const char *source, size_t size, char **text,
                       fp3_error *error) {
    const fp3_image *image = assembly->image;
    size_t text_size = 0;
    *text = NULL;
    FILE *out = open_memstream(text, &text_size);
    if (!out)
        return fp3_no_memory(error);
    fprintf(out, "index word      line  source\n");
    const char *end = source + size;
    uint32_t index = 0;
    for (uint32_t line = 1; source < end; line++) {
        const char *newline = memchr(source, '\n', (size_t)(end - source));
        size_t length = (size_t)((newline ? newline : end) - source);
        if (index < image->code_count && assembly->lines[index] == line) {
            fprintf(out, "%5u %08x %5u  ", index, image->code[index], line);
            index++;
        } else {
            fprintf(out, "%14s %5u  ", "", line);
        }
        fwrite(source, 1, length, out);
        fputc('\n', out);
        source = newline ? newline + 1 : end;
    }
    write_registers(image, out);
    if (fclose(out)) {
        free(*text);
        *text = NULL;
        return fp3_no_memory(error);
    }
    return FP3_OK;
}
