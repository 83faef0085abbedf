/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_asm.c - fp3 asm: assembly text to an image. */
#include "arguments.h"
#include "cli.h"
#include "files.h"

#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

typedef struct {
    const char *source, *image, *hex, *listing;
} options;

static void end(void *user, struct argp_state *state) {
    options *o = user;
    if (!o->source)
        argp_error(state, "expected a source");
}

static const fp3_option table[] = {
    {"output", 'o', "FILE", "Write the image (*.fp3)", FP3_TEXT(options, image)},
    {"hex", 0, "FILE", "Write the image's words as text for $readmemh", FP3_TEXT(options, hex)},
    {"listing", 0, "FILE", "Write the source with the words beside it, and the registers",
     FP3_TEXT(options, listing)},
    {0},
};

/* The image comes last: where it is new, all is. */
static fp3_status write_outputs(const options *o, const fp3_assembly *assembly, const char *source,
                                size_t size, fp3_error *error) {
    fp3_status status = FP3_OK;
    if (o->listing) {
        char *text = NULL;
        status = fp3_listing(assembly, source, size, &text, error);
        if (!status)
            status = fp3_file_write(o->listing, text, strlen(text), error);
        free(text);
    }
    if (!status && o->hex)
        status = fp3_image_save_hex(assembly->image, o->hex, error);
    if (!status && o->image)
        status = fp3_image_save(assembly->image, o->image, error);
    return status;
}

static fp3_status check_files(const options *o, fp3_error *error) {
    fp3_files files = {0};
    fp3_files_read(&files, "SOURCE", o->source);
    fp3_files_write(&files, "--output", o->image);
    fp3_files_write(&files, "--hex", o->hex);
    fp3_files_write(&files, "--listing", o->listing);
    return fp3_files_check(&files, error);
}

int fp3_cmd_asm(int argc, char **argv) {
    static const fp3_command command = {
        .options = table,
        FP3_WORD(options, source, "source"),
        .end = end,
        .forms = "SOURCE",
        .doc = "Assembles SOURCE and writes the files named by options; without options only "
               "checks.",
    };
    options o = {0};
    fp3_arguments_parse(&command, argc, argv, &o);
    fp3_error error;
    char *source = NULL;
    size_t size = 0;
    fp3_assembly *assembly = NULL;
    fp3_status status = check_files(&o, &error);
    if (!status)
        status = fp3_file_read(o.source, &source, &size, &error);
    if (!status)
        status = fp3_assemble(source, size, o.source, &assembly, &error);
    if (!status)
        status = write_outputs(&o, assembly, source, size, &error);
    const int is_wrong = assembly && assembly->error_count;
    const int exit_code = fp3_cli_end("asm", status, &error, is_wrong ? assembly->report : NULL);
    fp3_assembly_free(&assembly);
    free(source);
    return exit_code;
}
