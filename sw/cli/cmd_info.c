/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_info.c - fp3 info: what an image needs, or what this build has. */
#include "arguments.h"
#include "cli.h"
#include "files.h"
#include "phases_print.h"

#include <fp3/engine.h>
#include <stdio.h>
#include <string.h>

#include "machine/config.h"
#include "machine/operation.h"
#include "machine/storage.h"
#include <fp3/isa.h>

/* "  step part   30: 9 add, 4 sub, 17 mul" */
static void print_part(const fp3_image *image, const char *name, uint32_t begin, uint32_t end) {
    const char *separator = ":";
    printf("%-11s %u", name, end - begin);
    for (unsigned i = 0; i < fp3_operation_count; i++) {
        unsigned count = 0;
        for (uint32_t at = begin; at < end; at++)
            count += image->decoded[at].of == &fp3_operations[i];
        if (count > 0) {
            printf("%s %u %s", separator, count, fp3_operations[i].name);
            separator = ",";
        }
    }
    unsigned illegal = 0;
    for (uint32_t at = begin; at < end; at++)
        illegal += !image->decoded[at].of;
    if (illegal > 0)
        printf("%s %u illegal", separator, illegal);
    printf("\n");
}

static int needs(const fp3_image *image, fp3_key key) {
    for (uint32_t i = 0; i < image->code_count; i++)
        if (image->decoded[i].of && image->decoded[i].of->needs == key)
            return 1;
    return (key == FP3_KEY_LOGARITHMIC && image->words == FP3_WORDS_LOGARITHMS) ||
           (key == FP3_KEY_MIXED && image->words == FP3_WORDS_MIXED);
}

/* "needs       select, multiply_add = chain": keys of a configuration. */
static void print_needs(const fp3_image *image) {
    int said = 0;
    for (fp3_key key = 0; key < FP3_KEY_COUNT; key++)
        if (needs(image, key)) {
            printf(said ? ", %s" : "%-11s %s", said ? fp3_key_name(key) : "needs",
                   fp3_key_name(key));
            said = 1;
        }
    if (said)
        printf("\n");
}

static void print_names(const fp3_image *image, fp3_symbol_class symbol_class, const char *title) {
    int found = 0;
    for (uint32_t i = 0; i < image->symbol_count; i++)
        if (image->symbols[i].symbol_class == symbol_class) {
            printf(found ? " %s" : "%-11s %s", found ? image->symbols[i].name : title,
                   image->symbols[i].name);
            found = 1;
        }
    if (found)
        printf("\n");
}

/* What fits is the engine's to say: it is asked to load the image. */
static fp3_status try_load(const fp3_config *c, const fp3_image *image, fp3_error *error) {
    fp3_engine *engine = NULL;
    fp3_engine_def def = fp3_engine_default();
    def.engine = "isa"; /* it refuses what the hardware has no room for */
    def.config = c->name;
    def.error = error;
    fp3_status status = fp3_engine_open(&def, &engine);
    if (!status)
        status = fp3_engine_load(engine, image);
    fp3_engine_close(&engine);
    return status;
}

static int print_image(const char *path) {
    fp3_image *image = NULL;
    fp3_error error;
    fp3_status status = fp3_image_load(path, &image, &error);
    if (status)
        return fp3_cli_fail("info", status, &error);
    printf("%-11s %u words\n", "code", image->code_count);
    print_part(image, "first part", 0, image->step);
    print_part(image, "step part", image->step, image->last);
    print_part(image, "last part", image->last, image->code_count);
    printf("%-11s %u object registers, %u shared constants\n", "registers", image->registers,
           image->shared);
    print_needs(image);
    print_names(image, FP3_SYMBOL_STATE, "state");
    print_names(image, FP3_SYMBOL_PARAM, "param");
    print_names(image, FP3_SYMBOL_SHARED, "shared");
    print_names(image, FP3_SYMBOL_LABEL, "label");
    print_names(image, FP3_SYMBOL_WORST, "worst");
    fp3_neighbourhood around = {0};
    fp3_neighbourhood_find(image, &around,
                           NULL); /* one that is no program with neighbours has none */
    for (uint32_t i = 0; !status && i < fp3_config_count; i++) {
        status = try_load(&fp3_configs[i], image, &error);
        if (status == FP3_E_PROGRAM) /* all else says nothing about the program */
            printf("%-11s %s: %s\n", "not for", fp3_configs[i].name, error.text);
        else if (!status)
            printf("%-11s %s\n", "for", fp3_configs[i].name);
        if (!status && around.is_any)
            fp3_phases_print_cycles(image, &fp3_configs[i]);
        status = status == FP3_E_PROGRAM ? FP3_OK : status;
    }
    fp3_image_free(&image);
    return status ? fp3_cli_fail("info", status, &error) : 0;
}

