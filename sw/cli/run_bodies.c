/* SPDX-License-Identifier: Apache-2.0 */
/* run_bodies.c - see run_bodies.h. */
#include "run_bodies.h"

#include "cli.h"

#include "bodies/scene/run.h"
#include "bodies/share.h"
#include "record/plan.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define SHOWN 8 /* bodies that are printed without --all */

int fp3_run_is_bodies(const char *scene) { return fp3_bodies_scene_is(scene); }

/* ---- options ---- */

static fp3_status check_options(const fp3_run_options *o, fp3_error *error) {
    const fp3_recording_def *def = &o->record.def;
    const struct {
        const char *option;
        int is_given;
        const char *why;
    } list[] = {
        {"--config", o->config != NULL, "bodies need no configuration: their engine chooses one"},
        {"--port, --baud", o->on.port || o->on.baud, "bodies run on isa, fast or rtl"},
        {"--threads", o->ranks && o->on.threads > 1, "each rank steps bodies by one thread"},
        {"--native", o->on.native != NULL, "the laws of bodies are compiled when they are needed"},
        {"--visit", o->on.visit != 0,
         "bodies are not visited: a contact is solved in each substep"},
        {"--cycle-limit", o->on.cycle_limit != 0, "a step of bodies is many runs; --steps ends it"},
        {"--bus-log", o->on.bus_log != NULL, "a step of bodies is many runs of several engines"},
        {"--bus-waits", o->on.bus_waits != 0, "a step of bodies is many runs of several engines"},
        {"--clock", o->on.clock > 0,
         "between the runs of a step the host works, and has no cycles"},
        {"--check, --strict", o->check.is_asked || o->check.is_strict,
         "bodies are in double, and contacts are no equations whose steps can be halved"},
        {"--allow-failures", o->allows_failures && !def->expected,
         "a run of bodies ends with the first that fails"},
        {"--plot", def->plot != NULL, "fp3 view draws a recording of bodies"}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        if (list[i].is_given)
            return fp3_fail(error, FP3_E_ARGUMENT, "%s: %s is a scene of bodies: %s",
                            list[i].option, o->scene, list[i].why);
    return FP3_OK;
}

/* Which bodies are recorded. */
static fp3_status find_group(const fp3_run_options *o, const fp3_bodies_scene *scene,
                             fp3_bodies_run_def *def, fp3_error *error) {
    def->count = scene->count;
    if (!o->group)
        return FP3_OK;
    for (size_t i = 0; i < scene->entry_count; i++)
        if (!strcmp(scene->entries[i].name, o->group) && scene->entries[i].count) {
            def->first = scene->entries[i].first;
            def->count = scene->entries[i].count;
            return o->record.def.path
                       ? FP3_OK
                       : fp3_fail(error, FP3_E_ARGUMENT,
                                  "--group %s: nothing is recorded (--output)", o->group);
        }
    return fp3_fail(error, FP3_E_ARGUMENT, "%s: --group: found '%s', expected the name of bodies",
                    scene->path, o->group);
}

static fp3_status check_files_of(fp3_run_options *o, const fp3_bodies_scene *scene,
                                 fp3_error *error) {
    fp3_files files = {0};
    for (size_t i = 0; i < scene->file_count; i++)
        fp3_files_read(&files, "points or ground", scene->files[i]);
    fp3_files_write(&files, "--output", o->record.def.path);
    fp3_files_write(&files, "--contacts", o->contacts);
    fp3_run_record_files(&o->record, &files);
    return fp3_files_check(&files, error);
}

/* Up to the last of the times, where nothing else says how many steps there are. */
static fp3_status find_steps(const fp3_run_options *o, const fp3_bodies_scene *scene,
                             fp3_recording_def *def, fp3_error *error) {
    const fp3_source source = {.has_time = 1, .h = scene->h, .h_given = scene->h};
    fp3_status status = FP3_OK;
    def->steps = o->has_steps ? o->steps : scene->steps;
    for (size_t i = 0; !status && !o->has_steps && i < def->time_count; i++)
        status = fp3_plan_step(&source, def->times[i], &def->steps, error);
    return status;
}

/* ---- what is printed ---- */

static void print_states(const fp3_bodies_scene *scene, int all) {
    static const char *const plane[] = {"x_x", "x_y", "angle", "v_x", "v_y", "w", NULL};
    static const char *const space[] = {"x_x", "x_y", "x_z", "q_w", "q_x", "q_y",
                                        "q_z", "v_x", "v_y", "v_z", NULL};
    const char *const *names = scene->dimensions == 3 ? space : plane;
    const size_t shown = all || scene->count < SHOWN ? scene->count : SHOWN;
    printf("%-16s", "body");
    for (size_t k = 0; names[k]; k++)
        printf(" %-15s", names[k]);
    putchar('\n');
    for (size_t i = 0; i < shown; i++) {
        char name[FP3_NAME_SIZE + 24];
        fp3_bodies_scene_name(scene, i, name);
        printf("%-16s", name);
        for (size_t k = 0; names[k]; k++) {
            double value = 0;
            if (!fp3_bodies_read(scene->bodies, names[k], &scene->handles[i], 1, &value))
                printf(" %-15.9g", value);
        }
        putchar('\n');
    }
    if (shown < scene->count)
        printf("%-16s %zu bodies, which --all prints\n", "more", scene->count - shown);
}

static void print_ranks(const fp3_bodies *bodies) {
    const fp3_share_use use = fp3_share_used(bodies);
    for (uint32_t r = 0; r < use.ranks; r++)
        printf("rank %-11" PRIu32 " %" PRIu64 " rows of contacts and joints\n", r, use.rows[r]);
    if (use.ranks)
        printf("%-16s %" PRIu64 " bytes; %" PRIu32 " ranks\n", "exchange", use.bytes, use.ranks);
}

static void print(const fp3_bodies_scene *scene, const fp3_bodies_tally *tally, int all) {
    size_t joints = 0;
    print_states(scene, all);
    for (size_t i = 0; i < scene->joint_count; i++)
        joints += (size_t)(fp3_bodies_is_joined(scene->bodies, scene->joints[i]) != 0);
    printf("%-16s %zu, of which %zu are awake\n", "bodies", scene->count,
           fp3_bodies_awake(scene->bodies));
    if (scene->joint_count)
        printf("%-16s %zu, of which %zu broke\n", "joints", scene->joint_count,
               scene->joint_count - joints);
    printf("%-16s %zu touch; %" PRIu64 " began, %" PRIu64 " ended, %" PRIu64 " hit\n", "contacts",
           fp3_bodies_touching(scene->bodies), tally->changes[FP3_CONTACT_BEGAN],
           tally->changes[FP3_CONTACT_ENDED], tally->changes[FP3_CONTACT_HIT]);
    printf("%-16s %" PRIu64 " of %.9g s", "steps", tally->steps, scene->h);
    if (tally->begin)
        printf(", from step %" PRIu64 " on", tally->begin);
    putchar('\n');
    printf("%-16s %.3g s", "time", tally->seconds);
    if (tally->seconds > 0 && tally->steps > tally->begin)
        printf(", %.4g body-steps/second",
               (double)(tally->steps - tally->begin) * (double)scene->count / tally->seconds);
    printf("; laws %s%s\n", scene->engine ? "on engine " : "built in",
           scene->engine ? scene->engine : "");
    print_ranks(scene->bodies);
    printf("%-16s %016" PRIx64 "\n", "hash", fp3_bodies_hash(scene->bodies));
    if (*tally->chain)
        printf("%-16s %s\n", "chain", tally->chain);
}

/* ---- all ---- */

static fp3_status run(fp3_run_options *o, fp3_bodies_scene *scene, fp3_error *error) {
    fp3_recording_def recording = o->record.def;
    fp3_bodies_tally tally;
    fp3_bodies_run_def def = {.recording = &recording,
                              .contacts = o->contacts,
                              .ranks = o->ranks,
                              .progress = o->progress ? fp3_progress_share : NULL,
                              .user = o->progress};
    fp3_status status = find_group(o, scene, &def, error);
    if (!status)
        status = check_files_of(o, scene, error);
    if (!status)
        status = find_steps(o, scene, &recording, error);
    if (status)
        return status;
    fp3_progress_say(o->progress, "running");
    status = fp3_bodies_scene_run(scene, &def, &tally, error);
    fp3_progress_end(&o->progress);
    if (!o->is_quiet && (!status || status == FP3_E_FAILED))
        print(scene, &tally, o->all);
    return status;
}

fp3_status fp3_run_bodies(fp3_run_options *o, fp3_error *error) {
    fp3_bodies_scene *scene = NULL;
    const uint32_t seed = (uint32_t)o->on.seed;
    fp3_status status = check_options(o, error);
    if (!status)
        status = fp3_bodies_scene_open(o->scene, o->on.engine, o->on.has_seed ? &seed : NULL,
                                       (uint32_t)o->on.threads, &scene, error);
    if (!status)
        status = run(o, scene, error);
    fp3_bodies_scene_close(&scene);
    return status;
}
