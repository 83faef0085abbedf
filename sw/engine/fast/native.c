/* SPDX-License-Identifier: Apache-2.0 */
/* native.c - see native.h. */
#include "native.h"

#include "base/cc.h"
#include "base/file.h"
#include "base/path.h"
#include "base/temporary.h"
#include "cache.h"
#include "write.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The first line of the text is for a file that is shipped. The second names the compiler and its
 * options, so that they count in the cache. */
#define LINE "/* fp3 " FP3_VERSION " "
#define OPTIONS                                                                                    \
    "-O1", "-w", "-std=gnu11", "-ffp-contract=off", "-frounding-math", "-fPIC", "-shared",         \
        "-nostdlib"

/* GCC colours a graph for each loop, which takes it a third of its time: in stretches without
 * branches such code is no faster. Of other compilers nobody reads this. */
#define ALLOCATION "#pragma GCC optimize (\"ira-algorithm=priority,ira-region=one\")"

static fp3_status write_text(const fp3_fast_plan *plan, const char *kind, char **text,
                             fp3_error *error) {
    static const char *const options[] = {OPTIONS};
    size_t size = 0;
    FILE *to = open_memstream(text, &size);
    if (!to)
        return fp3_no_memory(error);
    fprintf(to, LINE "%s */\n/* %s -march=%s", kind, fp3_cc(), kind);
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        fprintf(to, " %s", options[i]);
    fprintf(to, " */\n" ALLOCATION "\n");
    fp3_status status = fp3_fast_write(plan, to, error);
    if (fclose(to) && !status)
        status = fp3_no_memory(error);
    return status;
}

static fp3_status compile(const char *text, const char *kind, const char *path, fp3_error *error) {
    char march[64];
    snprintf(march, sizeof march, "-march=%s", kind);
    return fp3_cc_compile(text, (const char *const[]){march, OPTIONS, NULL}, path, 0, error);
}

/* By its whole path: a name alone would be looked for elsewhere. */
static fp3_status load(const char *path, fp3_fast_native *native, fp3_error *error) {
    char real[PATH_MAX];
    if (!realpath(path, real))
        return fp3_fail(error, FP3_E_SYSTEM, "%s: %s", path, strerror(errno));
    native->library = dlopen(real, RTLD_NOW | RTLD_LOCAL);
    if (!native->library)
        return fp3_fail(error, FP3_E_SYSTEM, "%s", dlerror());
    void *symbol = dlsym(native->library, FP3_FAST_NAME);
    memcpy(&native->stretch, &symbol, sizeof symbol);
    memcpy(&native->around, &symbol, sizeof symbol);
    if (symbol)
        return FP3_OK;
    fp3_fast_native_close(native);
    return fp3_fail(error, FP3_E_SYSTEM, "%s: " FP3_FAST_NAME " is missing", path);
}

/* A place for a library that is being made: a compiler replaces the file that it writes, and no
 * other user may do so in between. */
typedef struct {
    fp3_temporary temporary;
    char file[PATH_MAX];
} workshop;

static fp3_status open_workshop(const char *in, workshop *w, fp3_error *error) {
    if (fp3_temporary_open_in(in, &w->temporary))
        return fp3_fail(error, FP3_E_SYSTEM, "%s: %s", in, strerror(errno));
    if (snprintf(w->file, sizeof w->file, "%s/" FP3_TEMPORARY_NEW, w->temporary.path) < PATH_MAX)
        return FP3_OK;
    fp3_temporary_close(&w->temporary);
    return fp3_fail(error, FP3_E_SYSTEM, "%s: %s", in, strerror(ENAMETOOLONG));
}

static void close_workshop(workshop *w) { fp3_temporary_close(&w->temporary); }

/* In the cache or, without one, where temporary files go. */
static fp3_status find_workshop(const fp3_cache *cache, workshop *w, fp3_error *error) {
    const char *given = secure_getenv("TMPDIR");
    char real[PATH_MAX];
    if (cache->directory[0])
        return open_workshop(cache->directory, w, error);
    const fp3_status status = fp3_path_check_private(given && *given ? given : "/tmp", real, error);
    return status ? status : open_workshop(real, w, error);
}

/* Loaded before it is kept: the entry may then be whoever's it is. */
static fp3_status make(const fp3_cache *cache, const char *text, const char *kind,
                       fp3_fast_native *native, fp3_error *error) {
    workshop w = {.file = ""};
    fp3_status status = find_workshop(cache, &w, error);
    if (status)
        return status;
    status = compile(text, kind, w.file, error);
    if (!status)
        status = load(w.file, native, error);
    if (!status && cache->path[0])
        fp3_cache_keep(cache, w.file, text, NULL);
    close_workshop(&w);
    return status;
}