static const char *plural(uint32_t count) { return count == 1 ? "" : "s"; }

/* "  without: madd msub"; or that nothing is missing. */
static void print_missing(const fp3_config *c) {
    int missing = 0;
    for (unsigned i = 0; i < fp3_operation_count; i++)
        if (fp3_operation_lacks(c, fp3_operations[i].code) != FP3_KEY_NONE)
            printf(missing++ ? " %s" : "  without: %s", fp3_operations[i].name);
    printf(missing ? "\n" : "  every instruction\n");
}

static void print_config(const fp3_config *c) {
    printf("\n%s: %s\n", c->name, c->doc);
    printf("  %u object registers and shared constants, %u context%s, %u words of program\n",
           c->registers, c->contexts, plural(c->contexts), c->program_words);
    if (c->interleave)
        printf("  %u tile%s of %u scheduler%s with %u lane%s, %u words of object store each%s%s\n",
               c->tiles, plural(c->tiles), c->schedulers, plural(c->schedulers), c->lanes,
               plural(c->lanes), c->store_words, c->storage ? ", in " : "",
               c->storage ? fp3_storage_name(c) : "");
    printf("  add %u and mul %u cycles; %s, %s\n", c->add_latency, c->mul_latency,
           c->bypass ? "bypass" : "no bypass",
           c->writeback_stall ? "writeback stall" : "no writeback stall");
    print_missing(c);
    if (c->fraction < 23)
        printf("  numbers have %u fraction bits, not 23\n", c->fraction);
    if (c->mixed)
        printf("  rcp and rsqrt are computed through logarithms\n");
    printf("  %s, %s; %s, %s\n",
           c->logarithmic ? "words are logarithms"
           : c->subnormal ? "subnormal numbers"
                          : "subnormal numbers flushed to zero",
           c->logarithmic ? "products and quotients are exact"
           : c->finite    ? "truncates, no infinity and no NaN"
           : c->nearest   ? "rounds to nearest"
                          : "truncates",
           c->flags ? "flags" : "no flags",
           c->status ? "status of objects" : "no status of objects");
}

static int print_build(void) {
    printf("fp3 %s, instruction set revision %d:", FP3_VERSION, FP3_ISA_REVISION);
    for (unsigned i = 0; i < fp3_operation_count; i++)
        printf(" %s", fp3_operations[i].name);
    printf("\n");
    for (uint32_t i = 0; i < fp3_config_count; i++)
        print_config(&fp3_configs[i]);
    return 0;
}

static void take_word(void *user, struct argp_state *state, char *text) {
    const char **image = user;
    if (*image)
        argp_error(state, "found '%s', expected one image", text);
    *image = text;
}

int fp3_cmd_info(int argc, char **argv) {
    static const fp3_command command = {
        .take = take_word,
        .forms = "[IMAGE]",
        .doc = "Prints what IMAGE needs, and which configurations can execute it. Without IMAGE, "
               "prints the version, the instructions and all configurations.",
    };
    const char *image = NULL;
    fp3_arguments_parse(&command, argc, argv, &image);
    fp3_files files = {0};
    fp3_error error;
    fp3_files_read(&files, "IMAGE", image);
    const fp3_status status = fp3_files_check(&files, &error);
    if (status)
        return fp3_cli_fail("info", status, &error);
    return image ? print_image(image) : print_build();
}
