/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_run.c - fp3 run: a program, or a scene of several, on an engine, from the host's values to
 * the final ones.
 */
#include "cli.h"
#include "lab/check/run_invariants.h"
#include "lab/check/run_reach.h"
#include "run_adaptive.h"
#include "run_bodies.h"
#include "run_options.h"
#include "run_print.h"
#include "run_ranks.h"
#include "world/split.h"

#include "engine/common/inside.h"

#include <fp3/trace.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of an invariant of all objects, relative to its size: what a run without a check tells of. */
#define LEAST_CHANGE 0.01

static const char *warning_of(const fp3_program *program) {
    return program->compiled ? program->compiled->warning : NULL;
}

static void warn_of_values(const char *path, const fp3_program *program, const fp3_params *params) {
    char text[FP3_RUN_ADAPTIVE_TEXT_SIZE];
    fp3_run_adaptive_warning(program, params, text);
    if (text[0])
        fp3_cli_warn("run", path, text);
}

/* Of a program that several groups run, once. */
static void warn(const fp3_run_options *o, const fp3_run_task *of) {
    if (of->program) {
        fp3_cli_warn("run", o->program, warning_of(of->program));
        warn_of_values(o->program, of->program, o->values.params);
    }
    for (size_t i = 0; of->scene && i < of->scene->group_count; i++) {
        const fp3_scene_group *groups = of->scene->groups;
        warn_of_values(groups[i].path, groups[i].program, groups[i].params);
        const char *warning = warning_of(groups[i].program);
        int is_said = 0;
        for (size_t j = 0; warning && j < i; j++)
            is_said |= !strcmp(groups[j].path, groups[i].path) && warning_of(groups[j].program) &&
                       !strcmp(warning_of(groups[j].program), warning);
        if (!is_said)
            fp3_cli_warn("run", groups[i].path, warning);
    }
}

/* A scene of one group is one program. */
static fp3_status record(fp3_run_options *o, const fp3_run_task *of, fp3_engine *engine,
                         fp3_cost *cost, fp3_error *error) {
    fp3_recording_def *def = &o->record.def;
    const int is_one = !of->scene || of->scene->group_count == 1,
              has_snapshots = fp3_run_record_has_snapshots(&o->record);
    const fp3_program *program = !is_one && !has_snapshots ? NULL
                                 : of->scene               ? of->scene->groups[def->group].program
                                                           : of->program;
    const fp3_params *params = of->scene ? of->scene->groups[def->group].params : o->values.params;
    fp3_status status =
        is_one
            ? FP3_OK
            : fp3_split_check_scene(of->scene, has_snapshots ? "snapshots" : "checkpoints", error);
    if (!status && def->times && !o->has_steps && !fp3_run_is_adaptive(of))
        status =
            fp3_recording_steps(program, params, def->times, def->time_count, &o->steps, error);
    def->steps = o->steps;
    if (!status)
        status = fp3_recording_open(def, program, params, engine, &o->recording, error);
    return status ? status : fp3_recording_run(o->recording, cost, error);
}

/* Of a program one part, of a scene one for each group. */
static size_t parts_of(const fp3_run_task *of) { return of->scene ? of->scene->group_count : 1; }

static fp3_run_part part_of(const fp3_run_options *o, const fp3_run_task *of, fp3_engine *engine,
                            size_t number) {
    if (!of->scene)
        return (fp3_run_part){of->program, o->values.params,           engine,
                              0,           fp3_engine_objects(engine), o->steps};
    const fp3_scene_group *group = &of->scene->groups[number];
    return (fp3_run_part){group->program, group->params,  engine,
                          group->first,   group->objects, o->steps};
}

/* What is computed of a run when it has ended, set by set. */
typedef struct {
    fp3_run_set *sets;
    size_t count;
    fp3_run_check **checks; /* of each set; NULL: not asked for */
    const fp3_run_check **of_part;
} hindsight;

