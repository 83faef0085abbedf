/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_dis.c - fp3 dis: an image, or single words, to assembly text; an image to a C header. */
#include "arguments.h"
#include "cli.h"
#include "files.h"

#include <ctype.h>
#include <errno.h>
#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

typedef struct {
    const char *image, *output, *header;
    uint32_t *words;
    size_t word_count;
} options;

static uint32_t word(struct argp_state *state, const char *text) {
    char *end;
    errno = 0;
    unsigned long value = strtoul(text, &end, 16);
    if (text[0] != '0' || text[1] != 'x' || text[2] == 0 || *end || errno || value > UINT32_MAX)
        argp_error(state, "found '%s', expected a word as 0x and one to eight hexadecimal digits",
                   text);
    return (uint32_t)value;
}

static void take_one_word(void *user, struct argp_state *state, char *text) {
    options *o = user;
    o->words[o->word_count++] = word(state, text);
}

static void end(void *user, struct argp_state *state) {
    options *o = user;
    if (!o->image == !o->word_count)
        argp_error(state, "expected an image or --word");
    if (o->header && !o->image)
        argp_error(state, "--header: expected an image");
}

static const fp3_option table[] = {
    {"output", 'o', "FILE", "Write to FILE instead of the standard output",
     FP3_TEXT(options, output)},
    {"header", 0, "FILE",
     "Write the program as a C header for fp3_bare.h to FILE, instead of assembly; its names "
     "begin with the name of FILE",
     FP3_TEXT(options, header)},
    {"word", 0, "WORD", "Print this one instruction, 0x and hexadecimal digits; may be repeated",
     FP3_CALL(take_one_word), .is_repeated = 1},
    {0},
};

static fp3_status words_text(const options *o, char **text, fp3_error *error) {
    size_t size = 0;
    FILE *out = open_memstream(text, &size);
    fp3_status status = out ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < o->word_count; i++) {
        char line[FP3_WORD_TEXT_SIZE];
        status = fp3_word_text(o->words[i], NULL, line, error);
        if (!status)
            fprintf(out, "%s\n", line);
    }
    if (out && fclose(out) && !status)
        status = fp3_no_memory(error);
    return status;
}

static fp3_status image_text(const options *o, char **text, fp3_error *error) {
    fp3_image *image = NULL;
    fp3_status status = fp3_image_load(o->image, &image, error);
    if (!status && (status = fp3_disassemble(image, text, error))) {
        fp3_error why = *error;
        fp3_fail(error, status, "%s: %s", o->image, why.text);
    }
    fp3_image_free(&image);
    return status;
}

/* The name of a file without folders and ending, as a name of C: other signs become _. */
static void name_of(const char *path, char name[FP3_NAME_SIZE]) {
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    const char *dot = strchr(base, '.');
    const size_t length = dot ? (size_t)(dot - base) : strlen(base);
    const int is_output = strcmp(path, "-") == 0;
    snprintf(name, FP3_NAME_SIZE, "%.*s", is_output ? FP3_NAME_SIZE : (int)length,
             is_output ? "program" : base);
    for (size_t i = 0; name[i]; i++)
        if (!isalnum((unsigned char)name[i]) || (i == 0 && isdigit((unsigned char)name[i])))
            name[i] = '_';
}

static fp3_status write_header(const options *o, fp3_error *error) {
    fp3_image *image = NULL;
    char *text = NULL, name[FP3_NAME_SIZE];
    name_of(o->header, name);
    fp3_status status = fp3_image_load(o->image, &image, error);
    if (!status)
        status = fp3_image_header(image, name, &text, error);
    if (!status)
        status = fp3_file_write(o->header, text, strlen(text), error);
    free(text);
    fp3_image_free(&image);
    return status;
}

int fp3_cmd_dis(int argc, char **argv) {
    static const fp3_command command = {
        .options = table,
        FP3_WORD(options, image, "image"),
        .end = end,
        .forms = "IMAGE\n--word=WORD",
        .doc = "Disassembles IMAGE to text that assembles to the same image, or writes it as C.",
    };
    options o = {.words = calloc((size_t)argc + 1, sizeof *o.words)};
    if (!o.words)
        return 1;
    fp3_arguments_parse(&command, argc, argv, &o);
    fp3_error error;
    char *text = NULL;
    fp3_files files = {0};
    fp3_files_read(&files, "IMAGE", o.image);
    fp3_files_write(&files, "--output", o.output);
    fp3_files_write(&files, "--header", o.header);
    fp3_status status = fp3_files_check(&files, &error);
    if (!status && o.header)
        status = write_header(&o, &error);
    if (!status && (o.output || !o.header))
        status = o.image ? image_text(&o, &text, &error) : words_text(&o, &text, &error);
    if (!status && o.output)
        status = fp3_file_write(o.output, text, strlen(text), &error);
    else if (!status && text)
        fputs(text, stdout);
    free(text);
    free(o.words);
    return fp3_cli_end("dis", status, &error, NULL);
}
