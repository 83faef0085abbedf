/* SPDX-License-Identifier: Apache-2.0 */
/* temporary.c - base/temporary.h for WebAssembly, which is one process: a temporary is the
 * beginning of a name, not a folder. */
#include "base/temporary.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

char *fp3_temporary_path(const char *real, const char *inside) {
    const char *name = strrchr(real, '/') + 1;
    char *path = NULL;
    return asprintf(&path, "%.*s.fp3-%s.%s", (int)(name - real), real, name, inside) < 0 ? NULL
                                                                                         : path;
}

static void empty(const char *path) {
    static const char *const inside[] = {FP3_TEMPORARY_NEW, FP3_TEMPORARY_BEFORE};
    char *name = NULL;
    for (size_t i = 0; i < sizeof inside / sizeof *inside; i++) {
        if (asprintf(&name, "%s%s", path, inside[i]) < 0)
            continue;
        unlink(name);
        free(name);
    }
}

int fp3_temporary_open(const char *path, fp3_temporary *temporary) {
    *temporary = (fp3_temporary){strdup(path), -1};
    if (!temporary->path)
        return -1;
    empty(path);
    return 0;
}

void fp3_temporary_close(fp3_temporary *temporary) {
    if (temporary->path)
        empty(temporary->path);
    free(temporary->path);
    *temporary = (fp3_temporary){.folder = -1};
}

void fp3_temporary_remove_all(void) {}
