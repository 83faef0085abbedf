/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_verify.c - fp3 verify: runs a part of a run again, from what its file keeps of the command,
 * and compares hashes. */
#include "arguments.h"
#include "cli.h"
#include "run_options.h"
#include "verify_command.h"

#include "base/file.h"
#include "record/chain.h"
#include "record/checkpoint.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *path, *engine, *restart, *source;
    uint64_t from, to, threads;
    int has_from;
} options;

static void take_from(void *user, struct argp_state *state, char *text) {
    options *o = user;
    o->from = fp3_arguments_number(state, "--from", text, 0, UINT32_MAX);
    o->has_from = 1;
}

static void end(void *user, struct argp_state *state) {
    options *o = user;
    if (!o->path)
        argp_error(state, "expected a checkpoint, or a recording in HDF5");
    if (o->from > o->to)
        argp_error(state, "--from and --to: expected A not above B");
}

static const fp3_option table[] = {
    {"from", 0, "A", "Compare from step A on (default: the first that FILE has)",
     FP3_CALL(take_from)},
    {"to", 0, "B", "Compare up to step B (default: the last that FILE has)",
     FP3_NUMBER(options, to, 0, UINT32_MAX)},
    {"engine", 'e', "ENGINE", "On this engine: rtl, isa or fast (default: that of the run)",
     FP3_TEXT(options, engine)},
    {"threads", 0, "N", "Of engine fast (default: one for each processor)",
     FP3_NUMBER(options, threads, 1, 1024)},
    {"restart", 0, "CHECKPOINT",
     "Begin at this checkpoint, at A or before (default: at the start of the run; for a checkpoint "
     "at FILE.1, "
     "if that is whole and not "
     "before A)",
     FP3_TEXT(options, restart)},
    {"source", 0, "PATH",
     "The program or the scene (default: where the run found it, from the current directory)",
     FP3_TEXT(options, source)},
    {0},
};

/* ---- where it begins, and what it compares ---- */

/* For a checkpoint the one before, by default. */
static fp3_status find_begin(const options *o, const fp3_chain *chain, char **path, uint64_t *step,
                             fp3_error *error) {
    fp3_checkpoint *checkpoint = NULL;
    fp3_error why;
    *step = 0;
    *path = o->restart             ? strdup(o->restart)
            : chain->is_checkpoint ? fp3_output_before(o->path)
                                   : NULL;
    if (!*path)
        return FP3_OK;
    const fp3_status status = fp3_checkpoint_open(*path, &checkpoint, o->restart ? error : &why);
    const int is_there = !status;
    if (is_there)
        *step = fp3_checkpoint_step(checkpoint);
    fp3_checkpoint_close(&checkpoint);
    if (o->restart ||
        (is_there && *step < chain->list[0].step && (!o->has_from || *step >= o->from)))
        return o->restart ? status : FP3_OK;
    free(*path);
    *path = NULL;
    *step = 0;
    return FP3_OK;
}

/* Cuts the list. */
static fp3_status choose(const options *o, const fp3_chain *chain, uint64_t begin,
                         fp3_expected *expected, fp3_error *error) {
    size_t first = 0, count = 0;
    while (first < chain->count && chain->list[first].step < o->from)
        first++;
    while (first + count < chain->count && chain->list[first + count].step <= o->to)
        count++;
    *expected = (fp3_expected){.path = o->path, .list = chain->list + first, .count = count};
    if (!count)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: has steps %" PRIu64 " to %" PRIu64 ": --from and --to leave none of "
                        "them",
                        o->path, chain->list[0].step, chain->list[chain->count - 1].step);
    if (begin > expected->list[0].step)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--restart %s: after %" PRIu64
                        " steps, and the first to compare is %" PRIu64,
                        o->restart, begin, expected->list[0].step);
    return FP3_OK;
}

/* ---- the second run ---- */