static fp3_status find_sets(const fp3_run_options *o, const fp3_run_task *of, fp3_engine *engine,
                            hindsight *after, fp3_error *error) {
    const size_t count = parts_of(of);
    fp3_run_part *parts = calloc(count + 1, sizeof *parts);
    if (!parts)
        return fp3_no_memory(error);
    for (size_t i = 0; i < count; i++)
        parts[i] = part_of(o, of, engine, i);
    const fp3_status status =
        fp3_run_sets_make(of->scene, parts, count, &after->sets, &after->count, error);
    free(parts);
    return status;
}

/* Leaves a check for each set, or none. */
static fp3_status make_checks(const fp3_run_options *o, const fp3_run_task *of, fp3_engine *engine,
                              const fp3_engine_def *def, hindsight *after, fp3_error *error) {
    after->checks = calloc(after->count + 1, sizeof *after->checks);
    after->of_part = calloc(parts_of(of) + 1, sizeof *after->of_part);
    fp3_status status = after->checks && after->of_part ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < after->count; i++)
        status = fp3_run_check_make(&after->sets[i], def, &after->checks[i], error);
    for (size_t i = 0; !status && i < parts_of(of); i++) {
        const fp3_run_part part = part_of(o, of, engine, i);
        after->of_part[i] = after->checks[fp3_run_set_of(after->sets, after->count, &part)];
    }
    return status;
}

static void forget(hindsight *after) {
    for (size_t i = 0; after->checks && i < after->count; i++)
        fp3_run_check_free(&after->checks[i]);
    free(after->checks);
    free((void *)after->of_part);
    fp3_run_sets_free(&after->sets, after->count);
}

/* An fp3_run_say_fn. */
static void say(const char *path, const char *warning) { fp3_cli_warn("run", path, warning); }

/* Of a set the first file. */
static const char *of_set(const fp3_run_options *o, const fp3_run_set *set) {
    return set->scene ? set->groups[0]->path : o->program;
}

/* warnings: NULL after a run in which objects failed. */
static fp3_status warn_of_part(const fp3_run_options *o, const char *path, const fp3_run_part *part,
                               size_t *warnings, fp3_error *error) {
    fp3_run_loss *loss = NULL;
    if (!part->program->model)
        return FP3_OK;
    if (warnings) {
        const fp3_status status = fp3_run_reach_warn(part, say, path, warnings, error);
        if (status)
            return status;
    }
    if (fp3_run_loss_is_blind(part)) {
        /* A check has another arithmetic, and says itself what it does not see. */
        if (warnings && o->check.is_strict && !o->check.is_asked) {
            say(path,
                "digits that FP32 loses are not looked for where pairs remember, where objects "
                "see others of another group, or where objects that see each other are "
                "born or gone");
            ++*warnings;
        }
        return FP3_OK;
    }
    fp3_status status = fp3_run_loss_open(part, &loss, error);
    if (!status)
        status = warnings ? fp3_run_loss_warn(loss, say, path, o->check.bound, warnings, error)
                          : fp3_run_loss_warn_failed(loss, say, path, error);
    fp3_run_loss_close(&loss);
    return status;
}

static fp3_status warn_of_parts(const fp3_run_options *o, const fp3_run_task *of,
                                fp3_engine *engine, size_t *warnings, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < parts_of(of); i++) {
        const fp3_run_part part = part_of(o, of, engine, i);
        status = warn_of_part(o, of->scene ? of->scene->groups[i].path : o->program, &part,
                              warnings, error);
    }
    return status;
}

/* Prints what became of the invariants of all objects, where that takes no time; a check has said
 * it already. */
static fp3_status look_at_invariants(const fp3_run_options *o, const hindsight *after,
                                     size_t *warnings, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && !after->checks && i < after->count; i++) {
        char text[FP3_RUN_INVARIANTS_TEXT_SIZE];
        fp3_run_invariants *invariants = NULL;
        status = fp3_run_invariants_open(&after->sets[i], 1, &invariants, error);
        if (!status)
            status = fp3_run_invariants_end(invariants, error);
        if (!status) {
            fp3_run_invariants_print(invariants);
            fp3_run_invariants_judge(invariants, LEAST_CHANGE, text);
            if (*text)
                say(of_set(o, &after->sets[i]), text);
            *warnings += *text != '\0';
        }
        fp3_run_invariants_close(&invariants);
    }
    return status;
}

