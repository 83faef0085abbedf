/* fp3/status.h - how every call of the library says that it failed, and why.
 *
 *     fp3_error error;
 *     if (fp3_image_load("ship.fp3", &image, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *
 * A call returns a status; on failure it also writes one line into the caller's fp3_error
 * (or nothing, where that is NULL). What a failed call would have made is left NULL or unchanged,
 * unless its own comment says otherwise. No pointer may be NULL unless its comment says so.
 *
 * Threads: the library has no state of its own. Two threads may call at the same time with different objects
 * (engines, images, scenes ...), and read
 * what neither changes; one object is of one thread at a time. The other headers say where they differ.
 *
 * Experimental: a header that says so may change in any version. All others change with the second number of the
 * version while the first is 0.
 */
#ifndef FP3_STATUS_H
#define FP3_STATUS_H

#include <stdint.h>

#define FP3_VERSION "0.1.0"

/* Every header begins and ends with these: C linkage for C++, and names that the shared library
 * exports. It exports nothing else. */
#ifdef __cplusplus
#define FP3_API_BEGIN                                                                              \
    extern "C" {                                                                                   \
    _Pragma("GCC visibility push(default)")
#define FP3_API_END                                                                                \
    _Pragma("GCC visibility pop")                                                                  \
    }
#else
#define FP3_API_BEGIN _Pragma("GCC visibility push(default)")
#define FP3_API_END _Pragma("GCC visibility pop")
#endif

FP3_API_BEGIN

typedef enum {
    FP3_OK = 0,
    FP3_E_ARGUMENT, /* the caller asks for what cannot be: an option, a name, a value */
    FP3_E_PROGRAM,  /* the program is wrong: source, image, or an instruction word */
    FP3_E_LIMIT,    /* stopped at a limit that the caller gave; the state is readable */
    FP3_E_SYSTEM,   /* memory, file or device */
    FP3_E_MISMATCH, /* two results that must agree do not */
    FP3_E_FAILED    /* all outputs are there, but objects failed in a run (fp3_engine_failure), or a
                     * command had no truth to measure errors against, or a result that should hold does not */
} fp3_status;

/* Where the mistake is, if the text says it: "path:line: ...", "path:line:column: error: ..." or
 * "line:column: error: ...". For editors, which go there. */
typedef struct {
    char text[512];        /* one line without a newline; longer ones are cut */
    unsigned line, column; /* from 1; 0: unknown */
    unsigned path_size;    /* bytes of the path, which the text begins with; 0: it has none */
    unsigned message;      /* where in the text the place ends and the message begins */
} fp3_error;

/* Writes the message (error may be NULL) and returns status, so that a caller can
 * say: return fp3_fail(error, FP3_E_ARGUMENT, "no register '%s'", name); */
__attribute__((format(printf, 3, 4))) fp3_status fp3_fail(fp3_error *error, fp3_status status,
                                                          const char *format, ...);

/* The same, of a mistake at a place: path may be NULL, and line and column 0 where they are unknown. */
__attribute__((format(printf, 6, 7))) fp3_status fp3_fail_at(fp3_error *error, fp3_status status,
                                                             const char *path, unsigned line,
                                                             unsigned column, const char *format,
                                                             ...);

/* The version of the library that a program is linked with, as "0.1.0"; FP3_VERSION is that of the headers which
 * it was compiled with. *number (may be NULL): 10000 times the first, 100 times the second, and the third. */
const char *fp3_version(uint32_t *number);

/* The exit code of a command that ends with this status: 0 well, 1 failed, 2 bad input or usage, 3
 * objects failed in a run, or there was no truth. */
int fp3_exit_code(fp3_status status);

FP3_API_END

#endif
