/* SPDX-License-Identifier: Apache-2.0 */
/* cc.c - see cc.h. */
#include "cc.h"

#include "child.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define OPTIONS_MOST 24u
#define SECONDS_MOST 120u

const char *fp3_cc(void) {
    const char *given = secure_getenv("FP3_CC");
    return given && *given ? given : "cc";
}

/* The text as a file without a name, for the compiler's standard input; -1: errno says why. */
static int open_text(const char *text) {
    FILE *file = tmpfile();
    if (!file)
        return -1;
    const int is_written = fputs(text, file) >= 0 && fflush(file) == 0;
    const int fd = is_written ? dup(fileno(file)) : -1;
    fclose(file);
    if (fd >= 0)
        lseek(fd, 0, SEEK_SET);
    return fd;
}

static int start(const char *const *options, int from, const char *path, int is_told,
                 fp3_child *child) {
    const char *const rest[] = {"-o", path, "-x", "c", "-", NULL};
    char *line[1 + OPTIONS_MOST + sizeof rest / sizeof *rest];
    size_t count = 0;
    line[count++] = (char *)(uintptr_t)fp3_cc(); /* posix_spawnp changes no argument */
    for (; *options; options++) {
        if (count > OPTIONS_MOST)
            return E2BIG;
        line[count++] = (char *)(uintptr_t)*options;
    }
    for (size_t i = 0; i < sizeof rest / sizeof *rest; i++)
        line[count++] = (char *)(uintptr_t)rest[i];
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0)
        return errno;
    const int failed = fp3_child_start(line, from, nowhere, is_told ? STDERR_FILENO : nowhere,
                                       SECONDS_MOST, child);
    close(nowhere);
    return failed;
}

fp3_status fp3_cc_compile(const char *text, const char *const *options, const char *path,
                          int is_told, fp3_error *error) {
    fp3_child child;
    int how = 0;
    const int from = open_text(text);
    if (from < 0)
        return fp3_fail(error, FP3_E_SYSTEM, "no temporary file: %s", strerror(errno));
    int failed = start(options, from, path, is_told, &child);
    close(from);
    if (failed)
        return fp3_fail(error, FP3_E_SYSTEM, "no compiler '%s': %s", fp3_cc(), strerror(failed));
    failed = fp3_child_wait(&child, &how);
    if (failed == ETIMEDOUT)
        return fp3_fail(error, FP3_E_SYSTEM, "compiler '%s' took longer than %u s, and was ended",
                        fp3_cc(), SECONDS_MOST);
    if (failed)
        return fp3_fail(error, FP3_E_SYSTEM, "compiler '%s': %s", fp3_cc(), strerror(failed));
    if (!WIFEXITED(how) || WEXITSTATUS(how))
        return fp3_fail(error, FP3_E_SYSTEM, "compiler '%s' failed", fp3_cc());
    return FP3_OK;
}
