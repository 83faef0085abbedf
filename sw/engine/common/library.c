/* SPDX-License-Identifier: Apache-2.0 */
/* library.c - see library.h. */
#include "library.h"

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
    /* Beside libfp3.so. In a program that links libfp3.a this is the program, or a name without a
     * slash: the working directory is no place for code. */
    if (dladdr(fp3_install_rtl_dir, &own) && strchr(own.dli_fname, '/') &&
        realpath(own.dli_fname, path) && strcmp(path, program) != 0)
        add_beside(p, path, 0, "fp3");
    if (*program)
        add_beside(p, program, 1, "lib/fp3");
    add(p, fp3_install_rtl_dir);
}

static fp3_status not_found(const dirs *p, const char *name, const char *what, fp3_error *error) {
    char dirs[sizeof error->text] = "";
    for (size_t i = 0; i < p->count; i++) {
        strncat(dirs, i ? ", " : "", sizeof dirs - strlen(dirs) - 1);
        strncat(dirs, p->dir[i], sizeof dirs - strlen(dirs) - 1);
    }
    return fp3_fail(error, FP3_E_SYSTEM,
                    "no %s, %s (make install and Debian's package libfp3-plugins install the usual "
                    "ones, make all builds all; FP3_RTL_DIR names another directory); looked in %s",
                    what, name, dirs);
}

/* The file in the first place that has it, or "". */
static void find(const dirs *p, const char *name, char found[PATH_MAX + 64]) {
    *found = '\0';
    for (size_t i = 0; !*found && i < p->count; i++) {
        snprintf(found, PATH_MAX + 64, "%s/%s", p->dir[i], name);
        if (access(found, F_OK) != 0)
            *found = '\0';
    }
}

int fp3_library_is_there(const char *name) {
    dirs p;
    char found[PATH_MAX + 64];
    list_dirs(&p);
    find(&p, name, found);
    return *found != '\0';
}

/* RTLD_NODELETE: Verilator's run time leaves destructors behind that run when a thread ends. */
fp3_status fp3_library_load(const char *name, const char *what, void **library, char **path,
                            fp3_error *error) {
    dirs p;
    char found[PATH_MAX + 64];
    *library = NULL;
    list_dirs(&p);
    find(&p, name, found);
    if (!*found)
        return not_found(&p, name, what, error);
    if (path && !(*path = strdup(found)))
        return fp3_no_memory(error);
    *library = dlopen(found, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    return *library ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "%s", dlerror());
}

const void *fp3_library_symbol(void *library, const char *symbol) { return dlsym(library, symbol); }

void fp3_library_unload(void *library) {
    if (library)
        dlclose(library);
}