static fp3_status run_by(const options *o, fp3_run_options *run, fp3_run_ranks *ranks,
                         char **report, fp3_error *error) {
    run->is_quiet = run->allows_failures = 1;
    run->on.engine = o->engine ? o->engine : run->on.engine;
    run->on.threads = o->threads;
    if (o->source)
        *(run->scene ? &run->scene : &run->program) = o->source;
    run->ranks = ranks->is_one ? NULL : &ranks->all;
    run->record.def.is_silent = ranks->all.rank != 0;
    run->progress = fp3_progress_begin("verify", o->path);
    const fp3_status status = fp3_run_make(run, report, error);
    fp3_progress_end(&run->progress);
    return status;
}

static fp3_status run_again(const options *o, char *text, const char *restart,
                            fp3_expected *expected, fp3_run_ranks *ranks, char **report,
                            fp3_error *error) {
    fp3_run_options run;
    fp3_verify_command command = {.path = o->path, .engine = o->engine};
    fp3_status status = fp3_verify_command_make(&command, text, error);
    if (!status) {
        status = fp3_run_options_parse(command.argc, command.argv, &run, error);
        run.record.def.restart = restart;
        run.record.def.expected = expected;
        run.steps = expected->list[expected->count - 1].step;
        run.has_steps = 1;
        if (!status)
            status = run_by(o, &run, ranks, report, error);
        fp3_run_options_free(&run);
    }
    fp3_verify_command_free(&command);
    if (!status && !ranks->all.rank && (!expected->agreed || expected->agreed != expected->count))
        status = fp3_fail(error, FP3_E_MISMATCH, "%s: of %zu hashes the second run has made %zu",
                          o->path, expected->count, expected->agreed);
    return status;
}

static void print(const options *o, const fp3_expected *expected, uint64_t begin) {
    const uint64_t first = expected->list[0].step;
    const uint64_t last = expected->list[expected->count - 1].step;
    if (expected->count == 1)
        fp3_cli_line(stdout,
                     "%s: the hash of step %" PRIu64 " agrees, run again from step %" PRIu64,
                     o->path, first, begin);
    else
        fp3_cli_line(stdout,
                     "%s: %zu hashes of steps %" PRIu64 " to %" PRIu64
                     " agree, run again from step %" PRIu64,
                     o->path, expected->agreed, first, last, begin);
}

static fp3_status verify(const options *o, fp3_run_ranks *ranks, char **report, fp3_error *error) {
    fp3_chain chain;
    fp3_expected expected = {0};
    char *restart = NULL;
    uint64_t begin = 0;
    fp3_status status = fp3_chain_read(o->path, &chain, error);
    if (!status && !*chain.command)
        status = fp3_fail(error, FP3_E_ARGUMENT,
                          "%s: has no command of its run: another program made the file", o->path);
    if (!status)
        status = find_begin(o, &chain, &restart, &begin, error);
    if (!status)
        status = choose(o, &chain, begin, &expected, error);
    if (!status)
        status = run_again(o, chain.command, restart, &expected, ranks, report, error);
    if (!status)
        print(o, &expected, begin);
    fp3_chain_free(&chain);
    free(restart);
    return status;
}

int fp3_cmd_verify(int argc, char **argv) {
    static const fp3_command command = {
        .options = table,
        FP3_WORD(options, path, "file"),
        .end = end,
        .forms = "FILE",
        .doc = "Runs steps A to B of a run again, on any engine, and compares hashes with FILE, "
               "a checkpoint or a recording in HDF5. FILE keeps the arguments of its run. Exit "
               "code 0: all hashes agree; 1: a hash differs, or the run failed; 2: there is "
               "nothing to compare."};
    static const char *const own[] = {"threads", "source", NULL}; /* as of fp3 run */
    options o = {.to = UINT64_MAX};
    fp3_error error = {.text = ""};
    char *report = NULL;
    fp3_run_ranks ranks;
    fp3_run_ranks_first(&ranks);
    fp3_arguments_parse(&command, argc, argv, &o);
    fp3_status status = fp3_run_ranks_begin(&ranks, &error);
    if (!status)
        status = fp3_run_ranks_agree(&ranks, table, argc, argv, own, &error);
    if (!status)
        status = verify(&o, &ranks, &report, &error);
    const int exit_code = fp3_cli_end("verify", status, &error, report);
    const int is_told = fp3_run_ranks_end(&ranks, "verify", status, &error);
    free(report);
    return is_told ? 0 : exit_code;
}