static fp3_status look_at_growth(const fp3_run_options *o, const hindsight *after, size_t *warnings,
                                 fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < after->count; i++)
        status = fp3_run_growth_warn(&after->sets[i], say, o->program, warnings, error);
    return status;
}

/* What no flag tells. */
static fp3_status judge(const fp3_run_options *o, const fp3_run_task *of, fp3_engine *engine,
                        const hindsight *after, fp3_error *error) {
    size_t warnings = 0;
    fp3_status status = warn_of_parts(o, of, engine, &warnings, error);
    if (!status)
        status = look_at_growth(o, after, &warnings, error);
    if (!status)
        status = look_at_invariants(o, after, &warnings, error);
    if (status || !o->check.is_strict)
        return status;
    for (size_t i = 0; !status && after->checks && i < after->count; i++)
        status = fp3_run_check_judge(after->checks[i], o->check.bound, error);
    return !status && warnings
               ? fp3_fail(error, FP3_E_FAILED, "%zu of these warnings, and --strict allows none",
                          warnings)
               : status;
}

/* *has_run: it came as far. */
static fp3_status run(fp3_run_options *o, const fp3_run_task *of, const fp3_engine_def *def,
                      int *has_run, fp3_error *error) {
    fp3_engine *engine = NULL;
    hindsight after = {0};
    fp3_cost cost = {.stats = {.flags = 0}};
    if (o->on.cycle_limit && fp3_run_is_adaptive(of))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--cycle-limit: a limit applies to one run, and adaptive steps may take "
                        "several; --steps limits attempts");
    fp3_status status =
        o->ranks ? fp3_engine_open_ranks(def, o->ranks, &engine) : fp3_engine_open(def, &engine);
    if (!status)
        status = of->scene ? fp3_scene_load(of->scene, engine, error)
                           : fp3_program_load(of->program, o->values.params, engine, error);
    if (!status) { /* from here on there are no more groups than schedulers */
        fp3_progress_pause(o->progress);
        if (!o->is_quiet)
            warn(o, of);
        fp3_progress_resume(o->progress);
        fp3_progress_say(o->progress, "running");
        status = fp3_run_record_is_asked(&o->record)
                     ? record(o, of, engine, &cost, error)
                     : fp3_adaptive_run(engine, o->steps, &cost.stats);
        /* What a failed run left is read by all ranks together, and they may be elsewhere. */
        *has_run = !status || (!o->ranks && (status == FP3_E_LIMIT || status == FP3_E_PROGRAM));
        if (!status)
            status = find_sets(o, of, engine, &after, error);
        if (!status && o->check.is_asked)
            status = make_checks(o, of, engine, def, &after, error);
        fp3_progress_end(&o->progress);
        const fp3_error why = *error; /* printing reads registers, which may fail as well */
        if (*has_run && !o->is_quiet)
            fp3_run_print(engine, of, def, &cost, status ? NULL : after.of_part, o->all,
                          o->on.clock);
        *error = why;
    }
    if (!status && !o->allows_failures)
        status = fp3_run_failed(engine, of, &cost, error);
    if (status == FP3_E_FAILED && *has_run && !o->is_quiet) {
        fp3_error other; /* why it failed stays the message */
        size_t unused = 0;
        (void)warn_of_parts(o, of, engine, NULL, &other);
        if (!after.checks)
            (void)look_at_growth(o, &after, &unused, &other);
    }
    if (!status && !o->is_quiet)
        status = judge(o, of, engine, &after, error);
    forget(&after);
    fp3_recording_close(&o->recording);
    fp3_engine_close(&engine);
    return status;
}

