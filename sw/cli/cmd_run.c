/* cmd_run.c - fp3 run: a program, or a scene of several, on an engine, from the host's values to the
 * final ones.
 */
#include "arguments.h"
#include "cli.h"
#include "files.h"
#include "progress.h"
#include "run_adaptive.h"
#include "run_engine.h"
#include "run_print.h"
#include "run_record.h"
#include "run_values.h"

#include <fp3/program.h>
#include <fp3/trace.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *program, *scene, *config, *integrator;
    uint64_t steps, objects;
    fp3_run_engine on;
    int all, has_steps, is_model, allows_failures;
    fp3_run_values values;
    fp3_run_record record;
    fp3_recording *recording; /* while it runs; else NULL */
    fp3_files files;
    fp3_program_def how;
    fp3_progress *progress;
} options;

enum {
    KEY_SET = 256,
    KEY_PARAMS,
    KEY_LIMIT,
    KEY_BUS_LOG,
    KEY_BUS_WAITS,
    KEY_PORT,
    KEY_BAUD,
    KEY_VISIT,
    KEY_KANATA,
    KEY_ALL,
    KEY_SCENE,
    KEY_MODEL,
    KEY_CLOCK,
    KEY_SPREAD,
    KEY_ALLOW,
    KEY_EVERY,
    KEY_TIMES,
    KEY_OBSERVE,
    KEY_OUTPUT,
    KEY_COMPRESS,
    KEY_PLOT,
    KEY_THREADS,
    KEY_NATIVE,
    KEY_TOLERANCE,
    KEY_UNTIL,
    KEY_DOUBLE
};

static const struct argp_option table[] = {
    {"config", 'c', "NAME", 0,
     "Configuration (default: single, for a model single_full; with --port that of the board)", 0},
    {"model", KEY_MODEL, NULL, 0, "PROGRAM is a model, whatever its name", 0},
    {"integrator", 'i', "NAME", 0,
     "Of a model: a built-in table, or a file (default: " FP3_FIXED_INTEGRATOR ", with "
     "--tolerance " FP3_ADAPTIVE_INTEGRATOR ")",
     0},
    {"tolerance", KEY_TOLERANCE, "TOL", 0,
     "Of a model: each object chooses its own steps, each with an error of about TOL", 0},
    {"until", KEY_UNTIL, "TIME", 0,
     "With --tolerance: where objects end (default: the model's span)", 0},
    {"compensated", 'k', NULL, 0, "Of a model: keep what updates round away (Kahan)", 0},
    {"double-single", KEY_DOUBLE, NULL, 0,
     "Of a model: states and all arithmetic as sums of two floats, 48 bits", 0},
    {"engine", 'e', "ENGINE", 0,
     "rtl, the hardware under Verilator (default), isa, an instruction-set simulator in C, "
     "fast, native code for many objects, which counts no cycles, or board, hardware behind --port",
     0},
    {"port", KEY_PORT, "DEV", 0,
     "With --engine board: its serial port, as /dev/ttyUSB0, or what fp3 board prints", 0},
    {"baud", KEY_BAUD, "N", 0,
     "With --engine board: the rate of the port, 9600 to 3000000 (default: 115200)", 0},
    {"threads", KEY_THREADS, "N", 0, "Of engine fast (default: one for each processor)", 0},
    {"native", KEY_NATIVE, "FILE", 0, "Of engine fast: the code of fp3 compile --native", 0},
    {"steps", 'n', "N", 0,
     "How often the step part runs (default: 1; with --times until the last of them; with "
     "--tolerance 1000000, and objects end before)",
     0},
    {"objects", 'o', "N", 0, "How many (default: all contexts of the configuration full)", 0},
    {"visit", KEY_VISIT, "N", 0, "Steps per visit of an object (default: all)", 0},
    {"all", KEY_ALL, NULL, 0, "Print the states of all objects, not of the first 8", 0},
    {"params", KEY_PARAMS, "FILE", 0,
     "Values of states, parameters and shared constants; may be repeated", 0},
    {"set", KEY_SET, "NAME=VALUE", 0,
     "One such value; replaces what was given before it; may be repeated", 0},
    {"spread", KEY_SPREAD, "NAME=FIRST:LAST", 0,
     "Values from FIRST, of the first object, to LAST, of the last, evenly; may be repeated", 0},
    {"scene", KEY_SCENE, "FILE", 0,
     "Run the objects, programs and values of FILE instead of a PROGRAM; --config, --engine, "
     "--steps and --visit replace what it says",
     0},
    {"clock", KEY_CLOCK, "FREQUENCY", 0,
     "Also print how long the run takes at this clock, as 130MHz; units: Hz, kHz, MHz, GHz", 0},
    {"allow-failures", KEY_ALLOW, NULL, 0,
     "End with exit code 0, not 3, where objects failed: an instruction raised invalid or "
     "overflow, or a state is NaN or infinite in the end",
     0},
    {"output", KEY_OUTPUT, "FILE", 0,
     "Write what is observed to FILE: as HDF5 if its name ends in .h5 or .hdf5, else as CSV, a row "
     "for each object of each snapshot",
     0},
    {"compress", KEY_COMPRESS, NULL, 0, "With --output: compress what is HDF5", 0},
    {"plot", KEY_PLOT, "FILE", 0,
     "Draw what is observed over time, and of two states one against the other, into FILE, whose "
     "name ends in .svg or .png; of more than 8 objects 8 are drawn. Needs gnuplot",
     0},
    {"every", KEY_EVERY, "N", 0,
     "With --output or --plot: a snapshot after every N steps, at the start and at the end "
     "(default: "
     "at these two; of a plot some 500)",
     0},
    {"times", KEY_TIMES, "T1,T2,...", 0,
     "With --output or --plot: snapshots at these times from the start of the run alone, whole "
     "multiples of "
     "h in its unit",
     0},
    {"observe", KEY_OBSERVE, "NAMES", 0,
     "With --output or --plot: states, and of a model definitions and invariants, with commas "
     "between them; "
     "may be repeated (default: all states)",
     0},
    {"cycle-limit", KEY_LIMIT, "N", 0,
     "Stop after N clock cycles, with exit code 1 (default: none)", 0},
    {"bus-log", KEY_BUS_LOG, "FILE", 0, "Write every transfer on the bus to FILE", 0},
    {"bus-waits", KEY_BUS_WAITS, "SEED", 0,
     "Let each channel of the bus wait 0 to 3 cycles in each transfer, at random from SEED", 0},
    {"kanata", KEY_KANATA, "FILE", 0, "Write the pipeline's log to FILE, for the viewer Konata", 0},
    {0},
};

