/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_doctor.c - fp3 doctor: what this machine has of all that the command can use. Nothing is
 * looked up by its name: each part is tried. */
#include "arguments.h"
#include "base/cc.h"
#include "base/threads.h"
#include "cli.h"
#include "engine/board/hardware.h"
#include "engine/common/library.h"
#include "engine/fast/cache.h"
#include "machine/config.h"
#include "processor.h"
#include "record/gnuplot.h"
#include "record/library_hdf5.h"
#include "view/video.h"

#include <dirent.h>
#include <fp3/engine.h>
#include <fp3/image.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* What a check found: status, and what to print of it. error has the reason of a failure. */
typedef struct {
    char text[PATH_MAX + 64];
    fp3_error error;
} finding;

/* A program of one instruction, as engine fast executes it. */
static fp3_status check_fast(finding *f) {
    static const char text[] = ".state x\nstep:\nadd x, x, x\n";
    fp3_assembly *made = NULL;
    fp3_engine *engine = NULL;
    fp3_engine_def def = fp3_engine_default();
    def.engine = "fast";
    def.config = "many";
    def.error = &f->error;
    fp3_status status = fp3_assemble(text, strlen(text), "doctor.s", &made, &f->error);
    if (!status)
        status = fp3_engine_open(&def, &engine);
    if (!status)
        status = fp3_engine_load(engine, made->image);
    if (!status) {
        const char *how = fp3_engine_how(engine);
        snprintf(f->text, sizeof f->text, "%s", how);
        if (strncmp(how, "native", 6) != 0)
            status = fp3_fail(&f->error, FP3_E_SYSTEM, "%s", how);
    }
    fp3_engine_close(&engine);
    fp3_assembly_free(&made);
    return status;
}

static fp3_status check_compiler(finding *f) {
    static const char *const options[] = {"-S", NULL};
    snprintf(f->text, sizeof f->text, "%s", fp3_cc());
    return fp3_cc_compile("int fp3_doctor(void);\nint fp3_doctor(void) { return 0; }\n", options,
                          "/dev/null", 0, &f->error);
}

static fp3_status check_cache(finding *f) {
    fp3_cache cache;
    unsigned programs = 0;
    double bytes = 0;
    const fp3_status status = fp3_cache_find("", &cache, &f->error);
    DIR *directory = status ? NULL : opendir(cache.directory);
    for (struct dirent *one; directory && (one = readdir(directory));) {
        struct stat is;
        const char *ending = strrchr(one->d_name, '.');
        if (!ending || strcmp(ending, ".so") != 0 ||
            fstatat(dirfd(directory), one->d_name, &is, 0) != 0)
            continue;
        programs++;
        bytes += (double)is.st_size;
    }
    if (directory)
        closedir(directory);
    snprintf(f->text, sizeof f->text, "%s: %u program%s, %.0f kB", cache.directory, programs,
             programs == 1 ? "" : "s", bytes / 1e3);
    return status;
}

/* The configurations that are installed, and others that are built; or the reason of the first
 * that does not load. */
static fp3_status check_hardware(finding *f) {
    unsigned loaded = 0, wanted = 0;
    fp3_status first = FP3_OK;
    for (uint32_t i = 0; i < fp3_config_count; i++) {
        fp3_hardware hardware;
        fp3_error error;
        if (!fp3_configs[i].take && !fp3_hardware_is_there(fp3_configs[i].name))
            continue;
        wanted++;
        const fp3_status status = fp3_hardware_load(fp3_configs[i].name, &hardware, &error);
        if (status && !first)
            f->error = error;
        first = first ? first : status;
        loaded += !status;
        fp3_hardware_unload(&hardware);
    }
    snprintf(f->text, sizeof f->text, "%u of %u configurations", loaded, wanted);
    return first;
}

static fp3_status check_hdf5(finding *f) {
    const fp3_hdf5_ops *calls;
    return fp3_library_hdf5(&calls, &f->error);
}

/* Loaded, not started: outside mpirun MPI would take long. */
static fp3_status check_mpi(finding *f) {
    void *library = NULL;
    return fp3_library_load("fp3_mpi.so", "library for clusters", &library, NULL, &f->error);
}

static fp3_status check_gnuplot(finding *f) { return fp3_gnuplot_check(&f->error); }

static fp3_status check_ffmpeg(finding *f) { return fp3_view_video_check(2, 2, &f->error); }

static const struct {
    const char *name, *use;
    const char *remedy; /* where the error does not say it */
    fp3_status (*check)(finding *f);
} checks[] = {
    {"engine fast", "native code; programs are interpreted without it", "", check_fast},
    {"C compiler", "native code, and the loops in C of fp3 bench",
     "; Debian's package gcc, or FP3_CC=COMPILER", check_compiler},
    {"cache", "native code that is compiled once, not by each process",
     "; FP3_CACHE_DIR=DIRECTORY names a cache that only you can write to", check_cache},
    {"engine rtl", "the simulated hardware", "", check_hardware},
    {"HDF5", "--output FILE.h5, and fp3 view of such a file", "", check_hdf5},
    {"MPI", "mpirun -n 2 fp3 run",
     "; make setup-cluster all installs an MPI and Scotch, and compiles the library", check_mpi},
    {"gnuplot", "--plot", "", check_gnuplot},
    {"ffmpeg", "fp3 view --film FILE.mp4", "", check_ffmpeg},
};
enum { CHECKS = sizeof checks / sizeof *checks };

static int print_checks(void) {
    int missing = 0;
    for (int i = 0; i < CHECKS; i++) {
        finding f = {.text = "yes"};
        if (!checks[i].check(&f)) {
            fp3_cli_line(stdout, "%-12s %s", checks[i].name, f.text);
            continue;
        }
        missing++;
        fp3_cli_line(stdout, "%-12s MISSING (%s): %s%s", checks[i].name, checks[i].use,
                     f.error.text, checks[i].remedy);
    }
    return missing;
}

int fp3_cmd_doctor(int argc, char **argv) {
    static const fp3_command command = {
        .doc = "Tries the optional tools and libraries of this machine: the C compiler and the "
               "cache of engine fast, the simulated hardware, HDF5, MPI, gnuplot and ffmpeg. For "
               "each that is missing, prints its purpose and how to get it; the exit code is "
               "then 1. Engine isa needs none of them.",
    };
    char processor[128];
    fp3_arguments_parse(&command, argc, argv, NULL);
    fp3_processor_name(processor, sizeof processor);
    fp3_cli_line(stdout, "%-12s %s", "fp3", FP3_VERSION);
    fp3_cli_line(stdout, "%-12s %s, %u thread%s", "processor", processor, fp3_threads_processors(),
                 fp3_threads_processors() == 1 ? "" : "s");
    const int missing = print_checks();
    if (missing)
        printf("%d of %d are missing\n", missing, CHECKS);
    return missing ? 1 : 0;
}
