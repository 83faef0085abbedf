/* SPDX-License-Identifier: Apache-2.0 */
/* verify_command.c - see verify_command.h. */
#include "verify_command.h"

#include "arguments.h"
#include "run_options.h"

#include "engine/common/inside.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WORDS_MOST 4096
#define ROOM (WORDS_MOST + 4) /* also for the name, "--" and the NULL at the end */
#define LENGTH_MOST 131072    /* as of the kernel, of one argument */

static fp3_status add(fp3_verify_command *c, const char *format, const char *one, const char *other,
                      fp3_error *error) {
    char *word = NULL;
    if (c->argc + 1 == ROOM) /* one word, "-kkkk", may be many options */
        return fp3_fail(error, FP3_E_ARGUMENT, "more than %d arguments", WORDS_MOST);
    if (asprintf(&word, format, one, other) < 0)
        return fp3_no_memory(error);
    c->argv[c->argc++] = word;
    return FP3_OK;
}

static int is_on_a_port(const char *engine) {
    const fp3_engine_traits *is = fp3_engine_traits_of(engine, NULL);
    return is && is->has_port;
}

/* An fp3_argument_fn. */
static fp3_status take(void *user, const fp3_option *option, const char *value, fp3_error *error) {
    fp3_verify_command *c = user;
    if (!option)
        return FP3_OK;
    if (!strcmp(option->name, "engine") && c->engine)
        return FP3_OK;
    if (!strcmp(option->name, "engine") && is_on_a_port(value))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "its run was on engine board, and verify opens no port that a file names: "
                        "choose another engine with --engine");
    if (!strcmp(option->name, "output") && fp3_run_options_is_number(value))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "-o %s: found a number, expected a file: an fp3 in which -o was --objects "
                        "made the run",
                        value);
    if (option->forms == FP3_RUN_DECIDES)
        return add(c, value ? "--%s=%s" : "--%s", option->name, value, error);
    return option->forms == FP3_RUN_BESIDE
               ? FP3_OK
               : fp3_fail(error, FP3_E_ARGUMENT, "--%s is not run again", option->name);
}

/* An fp3_argument_fn: they follow behind all options. */
static fp3_status take_others(void *user, const fp3_option *option, const char *value,
                              fp3_error *error) {
    return option ? FP3_OK : add(user, "%s%s", value, "", error);
}

static fp3_status take_words(fp3_verify_command *c, int count, char *const *words,
                             fp3_error *error) {
    const fp3_option *table = fp3_run_options_table();
    fp3_error why = {.text = ""};
    c->argv = calloc(ROOM, sizeof *c->argv);
    if (!c->argv)
        return fp3_no_memory(error);
    fp3_status status = add(c, "%s%s", words[0], "", error);
    if (!status)
        status = fp3_arguments_each(table, count, words, take, c, &why);
    if (!status)
        status = add(c, "%s%s", "--", "", &why);
    if (!status)
        status = fp3_arguments_each(table, count, words, take_others, c, &why);
    return status ? fp3_fail(error, status, "%s: its command: %s", c->path, why.text) : FP3_OK;
}

fp3_status fp3_verify_command_make(fp3_verify_command *c, char *text, fp3_error *error) {
    static char name[] = "fp3 run";
    char **words = calloc(WORDS_MOST + 1, sizeof *words);
    int count = 0;
    c->argc = 0;
    c->argv = NULL;
    if (!words)
        return fp3_no_memory(error);
    words[count++] = name;
    fp3_status status = FP3_OK;
    for (char *rest = text, *line; !status && (line = strsep(&rest, "\n"));) {
        if (count > WORDS_MOST || strlen(line) >= LENGTH_MOST)
            status = fp3_fail(
                error, FP3_E_ARGUMENT,
                "%s: its command has more than %d arguments, or an argument of more than %d bytes",
                c->path, WORDS_MOST, LENGTH_MOST - 1);
        else
            words[count++] = line;
    }
    if (!status)
        status = take_words(c, count, words, error);
    free(words);
    return status;
}

void fp3_verify_command_free(fp3_verify_command *c) {
    for (int i = 0; i < c->argc; i++)
        free(c->argv[i]);
    free(c->argv);
    c->argv = NULL;
    c->argc = 0;
}
