/* SPDX-License-Identifier: Apache-2.0 */
/* run_record.c - see run_record.h. */
#include "run_record.h"

#include "arguments.h"
#include "base/file.h"

#include <fp3/model.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t count_parts(const char *text) {
    size_t count = 1;
    for (const char *comma = text; (comma = strchr(comma, ',')); comma++)
        count++;
    return count;
}

static void *room(struct argp_state *state, size_t count, size_t size) {
    void *made = calloc(count, size);
    if (!made)
        argp_failure(state, 1, 0, "out of memory");
    return made;
}

void fp3_run_record_every(fp3_run_record *record, struct argp_state *state, const char *text) {
    record->def.every = fp3_arguments_number(state, "--every", text, 1, UINT32_MAX);
}

void fp3_run_record_times(fp3_run_record *record, struct argp_state *state, const char *text) {
    fp3_error error;
    char *copy = strdup(text), *rest = copy;
    record->times = room(state, count_parts(text), sizeof *record->times);
    for (char *part; (part = strsep(&rest, ","));)
        if (fp3_constant_read(part, &record->times[record->def.time_count++], &error))
            argp_error(state, "--times: '%s' is no time: %s", part, error.text);
    free(copy);
    record->def.times = record->times;
}

void fp3_run_record_observe(fp3_run_record *record, struct argp_state *state, const char *text) {
    const size_t count = record->def.observed_count + count_parts(text);
    char **names = realloc(record->names, count * sizeof *names);
    if (!names)
        argp_failure(state, 1, 0, "out of memory");
    record->names = names;
    record->def.observed = (const char *const *)names;
    for (; record->def.observed_count < count; text += strcspn(text, ",") + 1)
        if (!(names[record->def.observed_count++] = strndup(text, strcspn(text, ","))))
            argp_failure(state, 1, 0, "out of memory");
}

void fp3_run_record_checkpoint_every(fp3_run_record *record, struct argp_state *state,
                                     const char *text) {
    record->def.checkpoint_every =
        fp3_arguments_number(state, "--checkpoint-every", text, 1, UINT32_MAX);
}

int fp3_run_record_has_snapshots(const fp3_run_record *record) {
    return record->def.path || record->def.plot;
}

int fp3_run_record_is_asked(const fp3_run_record *record) {
    const fp3_recording_def *def = &record->def;
    return fp3_run_record_has_snapshots(record) || def->checkpoint || def->restart || def->expected;
}

void fp3_run_record_check(const fp3_run_record *record, struct argp_state *state) {
    const fp3_recording_def *def = &record->def;
    if (!def->path && !def->plot && (def->every || def->times || def->observed))
        argp_error(state,
                   "--every, --times, --observe: expected --output FILE or --plot FILE, too");
    if (def->is_compressed && !def->path)
        argp_error(state, "--compress: expected --output FILE, an HDF5 file");
    if (def->checkpoint_every && !def->checkpoint)
        argp_error(state, "--checkpoint-every: expected --checkpoint FILE, too");
    if (def->every && def->times)
        argp_error(state, "--every and --times: expected one of them");
}

fp3_status fp3_run_record_command(fp3_run_record *record, int argc, char **argv, fp3_error *error) {
    size_t size = 1;
    int has_breaks = 0;
    for (int i = 1; i < argc; i++) {
        size += strlen(argv[i]) + 1;
        has_breaks |= strchr(argv[i], '\n') != NULL;
    }
    if (has_breaks)
        return record->def.checkpoint ? fp3_fail(error, FP3_E_ARGUMENT,
                                                 "--checkpoint: a checkpoint keeps the arguments, "
                                                 "one a line, and an argument has a line break")
                                      : FP3_OK;
    char *command = record->command = calloc(size, 1);
    if (!command)
        return fp3_no_memory(error);
    for (int i = 1; i < argc; i++)
        command += sprintf(command, "%s%s", i > 1 ? "\n" : "", argv[i]);
    record->def.command = record->command;
    return FP3_OK;
}

void fp3_run_record_files(fp3_run_record *record, fp3_files *files) {
    const fp3_recording_def *def = &record->def;
    if (def->checkpoint)
        record->before = fp3_output_before(def->checkpoint);
    fp3_files_write(files, "--checkpoint", def->checkpoint);
    fp3_files_keep(files, "--checkpoint, before", record->before);
    if (def->restart && (!record->before || (strcmp(def->restart, def->checkpoint) != 0 &&
                                             strcmp(def->restart, record->before) != 0)))
        fp3_files_read(files, "--restart", def->restart);
}

void fp3_run_record_free(fp3_run_record *record) {
    free(record->command);
    free(record->before);
    for (size_t i = 0; record->names && i < record->def.observed_count; i++)
        free(record->names[i]);
    free(record->names);
    free(record->times);
}
