/* SPDX-License-Identifier: Apache-2.0 */
#include "file.h"

#include "path.h"
#include "temporary.h"

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
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: a pipe that no process writes into", path);
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
    fp3_temporary
        temporary; /* open until the content is published, or until nothing more follows */
    char *fresh;   /* the name of the new content; NULL: written directly, or published */
    char *before;  /* where the content goes that publishing replaces; NULL: it is lost */
};

static fp3_status cannot_write(const fp3_output *o, fp3_error *error) {
    return fp3_path_fail(error, o->path, "cannot write");
}

/* file: below 0 with errno if it could not be opened. */
static fp3_status open_on(fp3_output *o, int file, fp3_error *error) {
    if (file >= 0 && (o->stream = fdopen(file, "wb")))
        return FP3_OK;
    const fp3_status status = cannot_write(o, error);
    if (file >= 0)
        close(file);
    return status;
}

static fp3_status open_temporary(fp3_output *o, fp3_error *error) {
    char *folder = o->real ? fp3_temporary_path(o->real, "") : NULL;
    if (!folder)
        return cannot_write(o, error);
    fp3_status status = FP3_OK;
    if (fp3_temporary_open(folder, &o->temporary))
        status = errno == EBUSY ? fp3_fail(error, FP3_E_ARGUMENT,
                                           "%s: another process is writing this file", o->path)
                 : errno == EEXIST
                     ? fp3_fail(error, FP3_E_ARGUMENT,
                                "%s: cannot write: %s is in the way: remove it, if no other "
                                "process is writing this file",
                                o->path, folder)
                     : cannot_write(o, error);
    free(folder);
    return status;
}

/* What a write left that failed before it was published. */
static void drop_fresh(fp3_output *o) {
    if (o->stream)
        fclose(o->stream);
    o->stream = NULL;
    if (o->fresh)
        unlink(o->fresh);
    free(o->fresh);
    o->fresh = NULL;
}

fp3_status fp3_output_begin(fp3_output *o, fp3_error *error) {
    struct stat found;
    const int exists = !stat(o->real, &found);
    const mode_t mode = exists ? found.st_mode & 0777 : 0666;
    drop_fresh(o);
    o->fresh = fp3_temporary_path(o->real, FP3_TEMPORARY_NEW);
    if (!o->fresh)
        return fp3_no_memory(error);
    const int file = open(o->fresh, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (file >= 0 && exists)
        fchmod(file, mode); /* whatever the umask */
    return open_on(o, file, error);
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

static fp3_status open_stream(fp3_output *o, int own, fp3_error *error) {
    const int file = own >= 0 ? fcntl(own, F_DUPFD_CLOEXEC, 0) : open_direct(o->path);
    return open_on(o, file, error);
}

static fp3_status open_output(fp3_output *o, fp3_error *error) {
    struct stat found;
    const int own = fp3_path_stream(o->path, 1);
    if (own >= 0 || (!stat(o->path, &found) && !S_ISREG(found.st_mode)))
        return open_stream(o, own, error);
    o->real = fp3_path_resolve(o->path);
    const fp3_status status = open_temporary(o, error);
    return status ? status : fp3_output_begin(o, error);
}

static fp3_status open_again(fp3_output *o, fp3_error *error) {
    o->real = fp3_path_resolve(o->path);
    o->before = o->real ? fp3_output_before(o->real) : NULL;
    return open_temporary(o, error);
}

/* The name before is never missing: a new link of another name replaces it. If both are links of
 * one file, as a killed run may leave them, renaming does nothing. A link that cannot be made: the
 * file system has none; then path is missing for a moment. */
static int keep_before(const fp3_output *o) {
    char *name = fp3_temporary_path(o->real, FP3_TEMPORARY_BEFORE);
    int failed = name ? 0 : -1;
    if (!failed && link(o->real, name))
        failed = errno != ENOENT && rename(o->real, o->before);
    else if (!failed)
        failed = rename(name, o->before) || (unlink(name) && errno != ENOENT);
    free(name);
    return failed;
}

static int publish(fp3_output *o) {
    if (fsync(fileno(o->stream)) || (o->before && keep_before(o)) || rename(o->fresh, o->real))
        return -1;
    free(o->fresh);
    o->fresh = NULL;
    if (!o->before)
        fp3_temporary_close(&o->temporary);
    else if (fclose(o->stream))
        return o->stream = NULL, -1;
    else
        o->stream = NULL;
    return 0;
}

typedef fp3_status open_fn(fp3_output *o, fp3_error *error);

static fp3_status open_by(open_fn *open_it, const char *path, fp3_output **output,
                          fp3_error *error) {
    *output = NULL;
    fp3_status status = fp3_path_check_output(path, error);
    if (status)
        return status;
    fp3_output *o = calloc(1, sizeof *o);
    if (!o || !(o->path = strdup(path))) {
        free(o);
        return fp3_no_memory(error);
    }
    status = open_it(o, error);
    if (status)
        fp3_output_close(&o);
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

const char *fp3_output_temporary(const fp3_output *output) { return output->fresh; }

void fp3_output_begin_writing(const fp3_output *output) {
    if (output->fresh)
        sync_file_range(fileno(output->stream), 0, 0, SYNC_FILE_RANGE_WRITE);
}

fp3_status fp3_output_publish(fp3_output *o, fp3_error *error) {
    int failed = fflush(o->stream) || ferror(o->stream);
    if (!failed && o->fresh)
        failed = publish(o);
    return failed ? cannot_write(o, error) : FP3_OK;
}

void fp3_output_close(fp3_output **output) {
    fp3_output *o = *output;
    *output = NULL;
    if (!o)
        return;
    if (o->stream)
        fclose(o->stream);
    fp3_temporary_close(&o->temporary);
    free(o->fresh);
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
