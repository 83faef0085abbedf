/* SPDX-License-Identifier: Apache-2.0 */
/* child.c - see child.h. */
#include "child.h"

#include <errno.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define GRACE_MS 1000 /* from SIGTERM, which lets a compiler remove its files, to SIGKILL */
#define LOOK_MS 2
#define WAIT_MS 100

extern char **environ;

static int64_t now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (int64_t)time.tv_sec * 1000 + time.tv_nsec / 1000000;
}

int fp3_child_start(char *const *arguments, int in, int out, int err, unsigned seconds,
                    fp3_child *child) {
    posix_spawn_file_actions_t actions;
    int failed = posix_spawn_file_actions_init(&actions);
    if (failed)
        return failed;
    failed = posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
    if (!failed)
        failed = posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    if (!failed)
        failed = posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
    child->end = now() + (int64_t)seconds * 1000;
    if (!failed)
        failed = posix_spawnp(&child->pid, arguments[0], &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    return failed;
}

int fp3_child_left(const fp3_child *child) {
    const int64_t left = child->end - now();
    return left < 0 ? 0 : left < WAIT_MS ? (int)left : WAIT_MS;
}

int fp3_child_wait(const fp3_child *child, int *how) {
    const struct timespec look = {.tv_nsec = LOOK_MS * 1000000L};
    int sent = 0;
    for (;;) {
        const pid_t found = waitpid(child->pid, how, sent == SIGKILL ? 0 : WNOHANG);
        if (found == child->pid)
            return sent ? ETIMEDOUT : 0;
        if (found < 0 && errno != EINTR)
            return errno;
        const int due = now() < child->end ? 0 : now() < child->end + GRACE_MS ? SIGTERM : SIGKILL;
        if (due != sent)
            kill(child->pid, due);
        sent = due;
        nanosleep(&look, NULL);
    }
}
