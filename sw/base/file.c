/* SPDX-License-Identifier: Apache-2.0 */
#include "file.h"

#include "path.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define SIZE_LIMIT (64u << 20)
#define PATIENCE_MS 10000 /* for whoever is at the other end of a named pipe */
#define LOOK_MS 20
#define NAMES_MOST 100 /* of temporaries, until one is free */

/* ---- reading ---- */

/* Not blocked by a named pipe without a writer. */
fp3_status fp3_file_open(const char *path, FILE **file, fp3_error *error) {
    const int stream = fp3_path_stream(path, 0);
    const int opened = stream < 0 ? open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC)
                                  : fcntl(stream, F_DUPFD_CLOEXEC, 0);
    struct stat found;
    *file = NULL;
    if (opened < 0 || fstat(opened, &found)) {
        fp3_status status = fp3_path_fail(error, path, "cannot open");
        if (opened >= 0)
            close(opened);
        return status;
    }
    struct pollfd writer = {.fd = opened, .events = POLLIN};
    if (stream < 0 && S_ISFIFO(found.st_mode) && poll(&writer, 1, PATIENCE_MS) == 0) {
        close(opened);
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: a pipe that nobody writes into", path);
    }
    if (stream < 0)
        fcntl(opened, F_SETFL, fcntl(opened, F_GETFL) & ~O_NONBLOCK);
    *file = fdopen(opened, "rb");
    if (!*file) {
        close(opened);
        return fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    }
    return FP3_OK;
}

static fp3_status read_all(FILE *file, const char *path, char **bytes, size_t *used,
                           fp3_error *error) {
    for (size_t room = 0;;) {
        if (*used == room) {
            room = room ? 2 * room : 65536;
            char *more = realloc(*bytes, room + 1);
            if (!more)
                return fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
            *bytes = more;
        }
        *used += fread(*bytes + *used, 1, room - *used, file);
        if (ferror(file))
            return fp3_path_fail(error, path, "cannot read");
        if (*used > SIZE_LIMIT)
            return fp3_fail(error, FP3_E_ARGUMENT, "%s: longer than %u bytes", path, SIZE_LIMIT);
        if (feof(file))
            return FP3_OK;
    }
}

