/* SPDX-License-Identifier: Apache-2.0 */
/* absent.c - what WebAssembly has not: other programs, libraries that are loaded, native code,
 * serial ports. Who asks for one of them hears that.
 */
#include "cli/cli.h"
#include "cli/run_ranks.h"
#include "engine/board/port.h"
#include "engine/common/library.h"
#include "engine/fast/native.h"
#include "record/plot.h"

#define HERE "WebAssembly"

/* The hardware under Verilator, and the writer of HDF5. */
fp3_status fp3_library_load(const char *name, const char *what, void **library, char **path,
                            fp3_error *error) {
    (void)path;
    *library = NULL;
    return fp3_fail(error, FP3_E_SYSTEM, "no %s, %s: " HERE " loads no libraries", what, name);
}

const void *fp3_library_symbol(void *library, const char *symbol) {
    (void)library, (void)symbol;
    return NULL;
}

void fp3_library_unload(void *library) { (void)library; }

fp3_status fp3_port_open(const char *name, uint32_t baud, fp3_port *port, fp3_error *error) {
    (void)baud, (void)port;
    return fp3_fail(error, FP3_E_SYSTEM, "port %s: " HERE " has no serial ports", name);
}

void fp3_port_close(fp3_port *port) { (void)port; }

int64_t fp3_port_now(void) { return 0; }

fp3_status fp3_port_write(fp3_port *port, const uint8_t *bytes, size_t size, int64_t until) {
    (void)bytes, (void)size, (void)until;
    return fp3_port_open(port->name, 0, port, port->error);
}

fp3_status fp3_port_read(fp3_port *port, uint8_t *bytes, size_t room, int64_t until, size_t *size) {
    (void)bytes, (void)room, (void)until, (void)size;
    return fp3_port_open(port->name, 0, port, port->error);
}

fp3_status fp3_plot_open(const fp3_subject *subject, fp3_sink **sink, fp3_error *error) {
    *sink = NULL;
    return fp3_fail(error, FP3_E_SYSTEM, "%s: " HERE " cannot start gnuplot", subject->path);
}

static fp3_status no_native(fp3_error *error) {
    return fp3_fail(error, FP3_E_SYSTEM, HERE " neither makes nor loads native code");
}

fp3_status fp3_fast_native_open(const fp3_fast_plan *plan, const char *kind, int may_compile,
                                fp3_fast_native *native, fp3_error *error) {
    (void)plan, (void)kind, (void)may_compile;
    *native = (fp3_fast_native){0};
    return no_native(error);
}

fp3_status fp3_fast_native_write(const fp3_fast_plan *plan, const char *path, const char *kind,
                                 fp3_error *error) {
    (void)plan, (void)path, (void)kind;
    return no_native(error);
}

fp3_status fp3_fast_native_kind(const char *path, fp3_fast_kind *kind, fp3_error *error) {
    (void)path, (void)kind;
    return no_native(error);
}

fp3_status fp3_fast_native_load(const fp3_fast_plan *plan, const char *path, const char *kind,
                                fp3_fast_native *native, fp3_error *error) {
    return (void)path, fp3_fast_native_open(plan, kind, 0, native, error);
}

void fp3_fast_native_close(fp3_fast_native *native) { (void)native; }

/* One process. */
void fp3_run_ranks_first(fp3_run_ranks *ranks) {
    *ranks = (fp3_run_ranks){.is_one = 1, .speaks = -1};
}

fp3_status fp3_run_ranks_begin(fp3_run_ranks *ranks, fp3_error *error) {
    (void)ranks, (void)error;
    return FP3_OK;
}

fp3_status fp3_run_ranks_agree(const fp3_run_ranks *ranks, const fp3_option *table, int argc,
                               char *const *argv, const char *const *own, fp3_error *error) {
    (void)ranks, (void)table, (void)argc, (void)argv, (void)own, (void)error;
    return FP3_OK;
}

fp3_status fp3_run_ranks_port(fp3_run_ranks *ranks, fp3_run_engine *on, fp3_error *error) {
    (void)ranks, (void)on, (void)error;
    return FP3_OK;
}

void fp3_run_ranks_print(fp3_engine *engine) { (void)engine; }

int fp3_run_ranks_end(fp3_run_ranks *ranks, const char *command, fp3_status status,
                      const fp3_error *error) {
    (void)ranks, (void)command, (void)status, (void)error;
    return 0;
}

fp3_status fp3_ranks_open(fp3_ranks *ranks, fp3_error *error) {
    *ranks = (fp3_ranks){0};
    return fp3_fail(error, FP3_E_SYSTEM, HERE " has one process");
}

fp3_status fp3_engine_open_ranks(const fp3_engine_def *def, const fp3_ranks *ranks,
                                 fp3_engine **engine) {
    (void)ranks;
    return fp3_engine_open(def, engine);
}

/* ---- commands that start compilers, load hardware or hold a truth of GSL beside a run ---- */

static int no_command(const char *name) {
    fp3_error error;
    return fp3_cli_fail(name, fp3_fail(&error, FP3_E_SYSTEM, "not in " HERE), &error);
}

#define ABSENT(name)                                                                               \
    int fp3_cmd_##name(int argc, char **argv) {                                                    \
        (void)argc, (void)argv;                                                                    \
        return no_command(#name);                                                                  \
    }
ABSENT(compare)
ABSENT(view)
ABSENT(tune)
ABSENT(bench)
ABSENT(stress)
ABSENT(board)
ABSENT(doctor)
