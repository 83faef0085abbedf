/* run_record.c - see run_record.h. */
#include "run_record.h"

#include "arguments.h"

#include <fp3/model.h>
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

void fp3_run_record_observe(fp3_run_record *record, struct argp_state *state, char *text) {
    const size_t count = record->def.observed_count + count_parts(text);
    const char **names = realloc(record->names, count * sizeof *names);
    if (!names)
        argp_failure(state, 1, 0, "out of memory");
    record->names = names;
    for (char *part; (part = strsep(&text, ","));)
        record->names[record->def.observed_count++] = part;
    record->def.observed = record->names;
}

int fp3_run_record_is_asked(const fp3_run_record *record) {
    return record->def.path || record->def.plot;
}

void fp3_run_record_check(const fp3_run_record *record, struct argp_state *state) {
    const fp3_recording_def *def = &record->def;
    if (!def->path && !def->plot && (def->every || def->times || def->observed))
        argp_error(state,
                   "--every, --times, --observe: expected --output FILE or --plot FILE, where "
                   "it is written");
    if (def->is_compressed && !def->path)
        argp_error(state, "--compress: expected --output FILE, an HDF5 file");
    if (def->every && def->times)
        argp_error(state, "--every and --times: expected one of them");
}

void fp3_run_record_free(fp3_run_record *record) {
    free(record->names);
    free(record->times);
}