fp3_status fp3_file_read(const char *path, char **data, size_t *size, fp3_error *error) {
    FILE *file;
    char *bytes = NULL;
    size_t used = 0;
    *data = NULL;
    *size = 0;
    fp3_status status = fp3_file_open(path, &file, error);
    if (!status)
        status = read_all(file, path, &bytes, &used, error);
    if (file)
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

/* ---- writing ---- */

struct fp3_output {
    FILE *stream;
    char *path, *real; /* as it was named, and behind all links */
    char *temporary;   /* NULL: written directly, or published */
    char *before;      /* where the content goes that publishing replaces; NULL: it is lost */
};

/* A temporary beside real, a name that is free. */
static int open_temporary(fp3_output *o, mode_t mode) {
    const char *slash = strrchr(o->real, '/');
    int file = -1;
    for (int i = 0; file < 0 && i < NAMES_MOST; i++) {
        free(o->temporary);
        if (asprintf(&o->temporary, "%.*s/.fp3-%ld-%d.tmp", (int)(slash - o->real), o->real,
                     (long)getpid(), i) < 0) {
            o->temporary = NULL;
            return -1;
        }
        file = open(o->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        if (file < 0 && errno != EEXIST)
            break;
    }
    if (file < 0) { /* it is not ours to remove */
        free(o->temporary);
        o->temporary = NULL;
    }
    return file;
}

/* Not blocked by a named pipe without a reader. */
static int open_direct(const char *path) {
    const struct timespec look = {.tv_nsec = LOOK_MS * 1000000L};
    int file = open(path, O_WRONLY | O_NONBLOCK | O_CLOEXEC);
    for (int waited = 0; file < 0 && errno == ENXIO && waited < PATIENCE_MS; waited += LOOK_MS) {
        nanosleep(&look, NULL);
        file = open(path, O_WRONLY | O_NONBLOCK | O_CLOEXEC);
    }
    if (file >= 0)
        fcntl(file, F_SETFL, fcntl(file, F_GETFL) & ~O_NONBLOCK);
    return file;
}

static int open_output(fp3_output *o) {
    struct stat found;
    const int own = fp3_path_stream(o->path, 1);
    if (own >= 0)
        return fcntl(own, F_DUPFD_CLOEXEC, 0);
    const int exists = !stat(o->path, &found);
    if (exists && !S_ISREG(found.st_mode))
        return open_direct(o->path);
    o->real = fp3_path_resolve(o->path);
    if (!o->real)
        return -1;
    const int file = open_temporary(o, exists ? found.st_mode & 0777 : 0666);
    if (file >= 0 && exists)
        fchmod(file, found.st_mode & 0777); /* whatever the umask */
    return file;
}

/* A link that cannot be made: the file system has none. Then path is missing for a moment. */
static int keep_before(const fp3_output *o) {
    if (unlink(o->before) && errno != ENOENT)
        return -1;
    return link(o->real, o->before) && errno != ENOENT && rename(o->real, o->before);
}

static int publish(fp3_output *o) {
    if (fsync(fileno(o->stream)) || (o->before && keep_before(o)) || rename(o->temporary, o->real))
        return -1;
    free(o->temporary);
    o->temporary = NULL;
    return 0;
}

static int open_again(fp3_output *o) {
    struct stat found;
    const int exists = !stat(o->path, &found);
    o->real = fp3_path_resolve(o->path);
    o->before = o->real ? fp3_output_before(o->real) : NULL;
    if (!o->before || asprintf(&o->temporary, "%s.tmp", o->real) < 0) {
        o->temporary = NULL;
        return -1;
    }
    return open(o->temporary, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC,
                exists ? found.st_mode & 0777 : 0666);
}

typedef int open_fn(fp3_output *o);

static fp3_status open_by(open_fn *open_it, const char *path, fp3_output **output,
                          fp3_error *error) {
    *output = NULL;
    fp3_status status = fp3_path_check_output(path, error);
    if (status)
        return status;
    fp3_output *o = calloc(1, sizeof *o);
    if (!o || !(o->path = strdup(path))) {
        free(o);
        return fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    }
    const int file = open_it(o);
    if (file < 0 || !(o->stream = fdopen(file, "wb"))) {
        status = fp3_path_fail(error, path, "cannot write");
        if (file >= 0)
            close(file);
        fp3_output_close(&o);
    }
    *output = o;
    return status;
}

fp3_status fp3_output_open(const char *path, fp3_output **output, fp3_error *error) {
    return open_by(open_output, path, output, error);
}

fp3_status fp3_output_open_again(const char *path, fp3_output **output, fp3_error *error) {
    struct stat found;
    *output = NULL;
    if (fp3_path_stream(path, 1) >= 0 || (!stat(path, &found) && !S_ISREG(found.st_mode)))
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: no regular file", path);
    return open_by(open_again, path, output, error);
}

char *fp3_output_before(const char *path) {
    char *before;
    return asprintf(&before, "%s.1", path) < 0 ? NULL : before;
}

FILE *fp3_output_stream(const fp3_output *output) { return output->stream; }

const char *fp3_output_temporary(const fp3_output *output) { return output->temporary; }

void fp3_output_begin_writing(const fp3_output *output) {
    if (output->temporary)
        sync_file_range(fileno(output->stream), 0, 0, SYNC_FILE_RANGE_WRITE);
}

fp3_status fp3_output_publish(fp3_output *o, fp3_error *error) {
    int failed = fflush(o->stream) || ferror(o->stream);
    if (!failed && o->temporary)
        failed = publish(o);
    return failed ? fp3_path_fail(error, o->path, "cannot write") : FP3_OK;
}

void fp3_output_close(fp3_output **output) {
    fp3_output *o = *output;
    *output = NULL;
    if (!o)
        return;
    if (o->stream)
        fclose(o->stream);
    if (o->temporary)
        unlink(o->temporary);
    free(o->temporary);
    free(o->path);
    free(o->real);
    free(o->before);
    free(o);
}

fp3_status fp3_file_write(const char *path, const void *data, size_t size, fp3_error *error) {
    fp3_output *output = NULL;
    fp3_status status = fp3_output_open(path, &output, error);
    if (!status && fwrite(data, 1, size, output->stream) != size)
        status = fp3_path_fail(error, path, "cannot write");
    if (!status)
        status = fp3_output_publish(output, error);
    fp3_output_close(&output);
    return status;
}
