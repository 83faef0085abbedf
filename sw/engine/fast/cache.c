/* SPDX-License-Identifier: Apache-2.0 */
/* cache.c - see cache.h. Behind the library stand its text, the text's size, a CRC-32 of all
 * before, and a mark. */
#include "cache.h"

#include <base/file.h>
#include <base/path.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#define MARK 0x46335046u /* "FP3F" */

typedef struct {
    uint64_t text_size;
    uint32_t crc, mark;
} trailer;

static uint64_t hash(const char *text) {
    uint64_t h = 0xcbf29ce484222325u; /* FNV-1a */
    for (const char *c = text; *c; c++)
        h = (h ^ (unsigned char)*c) * 0x100000001b3u;
    return h;
}

static int is_made(const char *path) { return mkdir(path, 0700) == 0 || errno == EEXIST; }

/* FP3_CACHE_DIR, or a folder where caches or a user's files are; made, if need be. */
static fp3_status find_directory(char path[PATH_MAX], fp3_error *error) {
    const char *given = secure_getenv("FP3_CACHE_DIR"), *caches = secure_getenv("XDG_CACHE_HOME");
    const char *home = secure_getenv("HOME");
    int length;
    if (given && *given)
        length = snprintf(path, PATH_MAX, "%s", given);
    else if (caches && *caches == '/') {
        is_made(caches);
        length = snprintf(path, PATH_MAX, "%s/fp3", caches);
    } else if (home && *home == '/') {
        if ((size_t)snprintf(path, PATH_MAX, "%s/.cache", home) < PATH_MAX)
            is_made(path);
        length = snprintf(path, PATH_MAX, "%s/.cache/fp3", home);
    } else {
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "FP3_CACHE_DIR, XDG_CACHE_HOME and HOME are not set");
    }
    if (length >= PATH_MAX - 64)
        return fp3_fail(error, FP3_E_ARGUMENT, "its name is too long");
    return is_made(path) ? FP3_OK : fp3_path_fail(error, path, "cannot be made");
}

/* A directory of our own that no other user can write to, so a name in it always means the same
 * file. */
static fp3_status check_directory(const char *path, char real[PATH_MAX], fp3_error *error) {
    struct stat is;
    fp3_status status = fp3_path_check_private(path, real, error);
    if (status)
        return status;
    if (stat(real, &is) || access(real, W_OK | X_OK))
        return fp3_path_fail(error, real, "cannot write");
    return is.st_uid != geteuid() || (is.st_mode & (S_IWGRP | S_IWOTH))
               ? fp3_fail(error, FP3_E_ARGUMENT, "other users can write to %s", real)
               : FP3_OK;
}

fp3_status fp3_cache_find(const char *text, fp3_cache *cache, fp3_error *error) {
    char path[PATH_MAX];
    fp3_status status = find_directory(path, error);
    if (!status)
        status = check_directory(path, cache->directory, error);
    if (!status && strlen(cache->directory) >= PATH_MAX - 64)
        status = fp3_fail(error, FP3_E_ARGUMENT, "its name is too long");
    cache->path[0] = '\0';
    if (status)
        cache->directory[0] = '\0';
    else
        snprintf(cache->path, PATH_MAX, "%.*s/%016" PRIx64 ".so", PATH_MAX - 64, cache->directory,
                 hash(text));
    return status;
}

const char *fp3_cache_text(const char *data, size_t size, size_t *text_size) {
    trailer end;
    if (size < sizeof end)
        return NULL;
    memcpy(&end, data + size - sizeof end, sizeof end);
    if (end.mark != MARK || end.text_size > size - sizeof end ||
        end.crc != crc32_z(0, (const unsigned char *)data, size - sizeof end))
        return NULL;
    *text_size = end.text_size;
    return data + size - sizeof end - end.text_size;
}

static int is_whole(const char *data, size_t size, const char *text) {
    size_t text_size = 0;
    const char *found = fp3_cache_text(data, size, &text_size);
    return found && text_size == strlen(text) && memcmp(found, text, text_size) == 0;
}

/* The directory may have been open to others before: what they left there is not ours. */
static int is_own(int file) {
    struct stat is;
    return fstat(file, &is) == 0 && S_ISREG(is.st_mode) && is.st_uid == geteuid() &&
           !(is.st_mode & (S_IWGRP | S_IWOTH));
}

int fp3_cache_has(const fp3_cache *cache, const char *text) {
    char *data = NULL, name[32];
    size_t size = 0;
    const int file =
        *cache->path ? open(cache->path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC) : -1;
    if (file < 0)
        return 0;
    snprintf(name, sizeof name, "/proc/self/fd/%d", file);
    const int is_there =
        is_own(file) && !fp3_file_read(name, &data, &size, NULL) && is_whole(data, size, text);
    close(file);
    free(data);
    return is_there;
}

static int append(const char *path, const char *text, const trailer *end) {
    FILE *file = fopen(path, "ab");
    int is_written = file && fwrite(text, 1, strlen(text), file) == strlen(text) &&
                     fwrite(end, sizeof *end, 1, file) == 1;
    if (file)
        is_written &= fclose(file) == 0;
    return is_written;
}

fp3_status fp3_cache_seal(const char *file, const char *text, fp3_error *error) {
    char *data = NULL;
    size_t size = 0;
    fp3_status status = fp3_file_read(file, &data, &size, error);
    if (status)
        return status;
    trailer end = {.text_size = strlen(text), .mark = MARK};
    end.crc = (uint32_t)crc32_z(crc32_z(0, (const unsigned char *)data, size),
                                (const unsigned char *)text, strlen(text));
    free(data);
    return append(file, text, &end)
               ? FP3_OK
               : fp3_fail(error, FP3_E_SYSTEM, "%s: %s", file, strerror(errno));
}

fp3_status fp3_cache_keep(const fp3_cache *cache, const char *file, const char *text,
                          fp3_error *error) {
    const fp3_status status = fp3_cache_seal(file, text, error);
    return status || !rename(file, cache->path)
               ? status
               : fp3_fail(error, FP3_E_SYSTEM, "%s: %s", cache->path, strerror(errno));
}
