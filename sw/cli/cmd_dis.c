/* cmd_dis.c - fp3 dis: an image, or single words, to assembly text. */
#include "arguments.h"
#include "cli.h"
#include "files.h"

#include <errno.h>
#include <fp3/asm.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

typedef struct {
    const char *image, *output;
    uint32_t *words;
    size_t word_count;
} options;

enum { KEY_WORD = 256 };

static const struct argp_option table[] = {
    {"output", 'o', "FILE", 0, "Write to FILE instead of the standard output", 0},
    {"word", KEY_WORD, "WORD", 0,
     "Print this one instruction, 0x and hexadecimal digits; may be repeated", 0},
    {0},
};

static uint32_t word(struct argp_state *state, const char *text) {
    char *end;
    errno = 0;
    unsigned long value = strtoul(text, &end, 16);
    if (text[0] != '0' || text[1] != 'x' || text[2] == 0 || *end || errno || value > UINT32_MAX)
        argp_error(state, "found '%s', expected a word as 0x and one to eight hexadecimal digits",
                   text);
    return (uint32_t)value;
}

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case 'o':
        o->output = text;
        break;
    case KEY_WORD:
        o->words[o->word_count++] = word(state, text);
        break;
    case ARGP_KEY_ARG:
        if (o->image)
            argp_error(state, "found '%s', expected one image", text);
        o->image = text;
        break;
    case ARGP_KEY_END:
        if (!o->image == !o->word_count)
            argp_error(state, "expected an image or --word");
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static fp3_status words_text(const options *o, char **text, fp3_error *error) {
    size_t size = 0;
    FILE *out = open_memstream(text, &size);
    fp3_status status = out ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (size_t i = 0; !status && i < o->word_count; i++) {
        char line[FP3_WORD_TEXT_SIZE];
        status = fp3_word_text(o->words[i], NULL, line, error);
        if (!status)
            fprintf(out, "%s\n", line);
    }
    if (out && fclose(out) && !status)
        status = fp3_fail(error, FP3_E_SYSTEM, "out of memory");
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

int fp3_cmd_dis(int argc, char **argv) {
    static const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "IMAGE\n--word=WORD",
        .doc = "Disassembles IMAGE to text that assembles to the same image.",
    };
    options o = {.words = calloc((size_t)argc + 1, sizeof *o.words)};
    if (!o.words)
        return 1;
    fp3_arguments_parse(&argp, argc, argv, &o);
    fp3_error error;
    char *text = NULL;
    fp3_files files = {0};
    fp3_files_read(&files, "IMAGE", o.image);
    fp3_files_write(&files, "--output", o.output);
    fp3_status status = fp3_files_check(&files, &error);
    if (!status)
        status = o.image ? image_text(&o, &text, &error) : words_text(&o, &text, &error);
    if (!status && o.output)
        status = fp3_file_write(o.output, text, strlen(text), &error);
    else if (!status)
        fputs(text, stdout);
    free(text);
    free(o.words);
    return fp3_cli_end("dis", status, &error, NULL);
}
