/* SPDX-License-Identifier: Apache-2.0 */
/* run_options.c - see run_options.h. */
#include "run_options.h"

#include "arguments.h"
#include "run_adaptive.h"

#include "record/format.h"

#include <string.h>

/* What belongs to an image, and what to a scene. */
static void check(fp3_run_options *o, struct argp_state *state) {
    if (!o->program && !o->scene)
        argp_error(state, "expected a program, or --scene FILE");
    const char *dot = o->program ? strrchr(o->program, '.') : NULL;
    if (dot && !strcmp(dot, ".scene"))
        argp_error(state, "found '%s', expected --scene %s", o->program, o->program);
    if (o->program && o->scene)
        argp_error(state, "--scene: found '%s', but the scene names its programs", o->program);
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
    if (o->scene && o->link_count)
        argp_error(state, "--scene: links are in the scene, not in --links");
    if (o->scene && o->on.kanata)
        argp_error(state, "--kanata: expected one program, not a scene");
    fp3_run_engine_check(&o->on, state);
    if (fp3_run_record_is_asked(&o->record) && o->on.cycle_limit)
        argp_error(state, "--cycle-limit: a limit applies to one run, and --output, --plot, "
                          "--checkpoint and --restart split the run");
    fp3_run_record_check(&o->record, state);
    if (o->check.is_asked && !o->is_model && !o->scene)
        argp_error(state, "--check: expected a model (*.ode, or --model); how an image or "
                          "assembly uses the step is unknown");
    if (o->check.has_bound && !o->check.is_asked)
        argp_error(state, "--strict=TOL: expected --check, too; TOL is the limit of its "
                          "estimates");
}

/* They are read when it is known how many objects there are. */
static void add_links(fp3_run_options *o, const char *text, struct argp_state *state) {
    const char *equals = strchr(text, '=');
    if (!equals)
        argp_error(state, "--links: found '%s', expected NAME=FILE", text);
    if (o->link_count == FP3_RELATIONS_MAX)
        argp_error(state, "--links: expected at most %d", FP3_RELATIONS_MAX);
    fp3_files_read(&o->files, "--links", equals + 1);
    o->links[o->link_count++] = text;
}

static void take_tolerance(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    fp3_run_adaptive_tolerance(&o->how, state, text);
}

static void take_until(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    fp3_run_adaptive_until(&o->how, state, text);
}

static void take_compensated(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    (void)text;
    fp3_arguments_arithmetic(state, &o->how.compile, FP3_COMPENSATED);
}

static void take_double_single(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    (void)text;
    fp3_arguments_arithmetic(state, &o->how.compile, FP3_DOUBLE_SINGLE);
}

static void take_steps(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    o->steps = fp3_arguments_number(state, "--steps", text, 0, UINT32_MAX);
    o->has_steps = 1;
}

static void take_seed(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    o->on.seed = fp3_arguments_number(state, "--seed", text, 0, UINT32_MAX);
    o->on.has_seed = 1;
}

static void take_params(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    fp3_files_read(&o->files, "--params", text);
    fp3_run_values_load(&o->values, state, text);
}

static void take_set(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    fp3_run_values_set(&o->values, state, text);
}

static void take_spread(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    fp3_run_values_spread(&o->values, state, text);
}

int fp3_run_options_is_number(const char *output) {
    return *output && !output[strspn(output, "0123456789")];
}

static void take_output(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    if (fp3_run_options_is_number(text))
        argp_error(state,
                   "-o, --output: found '%s', expected a file (./%s); the number of objects is "
                   "-N, --objects",
                   text, text);
    o->record.def.path = text;
}

static void take_links(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    add_links(o, text, state);
}

static void take_strict(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    o->check.is_strict = 1;
    o->check.has_bound = text != NULL;
    if (text)
        o->check.bound = fp3_arguments_above_zero(state, "--strict", text);
}

static void take_every(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    fp3_run_record_every(&o->record, state, text);
}

static void take_times(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    fp3_run_record_times(&o->record, state, text);
}

