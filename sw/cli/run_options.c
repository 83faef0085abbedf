/* SPDX-License-Identifier: Apache-2.0 */
/* run_options.c - see run_options.h. */
#include "run_options.h"

#include "arguments.h"
#include "run_adaptive.h"

#include <string.h>

enum {
    KEY_SET = 256,
    KEY_PARAMS,
    KEY_LIMIT,
    KEY_BUS_LOG,
    KEY_BUS_WAITS,
    KEY_PORT,
    KEY_BAUD,
    KEY_VISIT,
    KEY_SEED,
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
    KEY_CHECKPOINT,
    KEY_CHECKPOINT_EVERY,
    KEY_RESTART,
    KEY_THREADS,
    KEY_NATIVE,
    KEY_TOLERANCE,
    KEY_UNTIL,
    KEY_DOUBLE,
    KEY_CHECK,
    KEY_STRICT,
    KEY_LINKS
};

static const struct argp_option table[] = {
    {"config", 'c', "NAME", 0,
     "Configuration (default: single, for a model single_full, world where objects see each other; "
     "with --port that "
     "of the board)",
     0},
    {"model", KEY_MODEL, NULL, 0, "PROGRAM is a model, whatever its name", 0},
    {"integrator", 'i', "NAME", 0,
     "Of a model: a built-in table, or a file (default: " FP3_FIXED_INTEGRATOR ", with "
     "--tolerance " FP3_ADAPTIVE_INTEGRATOR ")",
     0},
    {"tolerance", KEY_TOLERANCE, "TOL", 0,
     "Of a model: each object chooses its own steps, each with an error of about TOL", 0},
    {"until", KEY_UNTIL, "TIME", 0,
     "Of a model: where objects end (default: its span). Without --tolerance: fixed steps, cut at "
     "events",
     0},
    {"compensated", 'k', NULL, 0,
     "Of a model: carry rounding errors of updates to the next step "
     "(Kahan)",
     0},
    {"double-single", KEY_DOUBLE, NULL, 0,
     "Of a model: states and all arithmetic as sums of two floats, 48 bits", 0},
    {"engine", 'e', "ENGINE", 0,
     "rtl, the hardware under Verilator (default), isa, an instruction-set simulator in C, "
     "fast, native code for many objects, which counts no cycles (default where objects see each "
     "other), or board, "
     "hardware behind --port",
     0},
    {"port", KEY_PORT, "DEV", 0,
     "With --engine board: its serial port, as /dev/ttyUSB0, or what fp3 board prints; with "
     "several "
     "ranks the ports of all, with commas between them",
     0},
    {"baud", KEY_BAUD, "N", 0,
     "With --engine board: the rate of the port, 9600 to 3000000 (default: 115200)", 0},
    {"threads", KEY_THREADS, "N", 0, "Of engine fast (default: one for each processor)", 0},
    {"native", KEY_NATIVE, "FILE", 0, "Of engine fast: the code of fp3 compile --native", 0},
    {"steps", 'n', "N", 0,
     "Number of steps (default: 1; with --times up to the last time; with --tolerance 1000000 "
     "attempts at most)",
     0},
    {"objects", 'o', "N", 0,
     "Number of objects (default: one for each context; with --links as many as are linked)", 0},
    {"visit", KEY_VISIT, "N", 0, "Steps per visit of an object (default: all)", 0},
    {"seed", KEY_SEED, "N", 0,
     "With a configuration whose records have 16 bits: stores round at random, by draws from N "
     "(default: to nearest)",
     0},
    {"all", KEY_ALL, NULL, 0, "Print the states of all objects, not of the first 8", 0},
    {"params", KEY_PARAMS, "FILE", 0,
     "Values of states, parameters and shared constants; may be repeated", 0},
    {"set", KEY_SET, "NAME=VALUE", 0, "One value; replaces earlier ones; may be repeated", 0},
    {"spread", KEY_SPREAD, "NAME=FIRST:LAST", 0,
     "Values from FIRST, of the first object, to LAST, of the last, evenly; may be repeated", 0},
    {"links", KEY_LINKS, "NAME=FILE", 0,
     "Links of a model's relation NAME, or the list NAME of a program: a CSV file with the columns "
     "a, b (objects, "
     "from 0) and fields; may be repeated",
     0},
    {"scene", KEY_SCENE, "FILE", 0,
     "Run the objects, programs and values of FILE instead of a PROGRAM; --config, --engine, "
     "--steps, --visit and --seed replace its settings",
     0},
    {"clock", KEY_CLOCK, "FREQUENCY", 0,
     "Also print how long the run takes at this clock, as 130MHz; units: Hz, kHz, MHz, GHz", 0},
    {"allow-failures", KEY_ALLOW, NULL, 0,
     "End with exit code 0, not 3, where objects failed: an instruction raised invalid or "
     "overflow, or a state is NaN or infinite in the end",
     0},
    {"check", KEY_CHECK, NULL, 0,
     "Of models: run again with h/2 and twice the steps, or with a tenth of the tolerance, in "
     "double-single where that compiles, and print an estimate of the error beside each final "
     "state",
     0},
    {"strict", KEY_STRICT, "TOL", OPTION_ARG_OPTIONAL,
     "End with exit code 3 after a warning about digits that FP32 loses, and with --check where an "
     "estimate is above TOL, relative to the size of the state (default: 1e-3)",
     0},
    {"output", KEY_OUTPUT, "FILE", 0,
     "Write observed values to FILE: as HDF5 if its name ends in .h5 or .hdf5, else as CSV, a "
     "row for each object of each snapshot",
     0},
    {"compress", KEY_COMPRESS, NULL, 0, "With --output: compress HDF5", 0},
    {"plot", KEY_PLOT, "FILE", 0,
     "Draw observed values over time, and one state against another, into FILE (.svg or .png); "
     "of more than 8 objects 8 are drawn. Needs gnuplot",
     0},
    {"every", KEY_EVERY, "N", 0,
     "With --output or --plot: a snapshot after every N steps, at the start and at the end "
     "(default: "
     "at these two; of a plot some 1000)",
     0},
    {"times", KEY_TIMES, "T1,T2,...", 0,
     "With --output or --plot: snapshots only at these times, measured from the start of the "
     "run, whole multiples of h in its unit",
     0},
    {"observe", KEY_OBSERVE, "NAMES", 0,
     "With --output or --plot: states, and of a model definitions and invariants, with commas "
     "between them; "
     "may be repeated (default: all states)",
     0},
    {"checkpoint", KEY_CHECKPOINT, "FILE", 0,
     "Write the state of all objects to FILE at the end, for --restart; the file before stays as "
     "FILE.1",
     0},
    {"checkpoint-every", KEY_CHECKPOINT_EVERY, "N", 0,
     "With --checkpoint: also after every N steps", 0},
    {"restart", KEY_RESTART, "FILE", 0,
     "Go on from the checkpoint FILE of this same run, on any engine; --steps counts from the "
     "start of "
     "the run",
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
static void check(fp3_run_options *o, struct argp_state *state) {
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

static error_t parse(int key, char *text, struct argp_state *state) {
    fp3_run_options *o = state->input;
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
    case KEY_SEED:
        o->on.seed = fp3_arguments_number(state, "--seed", text, 1, UINT32_MAX);
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
    case KEY_CHECK:
        o->check.is_asked = 1;
        break;
    case KEY_STRICT:
        o->check.is_strict = 1;
        o->check.has_bound = text != NULL;
        if (text)
            o->check.bound = fp3_arguments_above_zero(state, "--strict", text);
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
    case KEY_CHECKPOINT:
        o->record.def.checkpoint = text;
        break;
    case KEY_CHECKPOINT_EVERY:
        fp3_run_record_checkpoint_every(&o->record, state, text);
        break;
    case KEY_RESTART:
        o->record.def.restart = text;
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
    case KEY_LINKS:
        add_links(o, text, state);
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
        if (o->how.is_adaptive && fp3_run_record_has_snapshots(&o->record))
            fp3_run_adaptive_record(&o->how, &o->record.def, state);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

const struct argp_option *fp3_run_options_table(void) { return table; }

fp3_status fp3_run_options_parse(int argc, char **argv, fp3_run_options *o, fp3_error *error) {
    const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "PROGRAM\n--scene FILE",
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
        fp3_arguments_parse(&argp, argc, argv, o);
    return status;
}

void fp3_run_options_free(fp3_run_options *o) {
    fp3_run_values_free(&o->values);
    fp3_run_record_free(&o->record);
}