/* With the pipeline's log, if that is asked for; of a run that ended before its time, too. */
static fp3_status run_and_log(fp3_run_options *o, const fp3_run_task *of, fp3_engine_def *def,
                              fp3_error *error) {
    fp3_kanata *kanata = NULL;
    if (o->on.kanata) {
        fp3_status status =
            fp3_kanata_open(o->on.kanata, def->config, of->program->image, &kanata, error);
        if (status)
            return status;
        def->trace = fp3_kanata_trace;
        def->trace_user = kanata;
    }
    fp3_error other;
    int has_run = 0;
    fp3_status status = run(o, of, def, &has_run, error);
    fp3_status logged = has_run ? fp3_kanata_close(&kanata, &other) : FP3_OK;
    fp3_kanata_free(&kanata);
    if (status || !logged)
        return status;
    *error = other;
    return logged;
}

/* An fp3_progress_fn. */
static void tell(void *options_of, double share) {
    const fp3_run_options *o = options_of;
    fp3_progress_share(o->progress,
                       o->recording ? fp3_recording_share(o->recording, share) : share);
}

/* What both have. */
static fp3_status define(fp3_run_options *o, fp3_engine_def *def, fp3_error *error) {
    def->progress = o->progress ? tell : NULL;
    def->progress_user = o;
    return fp3_run_engine_define(&o->on, def, error);
}

static fp3_status check_files(fp3_run_options *o, fp3_error *error) {
    fp3_files_read(&o->files, "PROGRAM", o->program);
    fp3_files_read(&o->files, "--scene", o->scene);
    fp3_files_read(&o->files, "--integrator", fp3_cli_integrator_file(o->integrator));
    fp3_files_write(&o->files, "--kanata", o->on.kanata);
    fp3_files_write(&o->files, "--bus-log", o->on.bus_log);
    fp3_files_write(&o->files, "--output", o->record.def.path);
    fp3_files_write(&o->files, "--contacts", o->contacts);
    fp3_files_write(&o->files, "--plot", o->record.def.plot);
    fp3_run_record_files(&o->record, &o->files);
    return fp3_files_check(&o->files, error);
}

/* Which group is recorded. */
static fp3_status find_group(const fp3_scene *scene, fp3_run_options *o, fp3_error *error) {
    const int has_snapshots = fp3_run_record_has_snapshots(&o->record);
    size_t found = scene->group_count, count = 0;
    for (size_t i = 0; o->group && i < scene->group_count; i++)
        if (scene->groups[i].name && strcmp(scene->groups[i].name, o->group) == 0) {
            found = i;
            count++;
        }
    o->record.def.group = count == 1 ? found : 0;
    if (o->group && (count != 1 || !has_snapshots))
        return fp3_fail_at(error, FP3_E_ARGUMENT, scene->path, (unsigned)scene->line, 0,
                           has_snapshots ? "--group %s: %zu groups have this name, expected one"
                                         : "--group %s: nothing is recorded (--output, --plot)",
                           o->group, count);
    if (has_snapshots && scene->group_count != 1 && !o->group)
        return fp3_fail_at(error, FP3_E_ARGUMENT, scene->path, (unsigned)scene->line, 0,
                           "--output, --plot: the scene has %zu groups, and a recording has the "
                           "states of one model: --group says which",
                           scene->group_count);
    return FP3_OK;
}

static fp3_status check_files_of(const fp3_scene *scene, fp3_run_options *o, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < scene->group_count; i++) {
        fp3_files files = {0};
        fp3_files_read_group(&files, &scene->groups[i]);
        fp3_files_write(&files, "--bus-log", o->on.bus_log);
        fp3_files_write(&files, "--kanata", o->on.kanata);
        fp3_files_write(&files, "--output", o->record.def.path);
        fp3_files_write(&files, "--plot", o->record.def.plot);
        fp3_files_write(&files, "--checkpoint", o->record.def.checkpoint);
        status = fp3_files_check(&files, error);
    }
    return status ? status : find_group(scene, o, error);
}

/* As many objects as are linked, if nothing says how many. */
static fp3_status read_links(fp3_run_options *o, fp3_engine_def *def, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < o->link_count; i++) {
        size_t objects = 0;
        status = fp3_params_link_file(o->values.params, o->links[i], o->objects, &objects, error);
        if (objects > def->objects)
            def->objects = (uint32_t)objects;
    }
    return status;
}