/* What belongs to an image, and what to a scene. */
static void check(const options *o, struct argp_state *state) {
    if (!o->program && !o->scene)
        argp_error(state, "expected a program, or --scene FILE");
    if (o->program && o->scene)
        argp_error(state, "--scene: found '%s', but the scene names its programs itself",
                   o->program);
    fp3_run_adaptive_check(&o->how, o->is_model, state);
    if (o->is_model && !o->program)
        argp_error(state, "--model: a scene's programs are known by their names");
    if ((o->integrator || o->how.compile.arithmetic) && !o->is_model)
        argp_error(state, "--integrator, --compensated, --double-single: only a model (*.ode, or "
                          "--model) is compiled");
    if (o->scene && o->objects)
        argp_error(state, "--scene: the scene says how many objects there are, not --objects");
    if (o->scene && fp3_params_count(o->values.params))
        argp_error(state, "--scene: values are in the scene, not in --params, --set or --spread");
    if (o->scene && o->on.kanata)
        argp_error(state, "--kanata: a log is of one program, not of a scene");
    fp3_run_engine_check(&o->on, state);
    if (fp3_run_record_is_asked(&o->record) && o->on.cycle_limit)
        argp_error(state,
                   "--cycle-limit: a limit is of one run, and --output and --plot make a run "
                   "for each snapshot");
    fp3_run_record_check(&o->record, state);
}

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case 'c':
        o->config = text;
        break;
    case 'e':
        o->on.engine = text;
        break;
    case 'o':
        o->objects = fp3_arguments_number(state, "--objects", text, 1, UINT32_MAX);
        break;
    case 'i':
        o->integrator = text;
        break;
    case 'k':
        fp3_arguments_arithmetic(state, &o->how.compile, FP3_COMPENSATED);
        break;
    case KEY_DOUBLE:
        fp3_arguments_arithmetic(state, &o->how.compile, FP3_DOUBLE_SINGLE);
        break;
    case KEY_MODEL:
        o->is_model = 1;
        break;
    case KEY_TOLERANCE:
        fp3_run_adaptive_tolerance(&o->how, state, text);
        break;
    case KEY_UNTIL:
        fp3_run_adaptive_until(&o->how, state, text);
        break;
    case KEY_THREADS:
        o->on.threads = fp3_arguments_number(state, "--threads", text, 1, 1024);
        break;
    case KEY_NATIVE:
        o->on.native = text;
        break;
    case KEY_PORT:
        o->on.port = text;
        break;
    case KEY_BAUD:
        o->on.baud = fp3_arguments_number(state, "--baud", text, 1, UINT32_MAX);
        break;
    case KEY_VISIT:
        o->on.visit = fp3_arguments_number(state, "--visit", text, 1, UINT32_MAX);
        break;
    case KEY_ALL:
        o->all = 1;
        break;
    case KEY_KANATA:
        o->on.kanata = text;
        break;
    case 'n':
        o->steps = fp3_arguments_number(state, "--steps", text, 0, UINT32_MAX);
        o->has_steps = 1;
        break;
    case KEY_SCENE:
        o->scene = text;
        break;
    case KEY_CLOCK:
        o->on.clock = fp3_arguments_frequency(state, "--clock", text);
        break;
    case KEY_ALLOW:
        o->allows_failures = 1;
        break;
    case KEY_LIMIT:
        o->on.cycle_limit = fp3_arguments_number(state, "--cycle-limit", text, 0, UINT64_MAX);
        break;
    case KEY_BUS_LOG:
        o->on.bus_log = text;
        break;
    case KEY_BUS_WAITS:
        o->on.bus_waits = fp3_arguments_number(state, "--bus-waits", text, 1, UINT64_MAX);
        break;
    case KEY_OUTPUT:
        o->record.def.path = text;
        break;
    case KEY_PLOT:
        o->record.def.plot = text;
        break;
    case KEY_COMPRESS:
        o->record.def.is_compressed = 1;
        break;
    case KEY_EVERY:
        fp3_run_record_every(&o->record, state, text);
        break;
    case KEY_TIMES:
        fp3_run_record_times(&o->record, state, text);
        break;
    case KEY_OBSERVE:
        fp3_run_record_observe(&o->record, state, text);
        break;
    case KEY_PARAMS:
        fp3_files_read(&o->files, "--params", text);
        fp3_run_values_load(&o->values, state, text);
        break;
    case KEY_SPREAD:
        fp3_run_values_spread(&o->values, state, text);
        break;
    case KEY_SET:
        fp3_run_values_set(&o->values, state, text);
        break;
    case ARGP_KEY_ARG:
        if (o->program)
            argp_error(state, "found '%s', expected one program", text);
        o->program = text;
        break;
    case ARGP_KEY_END:
        o->is_model = o->is_model || (o->program && fp3_program_is_model(o->program));
        check(o, state);
        if (o->how.is_adaptive && fp3_run_record_is_asked(&o->record))
            fp3_run_adaptive_record(&o->how, &o->record.def, state);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static const char *warning_of(const fp3_program *program) {
    return program->compiled ? program->compiled->warning : NULL;
}

