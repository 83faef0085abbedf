/* SPDX-License-Identifier: Apache-2.0 */
/* child.h - another program that is started, and ends in its time or is ended.
 *
 *     fp3_child child;
 *     int how, failed = fp3_child_start(arguments, in, out, err, 120, &child);
 *     if (!failed)
 *         failed = fp3_child_wait(&child, &how);
 */
#ifndef FP3_CHILD_H
#define FP3_CHILD_H

#include <stdint.h>
#include <sys/types.h>

typedef struct {
    pid_t pid;
    int64_t end; /* CLOCK_MONOTONIC, ms */
} fp3_child;

/* arguments[0] is looked for in PATH; in, out and err become its streams; seconds: how long it may
 * take. Returns an errno, or 0. */
int fp3_child_start(char *const *arguments, int in, int out, int err, unsigned seconds,
                    fp3_child *child);
/* How long to poll for it, in ms: what is left of its time, a tenth of a second at most; 0: nothing
 * is left. */
int fp3_child_left(const fp3_child *child);
/* Returns an errno, or 0 and, in *how, what waitpid says. ETIMEDOUT: it took too long, and was
 * ended. */
int fp3_child_wait(const fp3_child *child, int *how);

#endif
