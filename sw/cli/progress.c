/* SPDX-License-Identifier: Apache-2.0 */
/* progress.c - see progress.h. */
#include "progress.h"

#include "base/path.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define PATIENCE 2.0 /* seconds, before the line appears */
#define TICK 0.25    /* seconds, from one line to the next */
enum { WIDTH = 78 }; /* of the line: it must not wrap */

struct fp3_progress {
    const char *command;
    double began;
    pthread_t thread;
    pthread_mutex_t lock; /* of all below, and of the terminal */
    pthread_cond_t wake;
    char what[WIDTH];
    double share; /* below 0: unknown */
    int is_over, is_paused, is_shown;
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- the line: with the lock ---- */

/* Blanks, not an escape sequence: any terminal does. */
static void erase(fp3_progress *p) {
    if (p->is_shown)
        fprintf(stderr, "\r%*s\r", WIDTH, "");
    p->is_shown = 0;
}

static void show(fp3_progress *p) {
    char line[2 * WIDTH], share[16] = "";
    if (p->is_paused || now() - p->began < PATIENCE)
        return;
    if (p->share >= 0)
        snprintf(share, sizeof share, "%.0f %%, ", 100 * p->share);
    snprintf(line, sizeof line, "fp3 %s: %s%s%s%.0f s", p->command, p->what, *p->what ? ", " : "",
             share, now() - p->began);
    fprintf(stderr, "\r%-*.*s", WIDTH, WIDTH, line);
    p->is_shown = 1;
}

/* ---- the thread ---- */

static void *tick(void *progress) {
    fp3_progress *p = progress;
    pthread_mutex_lock(&p->lock);
    while (!p->is_over) {
        const double next = now() + TICK;
        const struct timespec until = {.tv_sec = (time_t)next,
                                       .tv_nsec = (long)(1e9 * (next - (double)(time_t)next))};
        pthread_cond_timedwait(&p->wake, &p->lock, &until);
        if (!p->is_over)
            show(p);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

/* The line would stand in what is typed. */
static int is_typed(const char *input) {
    const int stream = input ? fp3_path_stream(input, 0) : -1;
    return stream >= 0 && isatty(stream);
}

fp3_progress *fp3_progress_begin(const char *command, const char *input) {
    pthread_condattr_t monotonic;
    fp3_progress *p = isatty(STDERR_FILENO) && !is_typed(input) ? calloc(1, sizeof *p) : NULL;
    if (!p)
        return NULL;
    p->command = command;
    p->began = now();
    p->share = -1;
    pthread_mutex_init(&p->lock, NULL);
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_cond_init(&p->wake, &monotonic);
    pthread_condattr_destroy(&monotonic);
    if (!pthread_create(&p->thread, NULL, tick, p))
        return p;
    free(p); /* then without */
    return NULL;
}

void fp3_progress_end(fp3_progress **progress) {
    fp3_progress *p = *progress;
    *progress = NULL;
    if (!p)
        return;
    pthread_mutex_lock(&p->lock);
    p->is_over = 1;
    erase(p);
    pthread_cond_signal(&p->wake);
    pthread_mutex_unlock(&p->lock);
    pthread_join(p->thread, NULL);
    pthread_cond_destroy(&p->wake);
    pthread_mutex_destroy(&p->lock);
    free(p);
}

/* ---- what is said ---- */

void fp3_progress_say(fp3_progress *p, const char *format, ...) {
    va_list arguments;
    if (!p)
        return;
    pthread_mutex_lock(&p->lock);
    va_start(arguments, format);
    vsnprintf(p->what, sizeof p->what, format, arguments);
    va_end(arguments);
    p->share = -1;
    pthread_mutex_unlock(&p->lock);
}

void fp3_progress_share(void *progress, double share) {
    fp3_progress *p = progress;
    if (!p)
        return;
    pthread_mutex_lock(&p->lock);
    p->share = share;
    pthread_mutex_unlock(&p->lock);
}

void fp3_progress_pause(fp3_progress *p) {
    if (!p)
        return;
    pthread_mutex_lock(&p->lock);
    erase(p);
    p->is_paused = 1;
    pthread_mutex_unlock(&p->lock);
}

void fp3_progress_resume(fp3_progress *p) {
    if (!p)
        return;
    pthread_mutex_lock(&p->lock);
    p->is_paused = 0;
    pthread_mutex_unlock(&p->lock);
}