/* Of a program that several groups run, once. */
static void warn(const options *o, const fp3_run_task *of) {
    if (of->program)
        fp3_cli_warn("run", o->program, warning_of(of->program));
    for (size_t i = 0; of->scene && i < of->scene->group_count; i++) {
        const fp3_scene_group *groups = of->scene->groups;
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
static fp3_status record(options *o, const fp3_run_task *of, fp3_engine *engine, fp3_cost *cost,
                         fp3_error *error) {
    const fp3_program *program = of->scene ? of->scene->groups[0].program : of->program;
    const fp3_params *params = of->scene ? of->scene->groups[0].params : o->values.params;
    fp3_recording_def *def = &o->record.def;
    fp3_status status = FP3_OK;
    if (def->times && !o->has_steps && !fp3_run_is_adaptive(of))
        status =
            fp3_recording_steps(program, params, def->times, def->time_count, &o->steps, error);
    def->steps = o->steps;
    if (!status)
        status = fp3_recording_open(def, program, params, engine, &o->recording, error);
    return status ? status : fp3_recording_run(o->recording, cost, error);
}

/* *has_run: it came as far. */
static fp3_status run(options *o, const fp3_run_task *of, const fp3_engine_def *def, int *has_run,
                      fp3_error *error) {
    fp3_engine *engine = NULL;
    fp3_cost cost = {.stats = {.flags = 0}};
    if (o->on.cycle_limit && fp3_run_is_adaptive(of))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--cycle-limit: a limit is of one run, and adaptive steps may take "
                        "several; --steps limits attempts");
    fp3_status status = fp3_engine_open(def, &engine);
    if (!status)
        status = of->scene ? fp3_scene_load(of->scene, engine, error)
                           : fp3_program_load(of->program, o->values.params, engine, error);
    if (!status) { /* from here on there are no more groups than schedulers */
        fp3_progress_pause(o->progress);
        warn(o, of);
        fp3_progress_resume(o->progress);
        fp3_progress_say(o->progress, "running");
        status = fp3_run_record_is_asked(&o->record)
                     ? record(o, of, engine, &cost, error)
                     : fp3_engine_advance(engine, o->steps, &cost.stats);
        fp3_progress_end(&o->progress);
        const fp3_error why = *error; /* printing reads registers, which may fail as well */
        *has_run = !status || status == FP3_E_LIMIT || status == FP3_E_PROGRAM;
        if (*has_run)
            fp3_run_print(engine, of, def, &cost, o->all, o->on.clock);
        *error = why;
    }
    if (!status && !o->allows_failures)
        status = fp3_run_check(engine, of, &cost, error);
    fp3_recording_close(&o->recording);
    fp3_engine_close(&engine);
    return status;
}

/* With the pipeline's log, if that is asked for; of a run that ended before its time, too. */
static fp3_status run_and_log(options *o, const fp3_run_task *of, fp3_engine_def *def,
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
    const options *o = options_of;
    fp3_progress_share(o->progress,
                       o->recording ? fp3_recording_share(o->recording, share) : share);
}

/* What both have. */
static fp3_status define(options *o, fp3_engine_def *def, fp3_error *error) {
    def->progress = o->progress ? tell : NULL;
    def->progress_user = o;
    return fp3_run_engine_define(&o->on, def, error);
}

static fp3_status check_files(options *o, fp3_error *error) {
    fp3_files_read(&o->files, "PROGRAM", o->program);
    fp3_files_read(&o->files, "--scene", o->scene);
    fp3_files_read(&o->files, "--integrator", fp3_cli_integrator_file(o->integrator));
    fp3_files_write(&o->files, "--kanata", o->on.kanata);
    fp3_files_write(&o->files, "--bus-log", o->on.bus_log);
    fp3_files_write(&o->files, "--output", o->record.def.path);
    fp3_files_write(&o->files, "--plot", o->record.def.plot);
    return fp3_files_check(&o->files, error);
}

static fp3_status check_files_of(const fp3_scene *scene, const options *o, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < scene->group_count; i++) {
        fp3_files files = {0};
        fp3_files_read(&files, "program", scene->groups[i].path);
        fp3_files_read(&files, "integrator", scene->groups[i].integrator_file);
        fp3_files_read(&files, "params", scene->groups[i].params_file);
        fp3_files_write(&files, "--bus-log", o->on.bus_log);
        fp3_files_write(&files, "--output", o->record.def.path);
        fp3_files_write(&files, "--plot", o->record.def.plot);
        status = fp3_files_check(&files, error);
    }
    if (!status && fp3_run_record_is_asked(&o->record) && scene->group_count != 1)
        return fp3_fail_at(
            error, FP3_E_ARGUMENT, scene->path, (unsigned)scene->line, 0,
            "--output, --plot: %zu groups have states of their own: record a scene of "
            "one group",
            scene->group_count);
    return status;
}