static void take_observe(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    fp3_run_record_observe(&o->record, state, text);
}

static void take_checkpoint_every(void *user, struct argp_state *state, char *text) {
    fp3_run_options *o = user;
    fp3_run_record_checkpoint_every(&o->record, state, text);
}

static void end(void *user, struct argp_state *state) {
    fp3_run_options *o = user;
    o->is_model = o->is_model || (o->program && fp3_program_is_model(o->program));
    check(o, state);
    if (o->how.is_adaptive && fp3_run_record_has_snapshots(&o->record))
        fp3_run_adaptive_record(&o->how, &o->record.def, state);
}

static const fp3_option table[] = {
    {"config", 'c', "NAME",
     "Configuration (default: single, for a model single_full, world if objects see each other; "
     "with --port that of the board)",
     FP3_TEXT(fp3_run_options, config), .forms = FP3_RUN_DECIDES},
    {"model", 0, NULL, "PROGRAM is a model, whatever its name", FP3_FLAG(fp3_run_options, is_model),
     .forms = FP3_RUN_DECIDES},
    {"integrator", 'i', "NAME",
     "Of a model: a built-in table, or a file (default: " FP3_FIXED_INTEGRATOR ", with "
     "--tolerance " FP3_ADAPTIVE_INTEGRATOR ")",
     FP3_TEXT(fp3_run_options, integrator), .forms = FP3_RUN_DECIDES},
    {"tolerance", 0, "TOL",
     "Of a model: each object chooses its own steps, each with an error of about TOL",
     FP3_CALL(take_tolerance), .forms = FP3_RUN_DECIDES},
    {"until", 0, "TIME",
     "Of a model: the time at which objects end (default: its span). Without --tolerance: fixed "
     "steps, cut at "
     "events",
     FP3_CALL(take_until), .forms = FP3_RUN_DECIDES},
    {"compensated", 'k', NULL,
     "Of a model: carry rounding errors of updates to the next step "
     "(Kahan)",
     FP3_CALL(take_compensated), .forms = FP3_RUN_DECIDES},
    {"double-single", 0, NULL,
     "Of a model: states and all arithmetic as sums of two floats, 48 bits",
     FP3_CALL(take_double_single), .forms = FP3_RUN_DECIDES},
    {"engine", 'e', "ENGINE",
     "rtl, the hardware under Verilator (default), isa, an instruction-set simulator in C, "
     "fast, native code for many objects, which counts no cycles (default if objects see each "
     "other), or board, "
     "hardware behind --port. Of bodies: isa, fast or rtl, which execute the laws of contacts "
     "(default: they are built in)",
     FP3_TEXT(fp3_run_options, on.engine), .forms = FP3_RUN_DECIDES},
    {"port", 0, "DEV",
     "With --engine board: its serial port, as /dev/ttyUSB0, or the name that fp3 board prints; "
     "with several ranks all ports, with commas between them",
     FP3_TEXT(fp3_run_options, on.port), .forms = FP3_RUN_BESIDE},
    {"baud", 0, "N", "With --engine board: the rate of the port, 9600 to 3000000 (default: 115200)",
     FP3_NUMBER(fp3_run_options, on.baud, 1, UINT32_MAX), .forms = FP3_RUN_BESIDE},
    {"threads", 0, "N",
     "Of engine fast, and of bodies without an engine (default: one for each processor)",
     FP3_NUMBER(fp3_run_options, on.threads, 1, 1024), .forms = FP3_RUN_BESIDE},
    {"native", 0, "FILE", "Of engine fast: the code of fp3 compile --native",
     FP3_TEXT(fp3_run_options, on.native), .forms = FP3_RUN_BESIDE},
    {"steps", 'n', "N",
     "Number of steps (default: 1; with --times up to the last time; with --tolerance 1000000 "
     "attempts at most)",
     FP3_CALL(take_steps), .forms = FP3_RUN_DECIDES},
    {"objects", 'N', "N",
     "Number of objects (default: one for each context; with --links the number of linked objects)",
     FP3_NUMBER(fp3_run_options, objects, 1, UINT32_MAX), .forms = FP3_RUN_DECIDES},
    {"visit", 0, "N", "Steps per visit of an object (default: all)",
     FP3_NUMBER(fp3_run_options, on.visit, 1, UINT32_MAX), .forms = FP3_RUN_DECIDES},
    {"seed", 0, "N",
     "With a configuration whose records have 16 bits: stores round at random, by draws from N "
     "(default: 0, to nearest)",
     FP3_CALL(take_seed), .forms = FP3_RUN_DECIDES},
    {"all", 0, NULL, "Print the states of all objects, not of the first 8",
     FP3_FLAG(fp3_run_options, all), .forms = FP3_RUN_BESIDE},
    {"params", 0, "FILE", "Values of states, parameters and shared constants; may be repeated",
     FP3_CALL(take_params), .is_repeated = 1, .forms = FP3_RUN_DECIDES},
    {"set", 's', "NAME=VALUE", "One value; replaces earlier values; may be repeated",
     FP3_CALL(take_set), .is_repeated = 1, .forms = FP3_RUN_DECIDES},
    {"spread", 0, "NAME=FIRST:LAST",
     "Values from FIRST, of the first object, to LAST, of the last, evenly; may be repeated",
     FP3_CALL(take_spread), .is_repeated = 1, .forms = FP3_RUN_DECIDES},
    {"links", 0, "NAME=FILE",
     "Links of a model's relation NAME, or the list NAME of a program: a CSV file with the columns "
     "a, b (objects, "
     "from 0) and fields; may be repeated",
     FP3_CALL(take_links), .is_repeated = 1, .forms = FP3_RUN_DECIDES},
    {"scene", 0, "FILE",
     "Run the objects, programs and values of FILE instead of a PROGRAM; --config, --engine, "
     "--steps, --visit and --seed replace its settings. FILE may be a scene of rigid bodies",
     FP3_TEXT(fp3_run_options, scene), .forms = FP3_RUN_DECIDES},
    {"clock", 0, "FREQUENCY",
     "Also print how long the run takes at this clock, as 130MHz; units: Hz, kHz, MHz, GHz",
     FP3_FREQUENCY(fp3_run_options, on.clock), .forms = FP3_RUN_BESIDE},
    {"allow-failures", 0, NULL,
     "End with exit code 0, not 3, if objects failed: an instruction raised invalid or "
     "overflow, or a state is NaN or infinite in the end",
     FP3_FLAG(fp3_run_options, allows_failures), .forms = FP3_RUN_BESIDE},
    {"check", 0, NULL,
     "Of models: run again with h/2 and twice the steps, or with a tenth of the tolerance, in "
     "double-single where that compiles, and print an estimate of the error beside each final "
     "state, and how invariants of the model have changed",
     FP3_FLAG(fp3_run_options, check.is_asked), .forms = FP3_RUN_BESIDE},
    {"strict", 0, "TOL",
     "End with exit code 3 after a warning about digits that FP32 loses, and with --check where an "
     "estimate is above TOL, relative to the size of the state, or the change of an invariant of "
     "all "
     "objects, relative to the size of its terms (default: 1e-3)",
     FP3_CALL(take_strict), .is_optional = 1, .forms = FP3_RUN_BESIDE},
    {"output", 'o', "FILE",
     "Write observed values to FILE: " FP3_FORMATS ", a row for each object of each snapshot",
     FP3_CALL(take_output), .forms = FP3_RUN_BESIDE},
    {"group", 0, "NAME",
     "With --output or --plot of a --scene of several groups: record the objects of this group; of "
     "a scene of bodies: the bodies of this name",
     FP3_TEXT(fp3_run_options, group), .forms = FP3_RUN_BESIDE},
    {"contacts", 0, "FILE",
     "Of a --scene of bodies: write contacts that began, ended and hit to FILE, as CSV",
     FP3_TEXT(fp3_run_options, contacts), .forms = FP3_RUN_BESIDE},
    {"compress", 0, NULL, "With --output: compress HDF5",
     FP3_FLAG(fp3_run_options, record.def.is_compressed), .forms = FP3_RUN_BESIDE},
    {"plot", 0, "FILE",
     "Draw observed values over time, and one state against another, into FILE (.svg or .png); "
     "of more than 8 objects 8 are drawn. Needs gnuplot",
     FP3_TEXT(fp3_run_options, record.def.plot), .forms = FP3_RUN_BESIDE},
    {"every", 0, "N",
     "With --output or --plot: a snapshot after every N steps, at the start and at the end "
     "(default: "
     "at these two; of a plot some 1000)",
     FP3_CALL(take_every), .forms = FP3_RUN_BESIDE},
    {"times", 0, "T1,T2,...",
     "With --output or --plot: snapshots only at these times, measured from the start of the "
     "run, whole multiples of h in its unit",
     FP3_CALL(take_times), .forms = FP3_RUN_BESIDE},
    {"observe", 0, "NAMES",
     "With --output or --plot: states, and of a model definitions and invariants, with commas "
     "between them; of bodies x, angle, v, w, at_rest (default), force, torque, mass, inertia and, "
     "in HDF5, contacts; may be repeated (default: all states)",
     FP3_CALL(take_observe), .is_repeated = 1, .forms = FP3_RUN_BESIDE},
    {"checkpoint", 0, "FILE",
     "Write the state of all objects to FILE at the end, for --restart; the file before stays as "
     "FILE.1",
     FP3_TEXT(fp3_run_options, record.def.checkpoint), .forms = FP3_RUN_BESIDE},
    {"checkpoint-every", 0, "N", "With --checkpoint: also after every N steps",
     FP3_CALL(take_checkpoint_every), .forms = FP3_RUN_BESIDE},
    {"restart", 0, "FILE",
     "Go on from the checkpoint FILE of this same run, on any engine; --steps counts from the "
     "start of "
     "the run",
     FP3_TEXT(fp3_run_options, record.def.restart), .forms = FP3_RUN_BESIDE},
    {"cycle-limit", 0, "N", "Stop after N clock cycles, with exit code 1 (default: none)",
     FP3_NUMBER(fp3_run_options, on.cycle_limit, 0, UINT64_MAX), .forms = FP3_RUN_BESIDE},
    {"bus-log", 0, "FILE", "Write every transfer on the bus to FILE",
     FP3_TEXT(fp3_run_options, on.bus_log), .forms = FP3_RUN_BESIDE},
    {"bus-waits", 0, "SEED",
     "Let each channel of the bus wait 0 to 3 cycles in each transfer, at random from SEED",
     FP3_NUMBER(fp3_run_options, on.bus_waits, 1, UINT64_MAX), .forms = FP3_RUN_BESIDE},
    {"kanata", 0, "FILE", "Write the pipeline's log to FILE, for the viewer Konata",
     FP3_TEXT(fp3_run_options, on.kanata), .forms = FP3_RUN_BESIDE},
    {0},
};

const fp3_option *fp3_run_options_table(void) { return table; }

fp3_status fp3_run_options_parse(int argc, char **argv, fp3_run_options *o, fp3_error *error) {
    const fp3_command command = {
        .options = table,
        FP3_WORD(fp3_run_options, program, "program"),
        .end = end,
        .forms = "PROGRAM\n--scene FILE",
        .doc =
            "Runs PROGRAM (an image, assembly *.s, or a model *.ode, which is compiled): its "
            "first part once, its step part N times, its last part once, for every object. "
            "Prints the final states and the cost of the run. A scene has several programs, each "
            "for objects of its own."};
    *o = (fp3_run_options){.steps = 1,
                           .how = fp3_program_default(),
                           .record.def = fp3_recording_default(),
                           .check.bound = FP3_RUN_BOUND};
    const fp3_status status = fp3_params_make(&o->values.params, error);
    if (!status)
        fp3_arguments_parse(&command, argc, argv, o);
    return status;
}

void fp3_run_options_free(fp3_run_options *o) {
    fp3_run_values_free(&o->values);
    fp3_run_record_free(&o->record);
}
