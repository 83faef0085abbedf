/* native.c - see native.h. */
#include "native.h"

#include "base/cc.h"
#include "cache.h"
#include "write.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The first line of the text names the compiler and its options, so that they count in the cache. */
#define OPTIONS                                                                                    \
    "-O1", "-w", "-std=gnu11", "-ffp-contract=off", "-frounding-math", "-fPIC", "-shared",         \
        "-nostdlib"

static fp3_status write_text(const fp3_fast_plan *plan, const char *kind, unsigned lanes,
                             char **text, fp3_error *error) {
    static const char *const options[] = {OPTIONS};
    size_t size = 0;
    FILE *to = open_memstream(text, &size);
    if (!to)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    fprintf(to, "/* %s -march=%s", fp3_cc(), kind);
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        fprintf(to, " %s", options[i]);
    fprintf(to, " */\n");
    fp3_status status = fp3_fast_write(plan, lanes, to, error);
    if (fclose(to) && !status)
        status = fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    return status;
}

static fp3_status compile(const char *text, const char *kind, const char *path, fp3_error *error) {
    char march[64];
    snprintf(march, sizeof march, "-march=%s", kind);
    return fp3_cc_compile(text, (const char *const[]){march, OPTIONS, NULL}, path, 0, error);
}

static fp3_status load(const char *path, fp3_fast_native *native, fp3_error *error) {
    native->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!native->library)
        return fp3_fail(error, FP3_E_SYSTEM, "%s", dlerror());
    void *symbol = dlsym(native->library, FP3_FAST_NAME);
    memcpy(&native->stretch, &symbol, sizeof symbol);
    if (symbol)
        return FP3_OK;
    fp3_fast_native_close(native);
    return fp3_fail(error, FP3_E_SYSTEM, "%s: " FP3_FAST_NAME " is missing", path);
}

/* A new file of our own in the cache or, without one, where temporary files go. */
static int make_file(const fp3_cache *cache, char path[PATH_MAX]) {
    const char *given = getenv("TMPDIR");
    const char *directory = cache->directory[0] ? cache->directory
                            : given && *given   ? given
                                                : "/tmp";
    if (snprintf(path, PATH_MAX, "%s/fp3-XXXXXX", directory) >= PATH_MAX)
        return 0;
    const int fd = mkstemp(path);
    if (fd >= 0)
        close(fd);
    return fd >= 0;
}

/* Loaded before it is kept: the entry may then be whoever's it is. */
static fp3_status make(const fp3_cache *cache, const char *text, const char *kind,
                       fp3_fast_native *native, fp3_error *error) {
    char path[PATH_MAX];
    if (!make_file(cache, path))
        return fp3_fail(error, FP3_E_SYSTEM, "no temporary file: %s", strerror(errno));
    fp3_status status = compile(text, kind, path, error);
    if (!status)
        status = load(path, native, error);
    if (status || !cache->path[0] || fp3_cache_keep(cache, path, text, NULL))
        unlink(path);
    return status;
}

fp3_status fp3_fast_native_open(const fp3_fast_plan *plan, const char *kind, unsigned lanes,
                                fp3_fast_native *native, fp3_error *error) {
    char *text = NULL;
    fp3_cache cache;
    *native = (fp3_fast_native){0};
    fp3_status status = write_text(plan, kind, lanes, &text, error);
    if (!status) {
        fp3_cache_find(text, &cache);
        if (!fp3_cache_has(&cache, text) || load(cache.path, native, error))
            status = make(&cache, text, kind, native, error);
    }
    free(text);
    return status;
}

void fp3_fast_native_close(fp3_fast_native *native) {
    if (native->library)
        dlclose(native->library);
    *native = (fp3_fast_native){0};
}