static fp3_status run_program(options *o, char **report, fp3_error *error) {
    fp3_program_def how = o->how;
    fp3_engine_def def = fp3_engine_default();
    fp3_program *program = NULL;
    if (o->on.port && !o->config) {
        fp3_status status = fp3_engine_find(o->on.port, (uint32_t)o->on.baud, &o->config, error);
        if (status)
            return status;
    }
    def.config = o->config ? o->config : o->is_model ? how.compile.config : def.config;
    how.is_model = o->is_model;
    how.compile.config = def.config;
    how.integrator = o->integrator;
    def.objects = (uint32_t)o->objects;
    fp3_status status = define(o, &def, error);
    status = status ? status : fp3_run_adaptive_maxstep(&how, o->values.params, error);
    status = status ? status : fp3_program_open(o->program, &how, &program, report, error);
    if (!status && !o->has_steps && fp3_adaptive_is(program->image))
        o->steps = FP3_ADAPTIVE_ATTEMPTS;
    if (!status)
        status = run_and_log(o, &(fp3_run_task){.program = program}, &def, error);
    fp3_program_close(&program);
    return status;
}

/* Where the options say nothing, the scene does. */
static fp3_status run_scene(options *o, fp3_error *error) {
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

int fp3_cmd_run(int argc, char **argv) {
    options o = {.steps = 1, .how = fp3_program_default(), .record.def = fp3_recording_default()};
    const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "PROGRAM\n--scene FILE",
        .doc =
            "Runs PROGRAM (an image, assembly *.s, or a model *.ode, which is compiled): its first "
            "part once, its step part N times, its last part once, for every object. Prints the "
            "final states and what the run cost. A scene has several programs, each for objects of "
            "its own."};
    fp3_error error = {.text = ""};
    fp3_status status = fp3_params_make(&o.values.params, &error);
    if (status)
        return fp3_cli_fail("run", status, &error);
    char *report = NULL;
    fp3_arguments_parse(&argp, argc, argv, &o);
    status = check_files(&o, &error);
    if (!status) {
        o.progress = fp3_progress_begin("run", o.program ? o.program : o.scene);
        fp3_progress_say(o.progress, "reading and compiling");
        status = o.scene ? run_scene(&o, &error) : run_program(&o, &report, &error);
        fp3_progress_end(&o.progress);
    }
    const int exit_code = fp3_cli_end("run", status, &error, report);
    free(report);
    fp3_run_values_free(&o.values);
    fp3_run_record_free(&o.record);
    return exit_code;
}
