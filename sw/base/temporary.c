/* SPDX-License-Identifier: Apache-2.0 */
/* temporary.c - see temporary.h. */
#include "temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define TRIES_MOST 100 /* until a folder stays: others may remove theirs meanwhile */
#define NOTED_MOST 32  /* folders that a signal handler knows; a command has fewer */

static const char *const inside[] = {FP3_TEMPORARY_NEW, FP3_TEMPORARY_BEFORE};
enum { INSIDE = sizeof inside / sizeof *inside };

/* ---- for a signal handler ---- */

/* The one thing that a signal handler can reach is a variable like this. Nothing else reads it. */
static struct {
    atomic_int is_there;
    int folder;
    char path[PATH_MAX];
} noted[NOTED_MOST];

enum { FREE, TAKEN, THERE };

static void note(const fp3_temporary *t) {
    for (int i = 0; i < NOTED_MOST; i++) {
        int is_free = FREE;
        if (!atomic_compare_exchange_strong(&noted[i].is_there, &is_free, TAKEN))
            continue;
        noted[i].folder = t->folder;
        snprintf(noted[i].path, PATH_MAX, "%s", t->path);
        atomic_store(&noted[i].is_there, THERE);
        return;
    }
}

static void forget(const fp3_temporary *t) {
    for (int i = 0; i < NOTED_MOST; i++)
        if (atomic_load(&noted[i].is_there) == THERE && noted[i].folder == t->folder)
            atomic_store(&noted[i].is_there, FREE);
}

static void empty(int folder) {
    for (int i = 0; i < INSIDE; i++)
        unlinkat(folder, inside[i], 0);
}

void fp3_temporary_remove_all(void) {
    for (int i = 0; i < NOTED_MOST; i++)
        if (atomic_load(&noted[i].is_there) == THERE) {
            empty(noted[i].folder);
            rmdir(noted[i].path);
        }
}

/* ---- opening and closing ---- */

char *fp3_temporary_path(const char *real, const char *file) {
    const char *name = strrchr(real, '/') + 1;
    char *path = NULL;
    if (asprintf(&path, "%.*s.fp3-%s.tmp%s%s", (int)(name - real), real, name, *file ? "/" : "",
                 file) < 0)
        return NULL;
    return path;
}

/* Where a file system has no locks of folders, a new folder belongs to no other process. */
static int lock(int folder, int is_new) {
    if (!flock(folder, LOCK_EX | LOCK_NB))
        return 0;
    if (errno == EWOULDBLOCK)
        errno = EBUSY;
    else if (is_new)
        return 0;
    else
        errno = EEXIST;
    return -1;
}

/* Who had it may have removed it before the lock was ours: then the name is free again, or has
 * another folder. */
static int is_still(const char *path, const struct stat *as) {
    struct stat now;
    return !lstat(path, &now) && now.st_dev == as->st_dev && now.st_ino == as->st_ino;
}

enum { TAKE_FAILED = -1, TAKE_AGAIN = -2 };

/* The open folder, or why not. */
static int take(const char *path) {
    struct stat is;
    const int is_new = !mkdir(path, 0700);
    if (!is_new && errno != EEXIST)
        return TAKE_FAILED;
    const int folder = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (folder < 0) {
        const int is_gone = errno == ENOENT;
        errno = errno == ELOOP || errno == ENOTDIR || errno == EACCES ? EEXIST : errno;
        return is_gone ? TAKE_AGAIN : TAKE_FAILED;
    }
    int result = fstat(folder, &is) ? TAKE_FAILED : folder;
    if (result >= 0 && is.st_uid != geteuid()) {
        errno = EEXIST;
        result = TAKE_FAILED;
    }
    if (result >= 0 && lock(folder, is_new))
        result = TAKE_FAILED;
    if (result >= 0 && !is_still(path, &is))
        result = TAKE_AGAIN;
    const int why = errno;
    if (result < 0)
        close(folder);
    errno = why;
    return result;
}

int fp3_temporary_open(const char *path, fp3_temporary *t) {
    int folder = TAKE_AGAIN;
    *t = (fp3_temporary){.folder = -1};
    for (int i = 0; folder == TAKE_AGAIN && i < TRIES_MOST; i++)
        folder = take(path);
    if (folder == TAKE_AGAIN)
        errno = EBUSY;
    if (folder < 0)
        return -1;
    *t = (fp3_temporary){strdup(path), folder};
    if (!t->path) {
        rmdir(path);
        close(folder);
        errno = ENOMEM;
        return -1;
    }
    empty(folder);
    note(t);
    return 0;
}

void fp3_temporary_close(fp3_temporary *t) {
    if (!t->path)
        return;
    empty(t->folder);
    rmdir(t->path);
    forget(t);
    close(t->folder);
    free(t->path);
    *t = (fp3_temporary){.folder = -1};
}

/* ---- without a file ---- */

#define PREFIX ".fp3-work-"

static void sweep(const char *directory) {
    DIR *all = opendir(directory);
    char path[PATH_MAX];
    fp3_temporary left;
    for (struct dirent *one; all && (one = readdir(all));)
        if (!strncmp(one->d_name, PREFIX, strlen(PREFIX)) &&
            snprintf(path, sizeof path, "%s/%s", directory, one->d_name) < PATH_MAX &&
            !fp3_temporary_open(path, &left))
            fp3_temporary_close(&left);
    if (all)
        closedir(all);
}

int fp3_temporary_open_in(const char *directory, fp3_temporary *t) {
    char path[PATH_MAX];
    struct timespec now;
    int failed = -1;
    sweep(directory);
    errno = EBUSY;
    for (int i = 0; failed && errno == EBUSY && i < TRIES_MOST; i++) {
        clock_gettime(CLOCK_MONOTONIC, &now);
        if (snprintf(path, sizeof path, "%s/" PREFIX "%ld-%lld%09ld.tmp", directory, (long)getpid(),
                     (long long)now.tv_sec, now.tv_nsec) >= PATH_MAX)
            errno = ENAMETOOLONG;
        else
            failed = fp3_temporary_open(path, t);
    }
    if (failed)
        *t = (fp3_temporary){.folder = -1};
    return failed;
}
