/* SPDX-License-Identifier: Apache-2.0 */
#include "path.h"

#include "temporary.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LINKS_MOST 40 /* as of the kernel */

static fp3_status of_errno(int number) {
    switch (number) {
    case ENOENT:
    case EACCES:
    case EPERM:
    case EISDIR:
    case ENOTDIR:
    case ENAMETOOLONG:
    case ELOOP:
    case EROFS:
    case ETXTBSY:
    case ENXIO:
    case EBADF:
        return FP3_E_ARGUMENT;
    default:
        return FP3_E_SYSTEM;
    }
}

fp3_status fp3_path_fail(fp3_error *error, const char *path, const char *what) {
    const int number = errno;
    return fp3_fail(error, of_errno(number), "%s: %s: %s", path, what, strerror(number));
}

int fp3_path_stream(const char *path, int is_output) {
    static const struct {
        const char *name;
        int stream;
    } names[] = {
        {"/dev/stdin", STDIN_FILENO},   {"/dev/fd/0", STDIN_FILENO},
        {"/dev/stdout", STDOUT_FILENO}, {"/dev/fd/1", STDOUT_FILENO},
        {"/dev/stderr", STDERR_FILENO}, {"/dev/fd/2", STDERR_FILENO},
    };
    if (!strcmp(path, "-"))
        return is_output ? STDOUT_FILENO : STDIN_FILENO;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(path, names[i].name))
            return names[i].stream;
    return -1;
}

/* ---- links ---- */

/* <directory of path>/name, or name where it begins with a slash. */
static char *beside(const char *path, const char *name) {
    const char *slash = strrchr(path, '/');
    char *made = NULL;
    if (asprintf(&made, "%.*s%s", *name == '/' || !slash ? 0 : (int)(slash - path) + 1, path,
                 name) < 0)
        return NULL;
    return made;
}

/* The directory of a path behind all links, and the name in it: what does not exist yet. */
static char *resolve_new(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    char *directory =
        slash ? strndup(path, slash == path ? 1 : (size_t)(slash - path)) : strdup(".");
    char *real = directory ? realpath(directory, NULL) : NULL, *made = NULL;
    free(directory);
    if (real && !*name)
        errno = EISDIR;
    else if (real && asprintf(&made, "%s/%s", strcmp(real, "/") ? real : "", name) < 0)
        made = NULL;
    free(real);
    return made;
}

char *fp3_path_resolve(const char *path) {
    char *real = realpath(path, NULL);
    if (real || errno != ENOENT)
        return real;
    char *at = strdup(path);
    for (int i = 0; at && i < LINKS_MOST; i++) {
        char target[PATH_MAX];
        const ssize_t length = readlink(at, target, sizeof target - 1);
        if (length < 0) {
            char *made = resolve_new(at);
            free(at);
            return made;
        }
        target[length] = '\0';
        char *next = beside(at, target);
        free(at);
        at = next;
    }
    free(at);
    errno = ELOOP;
    return NULL;
}

/* ---- which file ---- */

static int identify_new(const char *path, fp3_path_id *id) {
    struct stat found;
    char *real = fp3_path_resolve(path);
    char *slash = real ? strrchr(real, '/') : NULL;
    if (!slash || strlen(slash + 1) > NAME_MAX) {
        free(real);
        return -1;
    }
    strcpy(id->name, slash + 1);
    slash[slash == real] = '\0';
    const int result = stat(real, &found);
    id->device = found.st_dev;
    id->inode = found.st_ino;
    free(real);
    return result;
}

int fp3_path_identify(const char *path, int is_output, fp3_path_id *id) {
    struct stat found;
    const int stream = fp3_path_stream(path, is_output);
    *id = (fp3_path_id){0};
    if (stream < 0 ? stat(path, &found) : fstat(stream, &found))
        return stream < 0 && errno == ENOENT ? identify_new(path, id) : -1;
    id->device = found.st_dev;
    id->inode = found.st_ino;
    id->mode = found.st_mode;
    return 0;
}

