/* SPDX-License-Identifier: Apache-2.0 */
/* main.c - the command fp3: finds the subcommand and hands it the rest of the line. */
#include "cli.h"

#include "base/nearest.h"
#include "base/temporary.h"

#include <argp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* X(name, what it does) */
#define COMMANDS(X)                                                                                \
    X(asm, "Assemble a program into an image")                                                     \
    X(compile, "Compile a model and an integrator into a program")                                 \
    X(compare, "Compare integrators on a model")                                                   \
    X(dis, "Disassemble an image, or one instruction word")                                        \
    X(run, "Run an image on an engine")                                                            \
    X(verify, "Run a part of a recorded run again, and compare hashes")                            \
    X(view, "Show a recording as a web page that plays it, or as pictures")                        \
    X(tune, "Find the cheapest way to integrate a model to a tolerance")                           \
    X(bench, "Measure the ship, or another program, on the hardware")                              \
    X(stress, "Judge what FP32 does to integrators and models")                                    \
    X(board, "Simulate a board with a serial port, for the engine board")                          \
    X(info, "Print what an image needs, or what this build has")                                   \
    X(doctor, "Check which optional tools and libraries this machine has")

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
} commands[] = {
#define ROW(name, doc) {#name, fp3_cmd_##name},
    COMMANDS(ROW)
#undef ROW
};
enum { COUNT = sizeof commands / sizeof *commands };

#define LINE(name, doc) "  " #name "\t" doc "\n"
#define LINES COMMANDS(LINE)
static const char text[] =
    "Programs for FP3, a processor for equations of motion.\v"
    "Commands:\n" LINES "\n"
    "'fp3 COMMAND --help' lists a command's options.\n"
    "Exit codes: 0 success, 1 failed, 2 bad input or usage, 3 objects failed in a run\n"
    "(an instruction raised invalid or overflow, or a state is NaN or infinite in\n"
    "the end), or there is no truth to measure errors against, or a result of stress\n"
    "does not hold; with 3 all outputs are there.\n"
    "A file named - is standard input, or standard output.\n"
    "Environment: FP3_RTL_DIR is the directory of the simulated hardware, if "
    "it is not where it was installed.";

static error_t parse(int key, char *argument, struct argp_state *state) {
    int *at = state->input;
    if (key == ARGP_KEY_ARG) {
        *at = state->next - 1;
        state->next = state->argc; /* the rest is the subcommand's */
        return 0;
    }
    (void)argument;
    if (key == ARGP_KEY_NO_ARGS)
        argp_usage(state);
    return ARGP_ERR_UNKNOWN;
}

/* However a command ends, --help included: what was printed has arrived, or the exit code is 1. */
static void check_standard_output(void) {
    if (!fflush(stdout) && !ferror(stdout))
        return;
    fprintf(stderr, "fp3: cannot write the output\n");
    _exit(1);
}

/* What would be left of outputs is removed; then the signal does what it would have done. */
static void end(int number) {
    fp3_temporary_remove_all();
    signal(number, SIG_DFL);
    raise(number);
}

static void catch_signals(void) {
    static const int numbers[] = {SIGHUP, SIGINT, SIGPIPE, SIGTERM};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (signal(numbers[i], end) == SIG_IGN) /* as nohup has it */
            signal(numbers[i], SIG_IGN);
    signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is a write that fails, with a message */
}

int main(int argc, char **argv) {
    static char name[64];
    static const struct argp argp = {
        .parser = parse, .args_doc = "COMMAND [ARGUMENT...]", .doc = text};
    argp_program_version = "fp3 " FP3_VERSION;
    argp_err_exit_status = 2;
    int at = 0;
    atexit(check_standard_output);
    catch_signals();
    if (argp_parse(&argp, argc, argv, ARGP_IN_ORDER, NULL, &at))
        return 1;
    for (int i = 0; i < COUNT; i++) {
        if (strcmp(argv[at], commands[i].name))
            continue;
        snprintf(name, sizeof name, "fp3 %s", commands[i].name);
        argv[at] = name;
        return commands[i].run(argc - at, argv + at);
    }
    const char *best = NULL;
    const fp3_token wanted = {.text = argv[at], .length = strlen(argv[at])};
    for (int i = 0; i < COUNT; i++)
        fp3_nearest(wanted, commands[i].name, &best);
    fprintf(stderr, "fp3: found '%s', expected a command:", argv[at]);
    for (int i = 0; i < COUNT; i++)
        fprintf(stderr, " %s", commands[i].name);
    fprintf(stderr, best ? "; did you mean %s?\n" : "\n", best);
    return 2;
}
