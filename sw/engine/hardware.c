/* hardware.c - finds and loads the simulated hardware of a configuration. */
#include "hardware.h"

#include "install.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DIRS 3

typedef struct {
    char dir[DIRS][PATH_MAX];
    size_t count;
} dirs;

/* Each place once. */
static void add(dirs *p, const char *dir) {
    for (size_t i = 0; i < p->count; i++)
        if (strcmp(p->dir[i], dir) == 0)
            return;
    if (snprintf(p->dir[p->count], PATH_MAX, "%s", dir) < PATH_MAX)
        p->count++;
}

/* Adds <the directory of file, up levels above>/below; file is behind all links. */
static void add_beside(dirs *p, const char *file, int up, const char *below) {
    char dir[2 * PATH_MAX];
    snprintf(dir, PATH_MAX, "%s", file);
    for (; up >= 0; up--) {
        char *slash = strrchr(dir, '/');
        if (!slash)
            return;
        *slash = '\0';
    }
    snprintf(dir + strlen(dir), PATH_MAX, "/%s", below);
    add(p, dir);
}

static void list_dirs(dirs *p) {
    const char *chosen = secure_getenv("FP3_RTL_DIR");
    char program[PATH_MAX] = "", path[PATH_MAX] = "";
    Dl_info own;
    p->count = 0;
    if (chosen && *chosen) {
        add(p, chosen);
        return;
    }
    const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    /* Beside libfp3.so. In a program that links libfp3.a this is the program, or a name without a slash:
     * the working directory is nobody's place for code. */
    if (dladdr(fp3_install_rtl_dir, &own) && strchr(own.dli_fname, '/') &&
        realpath(own.dli_fname, path) && strcmp(path, program) != 0)
        add_beside(p, path, 0, "fp3");
    if (*program)
        add_beside(p, program, 1, "lib/fp3");
    add(p, fp3_install_rtl_dir);
}

static fp3_status not_found(const dirs *p, const char *config, fp3_error *error) {
    char dirs[sizeof error->text] = "";
    for (size_t i = 0; i < p->count; i++) {
        strncat(dirs, i ? ", " : "", sizeof dirs - strlen(dirs) - 1);
        strncat(dirs, p->dir[i], sizeof dirs - strlen(dirs) - 1);
    }
    return fp3_fail(error, FP3_E_SYSTEM,
                    "no simulated hardware fp3_%s.so for the rtl engine (make install puts it in "
                    "place; FP3_RTL_DIR names another directory); looked in %s",
                    config, dirs);
}

static fp3_status check(const char *path, const char *config, const fp3_rtl_ops *ops,
                        fp3_error *error) {
    if (ops->version != FP3_RTL_VERSION || ops->size != sizeof *ops)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "%s: interface %u of %u bytes, this libfp3 wants %u of %zu: both must come "
                        "from one build",
                        path, (unsigned)ops->version, (unsigned)ops->size, FP3_RTL_VERSION,
                        sizeof *ops);
    if (strcmp(ops->config, config) != 0)
        return fp3_fail(error, FP3_E_SYSTEM, "%s: has configuration '%s'", path, ops->config);
    return FP3_OK;
}

/* RTLD_NODELETE: Verilator's run time leaves destructors behind that run when a thread ends. */
static fp3_status load(const char *path, const char *config, fp3_hardware *hardware,
                       fp3_error *error) {
    hardware->library = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!hardware->library)
        return fp3_fail(error, FP3_E_SYSTEM, "%s", dlerror());
    hardware->ops = dlsym(hardware->library, "fp3_rtl_table");
    fp3_status status = hardware->ops
                            ? check(path, config, hardware->ops, error)
                            : fp3_fail(error, FP3_E_SYSTEM, "%s: no hardware of FP3's", path);
    if (status)
        fp3_hardware_unload(hardware);
    return status;
}

fp3_status fp3_hardware_load(const char *config, fp3_hardware *hardware, fp3_error *error) {
    dirs p;
    *hardware = (fp3_hardware){0};
    list_dirs(&p);
    for (size_t i = 0; i < p.count; i++) {
        char path[PATH_MAX + 64];
        snprintf(path, sizeof path, "%s/fp3_%s.so", p.dir[i], config);
        if (access(path, F_OK) == 0)
            return load(path, config, hardware, error);
    }
    return not_found(&p, config, error);
}

void fp3_hardware_unload(fp3_hardware *hardware) {
    if (hardware->library)
        dlclose(hardware->library);
    *hardware = (fp3_hardware){0};
}