int fp3_path_same(const fp3_path_id *a, const fp3_path_id *b) {
    return a->device == b->device && a->inode == b->inode && !strcmp(a->name, b->name);
}

static int is_inside(const char *real, const char *inside, const fp3_path_id *id) {
    fp3_path_id of;
    char *path = fp3_temporary_path(real, inside);
    const int is = path && !fp3_path_identify(path, 1, &of) && fp3_path_same(&of, id);
    free(path);
    return is;
}

int fp3_path_is_temporary_of(const char *output, const fp3_path_id *id) {
    char *real = fp3_path_stream(output, 1) < 0 ? fp3_path_resolve(output) : NULL;
    const int is = real && (is_inside(real, FP3_TEMPORARY_NEW, id) ||
                            is_inside(real, FP3_TEMPORARY_BEFORE, id));
    free(real);
    return is;
}

/* ---- whether it can be written ---- */

/* A temporary has to stand beside it. */
static int check_directory(char *path) {
    char *slash = strrchr(path, '/');
    if (strlen(slash + 1) + FP3_TEMPORARY_EXTRA > NAME_MAX) {
        errno = ENAMETOOLONG;
        return -1;
    }
    slash[slash == path] = '\0';
    return access(path, W_OK | X_OK);
}

fp3_status fp3_path_check_output(const char *path, fp3_error *error) {
    struct stat found;
    const int stream = fp3_path_stream(path, 1);
    if (stream >= 0)
        return fcntl(stream, F_GETFL) < 0 ? fp3_path_fail(error, path, "cannot write") : FP3_OK;
    const int exists = !stat(path, &found);
    int result = exists || errno == ENOENT ? 0 : -1;
    if (exists && (S_ISDIR(found.st_mode) || S_ISSOCK(found.st_mode))) {
        errno = S_ISDIR(found.st_mode) ? EISDIR : ENXIO;
        result = -1;
    } else if (exists) {
        result = access(path, W_OK); /* a rename would replace a file that is write-protected */
    }
    if (!result && (!exists || S_ISREG(found.st_mode))) {
        char *real = fp3_path_resolve(path);
        result = real ? check_directory(real) : -1;
        free(real);
    }
    return result ? fp3_path_fail(error, path, "cannot write") : FP3_OK;
}

/* ---- whether others can change it ---- */

static fp3_status check_level(const char *path, fp3_error *error) {
    struct stat is;
    if (lstat(path, &is))
        return fp3_path_fail(error, path, "cannot look at it");
    if (!S_ISDIR(is.st_mode))
        return fp3_fail(error, FP3_E_ARGUMENT, "%s is no directory", path);
    if (is.st_uid != 0 && is.st_uid != geteuid())
        return fp3_fail(error, FP3_E_ARGUMENT, "%s belongs to another user", path);
    return (is.st_mode & (S_IWGRP | S_IWOTH)) && !(is.st_mode & S_ISVTX)
               ? fp3_fail(error, FP3_E_ARGUMENT, "other users can write to %s", path)
               : FP3_OK;
}

/* From the root down: once a directory is checked, no other user can replace the one below. */
fp3_status fp3_path_check_private(const char *path, char real[PATH_MAX], fp3_error *error) {
    if (!realpath(path, real))
        return fp3_path_fail(error, path, "no directory");
    fp3_status status = check_level("/", error);
    for (char *slash = strchr(real + 1, '/'); !status && slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        status = check_level(real, error);
        *slash = '/';
    }
    return status ? status : check_level(real, error);
}

char *fp3_path_beside(const char *file, const char *name) {
    const char *slash = strrchr(file, '/');
    const size_t folder = *name == '/' || !slash ? 0 : (size_t)(slash + 1 - file);
    char *made = malloc(folder + strlen(name) + 1);
    if (made) {
        memcpy(made, file, folder);
        strcpy(made + folder, name);
    }
    return made;
}
