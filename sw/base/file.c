#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define SIZE_LIMIT (64u << 20)

/* A missing or unreadable file is the caller's mistake; a failing device is not. */
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
        return FP3_E_ARGUMENT;
    default:
        return FP3_E_SYSTEM;
    }
}

static fp3_status fail(fp3_error *error, const char *path, const char *what) {
    int number = errno;
    return fp3_fail(error, of_errno(number), "%s: %s: %s", path, what, strerror(number));
}

fp3_status fp3_file_read(const char *path, char **data, size_t *size, fp3_error *error) {
    *data = NULL;
    *size = 0;
    FILE *file = fopen(path, "rb");
    if (!file)
        return fail(error, path, "cannot open");
    char *bytes = NULL;
    size_t used = 0, room = 0;
    fp3_status status = FP3_OK;
    for (;;) {
        if (used == room) {
            room = room ? 2 * room : 65536;
            char *more = realloc(bytes, room + 1);
            if (!more) {
                status = fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
                break;
            }
            bytes = more;
        }
        used += fread(bytes + used, 1, room - used, file);
        if (ferror(file)) {
            status = fail(error, path, "cannot read");
            break;
        }
        if (used > SIZE_LIMIT) {
            status = fp3_fail(error, FP3_E_ARGUMENT, "%s: longer than %u bytes", path, SIZE_LIMIT);
            break;
        }
        if (feof(file))
            break;
    }
    fclose(file);
    if (status) {
        free(bytes);
        return status;
    }
    bytes[used] = 0;
    *data = bytes;
    *size = used;
    return FP3_OK;
}

static int write_all(int file, const char *data, size_t size) {
    while (size > 0) {
        ssize_t count = write(file, data, size);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            return -1;
        data += count;
        size -= (size_t)count;
    }
    return 0;
}

/* The process's own stream of this name, or -1. Opened by name, a stream that is redirected to a
 * file would begin at the start of the file again, or replace it. */
static int stream(const char *path) {
    return !strcmp(path, "/dev/stdout")   ? STDOUT_FILENO
           : !strcmp(path, "/dev/stderr") ? STDERR_FILENO
                                          : -1;
}

static fp3_status write_direct(const char *path, const void *data, size_t size, fp3_error *error) {
    int own = stream(path);
    int file = own < 0 ? open(path, O_WRONLY) : own;
    if (file < 0)
        return fail(error, path, "cannot write");
    fp3_status status = FP3_OK;
    if (write_all(file, data, size))
        status = fail(error, path, "cannot write");
    if (own < 0 && close(file) && !status)
        status = fail(error, path, "cannot write");
    return status;
}

static fp3_status write_renamed(const char *path, mode_t mode, const void *data, size_t size,
                                fp3_error *error) {
    char *temporary = NULL;
    if (asprintf(&temporary, "%s.%ld.tmp", path, (long)getpid()) < 0)
        return fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    int file = open(temporary, O_WRONLY | O_CREAT | O_EXCL, mode);
    fp3_status status = FP3_OK;
    if (file < 0) {
        status = fail(error, path, "cannot write");
    } else {
        if (write_all(file, data, size) || fsync(file))
            status = fail(error, path, "cannot write");
        if (close(file) && !status)
            status = fail(error, path, "cannot write");
        if (!status && rename(temporary, path))
            status = fail(error, path, "cannot write");
        if (status)
            unlink(temporary);
    }
    free(temporary);
    return status;
}

fp3_status fp3_file_write(const char *path, const void *data, size_t size, fp3_error *error) {
    struct stat found;
    if (stream(path) >= 0)
        return write_direct(path, data, size, error);
    if (stat(path, &found))
        return write_renamed(path, 0666, data, size, error);
    if (!S_ISREG(found.st_mode))
        return write_direct(path, data, size, error);
    if (access(path, W_OK)) /* a rename would replace a file that is write-protected */
        return fail(error, path, "cannot write");
    char *real = realpath(path, NULL); /* or it would replace a link instead of its target */
    if (!real)
        return fail(error, path, "cannot write");
    fp3_status status = write_renamed(real, found.st_mode & 0777, data, size, error);
    free(real);
    return status;
}

int fp3_file_same(const char *one, const char *other) {
    struct stat a, b;
    return !stat(one, &a) && !stat(other, &b) && a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}