fp3_status fp3_fast_native_open(const fp3_fast_plan *plan, const char *kind, int may_compile,
                                fp3_fast_native *native, fp3_error *error) {
    char *text = NULL;
    fp3_cache cache;
    fp3_error why = {.text = "not in the cache"};
    *native = (fp3_fast_native){0};
    fp3_status status = write_text(plan, kind, &text, error);
    if (status)
        return status;
    const fp3_status none = fp3_cache_find(text, &cache, &why);
    if (!fp3_cache_has(&cache, text) || load(cache.path, native, error))
        status = may_compile ? make(&cache, text, kind, native, error)
                             : fp3_fail(error, FP3_E_SYSTEM, "%s%s, and no compiler may be started",
                                        none ? "no cache: " : "", why.text);
    if (none && !status)
        snprintf(native->no_cache, sizeof native->no_cache, "%s", why.text);
    free(text);
    return status;
}

/* ---- a file that is shipped ---- */

static fp3_status copy(const char *from, const char *to, fp3_output *output, fp3_error *error) {
    char *data = NULL;
    size_t size = 0;
    fp3_status status = fp3_file_read(from, &data, &size, error);
    if (!status && fwrite(data, 1, size, fp3_output_stream(output)) != size)
        status = fp3_path_fail(error, to, "cannot write");
    free(data);
    return status ? status : fp3_output_publish(output, error);
}

fp3_status fp3_fast_native_write(const fp3_fast_plan *plan, const char *path, const char *kind,
                                 fp3_error *error) {
    const fp3_cache none = {.directory = ""};
    workshop w = {.file = ""};
    char *text = NULL;
    fp3_output *output = NULL;
    fp3_status status = fp3_output_open(path, &output, error);
    if (!status)
        status = write_text(plan, kind, &text, error);
    if (!status)
        status = find_workshop(&none, &w, error);
    if (!status)
        status = compile(text, kind, w.file, error);
    if (!status)
        status = fp3_cache_seal(w.file, text, error);
    if (!status)
        status = copy(w.file, path, output, error);
    close_workshop(&w);
    fp3_output_close(&output);
    free(text);
    return status;
}

/* *text belongs to the caller: that of a whole file of this version. */
static fp3_status read_file(const char *path, char **text, fp3_error *error) {
    size_t size = 0, text_size = 0;
    char *data = NULL;
    fp3_status status = fp3_file_read(path, &data, &size, error);
    const char *found = status ? NULL : fp3_cache_text(data, size, &text_size);
    if (!status && !found)
        status = fp3_fail(error, FP3_E_ARGUMENT,
                          "%s is damaged, or no file of fp3 compile --native", path);
    else if (!status && (text_size < sizeof LINE || memcmp(found, LINE, sizeof LINE - 1) != 0))
        status = fp3_fail(error, FP3_E_ARGUMENT,
                          "%s was made by another version of fp3; this one is " FP3_VERSION, path);
    else if (!status && !(*text = strndup(found, text_size)))
        status = fp3_no_memory(error);
    free(data);
    return status;
}

fp3_status fp3_fast_native_kind(const char *path, fp3_fast_kind *kind, fp3_error *error) {
    char *text = NULL;
    const fp3_status status = read_file(path, &text, error);
    if (!status)
        snprintf(kind->name, sizeof kind->name, "%.*s", (int)strcspn(text + sizeof LINE - 1, " \n"),
                 text + sizeof LINE - 1);
    free(text);
    return status;
}

/* The compiler need not be here, nor have the same name. */
static const char *behind_compiler(const char *text) {
    const char *line = strchr(text, '\n');
    line = line ? strstr(line, " -march=") : NULL;
    return line ? line : "";
}

fp3_status fp3_fast_native_load(const fp3_fast_plan *plan, const char *path, const char *kind,
                                fp3_fast_native *native, fp3_error *error) {
    char *text = NULL, *own = NULL;
    fp3_status status = read_file(path, &text, error);
    *native = (fp3_fast_native){0};
    if (!status)
        status = write_text(plan, kind, &own, error);
    if (!status && strcmp(behind_compiler(text), behind_compiler(own)) != 0)
        status =
            fp3_fail(error, FP3_E_ARGUMENT,
                     "%s is native code of another program, or for another configuration", path);
    if (!status)
        status = load(path, native, error);
    free(text);
    free(own);
    return status;
}

void fp3_fast_native_close(fp3_fast_native *native) {
    if (native->library)
        dlclose(native->library);
    *native = (fp3_fast_native){0};
}
