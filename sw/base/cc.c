/* cc.c - see cc.h. */
#include "cc.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define OPTIONS_MOST 24u

extern char **environ;

const char *fp3_cc(void) {
    const char *given = getenv("FP3_CC");
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
                 pid_t *child) {
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
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, from, 0);
    posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
    if (!is_told)
        posix_spawn_file_actions_addopen(&files, 2, "/dev/null", O_WRONLY, 0);
    const int failed = posix_spawnp(child, line[0], &files, NULL, line, environ);
    posix_spawn_file_actions_destroy(&files);
    return failed;
}

fp3_status fp3_cc_compile(const char *text, const char *const *options, const char *path,
                          int is_told, fp3_error *error) {
    pid_t child = 0;
    int how = 0;
    const int from = open_text(text);
    if (from < 0)
        return fp3_fail(error, FP3_E_SYSTEM, "no temporary file: %s", strerror(errno));
    const int failed = start(options, from, path, is_told, &child);
    close(from);
    if (failed)
        return fp3_fail(error, FP3_E_SYSTEM, "no compiler '%s': %s", fp3_cc(), strerror(failed));
    while (waitpid(child, &how, 0) < 0)
        if (errno != EINTR)
            return fp3_fail(error, FP3_E_SYSTEM, "compiler '%s': %s", fp3_cc(), strerror(errno));
    if (!WIFEXITED(how) || WEXITSTATUS(how))
        return fp3_fail(error, FP3_E_SYSTEM, "compiler '%s' failed", fp3_cc());
    return FP3_OK;
}