static fp3_status run_program(fp3_run_options *o, char **report, fp3_error *error) {
    fp3_program_def how = o->how;
    fp3_engine_def def = fp3_engine_default();
    fp3_program *program = NULL;
    if (o->on.port && !o->config && o->ranks)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--port: expected --config, too: one program is compiled for the boards of "
                        "all ranks");
    if (o->on.port && !o->config) {
        fp3_status status = fp3_engine_find(o->on.port, (uint32_t)o->on.baud, &o->config, error);
        if (status)
            return status;
    }
    how.is_model = o->is_model;
    how.compile.config = o->config;
    how.compile.is_for_host = 1;
    how.integrator = o->integrator;
    def.objects = (uint32_t)o->objects;
    fp3_status status = read_links(o, &def, error);
    status = status ? status : fp3_run_adaptive_maxstep(&how, o->values.params, error);
    status = status ? status : fp3_program_open(o->program, &how, &program, report, error);
    if (!status) {
        def.config = o->config ? o->config : program->config ? program->config : def.config;
        def.engine = fp3_engine_usual(program->sees_others);
        status = define(o, &def, error);
    }
    if (!status && !o->has_steps && fp3_adaptive_is(program->image))
        o->steps = FP3_ADAPTIVE_ATTEMPTS;
    if (!status)
        status = run_and_log(o, &(fp3_run_task){.program = program}, &def, error);
    fp3_program_close(&program);
    return status;
}

/* Where the options say nothing, the scene does. */
static fp3_status run_scene(fp3_run_options *o, fp3_error *error) {
    fp3_scene *scene = NULL;
    int has_run = 0;
    fp3_status status = fp3_scene_open(o->scene, o->config, &scene, error);
    if (status)
        return status;
    status = check_files_of(scene, o, error);
    fp3_engine_def def = fp3_scene_engine(scene);
    o->steps = o->has_steps ? o->steps : scene->steps;
    if (!status)
        status = define(o, &def, error);
    if (!status)
        status = run(o, &(fp3_run_task){.scene = scene}, &def, &has_run, error);
    fp3_scene_close(&scene);
    return status;
}

fp3_status fp3_run_make(fp3_run_options *o, char **report, fp3_error *error) {
    fp3_progress_say(o->progress, "reading and compiling");
    if (o->scene && fp3_run_is_bodies(o->scene))
        return fp3_run_bodies(o, error);
    if (o->contacts)
        return fp3_fail(error, FP3_E_ARGUMENT, "--contacts: expected a --scene of bodies");
    return o->scene ? run_scene(o, error) : run_program(o, report, error);
}

int fp3_cmd_run(int argc, char **argv) {
    /* Threads change no bit; what files hold is compared when it is loaded. */
    static const char *const own[] = {"threads", "scene", "params", "links", "integrator", NULL};
    fp3_run_options o;
    fp3_error error = {.text = ""};
    char *report = NULL;
    fp3_run_ranks ranks;
    fp3_run_ranks_first(&ranks);
    fp3_status status = fp3_run_options_parse(argc, argv, &o, &error);
    if (!status)
        status = fp3_run_record_command(&o.record, argc, argv, &error);
    if (!status)
        status = fp3_run_ranks_begin(&ranks, &error);
    if (!status)
        status = fp3_run_ranks_agree(&ranks, fp3_run_options_table(), argc, argv, own, &error);
    o.ranks = ranks.is_one ? NULL : &ranks.all;
    o.record.def.is_silent = ranks.all.rank != 0;
    if (!status)
        status = fp3_run_ranks_port(&ranks, &o.on, &error);
    if (!status)
        status = check_files(&o, &error);
    if (!status) {
        o.progress = fp3_progress_begin("run", o.program ? o.program : o.scene);
        status = fp3_run_make(&o, &report, &error);
        fp3_progress_end(&o.progress);
    }
    const int said = fp3_cli_end("run", status, &error, report);
    const int exit_code = fp3_run_ranks_end(&ranks, "run", status, &error) ? 0 : said;
    free(report);
    fp3_run_options_free(&o);
    return exit_code;
}
