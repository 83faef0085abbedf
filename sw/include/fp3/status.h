/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/status.h - how every call of the library reports failure, and why it failed.
 *
 *     fp3_error error;
 *     if (fp3_image_load("ship.fp3", &image, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *
 * A call returns a status. On failure the call also writes one line into the caller's fp3_error,
 * unless that pointer is NULL. Whatever a failed call would have made is NULL or unchanged, unless
 * the comment of the call says otherwise. No pointer may be NULL unless a comment says so.
 *
 * Threads: the library has no global state. Two threads may call the library at the same time with
 * different objects (engines, images, scenes ...), and may read objects that neither changes. Only
 * one thread at a time may use an object. The other headers name exceptions. After a fork the child
 * may use the parent's objects, except two engines: "fast" once it has started threads, which the
 * child does not have, and "board", whose port both would share. The child opens its own engines.
 *
 * Locale and arithmetic: a call that computes, reads or writes numbers does so in the locale "C",
 * rounds to nearest and keeps subnormal numbers, and restores the settings of the calling thread. A
 * decimal comma, fesetround or -ffast-math in the host changes no bit and no text. A callback runs
 * with the library's locale and arithmetic. fp3_model_evaluate and fp3_model_fire, which are called
 * often, compute with the caller's arithmetic.
 *
 * Experimental: a header marked so may change in any version. While the first number of the version
 * is 0, all other headers change only with the second number.
 */
#ifndef FP3_STATUS_H
#define FP3_STATUS_H

#include <stdint.h>

#define FP3_VERSION "0.1.0"

/* Every header begins and ends with these macros. They give C linkage in C++, and mark the names
 * that the shared library exports. The library exports nothing else. */
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
    FP3_E_ARGUMENT, /* the caller asks for something impossible: an option, a name, a value */
    FP3_E_PROGRAM,  /* the program is wrong: source, image, or an instruction word */
    FP3_E_LIMIT,    /* stopped at a limit that the caller set; the state can be read */
    FP3_E_SYSTEM,   /* memory, file or device */
    FP3_E_MISMATCH, /* two results that must agree differ */
    FP3_E_FAILED    /* all outputs are complete, but objects failed in a run (fp3_engine_failure),
                     * a command had no truth to measure errors against, or a check failed */
} fp3_status;

/* The failure, and its place, if known. The text then begins with the place: "path: ...",
 * "path:line: ...", "path:line:column: error: ..." or "line:column: error: ...". The numbers repeat
 * the place for editors. */
typedef struct {
    char text[512];        /* one line without a newline; a longer line loses its middle */
    unsigned line, column; /* from 1; 0: unknown */
    unsigned path_size;    /* bytes of the path at the start of the text; 0: no path */
    unsigned message;      /* offset in the text at which the message begins, after the place */
} fp3_error;

/* Writes the message (error may be NULL) and returns status, so that a caller can write
 * return fp3_fail(error, FP3_E_ARGUMENT, "no register '%s'", name); */
__attribute__((format(printf, 3, 4))) fp3_status fp3_fail(fp3_error *error, fp3_status status,
                                                          const char *format, ...);

/* The message of an allocation that failed. */
static inline fp3_status fp3_no_memory(fp3_error *error) {
    return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
}

/* The same for a mistake at a known place. path may be NULL; line and column are 0 if unknown. */
__attribute__((format(printf, 6, 7))) fp3_status fp3_fail_at(fp3_error *error, fp3_status status,
                                                             const char *path, unsigned line,
                                                             unsigned column, const char *format,
                                                             ...);

/* The version of the library that the program is linked with, as "0.1.0". FP3_VERSION is the
 * version of the headers that the program was compiled with. *number (number may be NULL) is 10000
 * times the first number, plus 100 times the second, plus the third. */
const char *fp3_version(uint32_t *number);

/* The exit code of a command that ends with this status: 0 success, 1 failure, 2 bad input or
 * usage, 3 as FP3_E_FAILED. */
int fp3_exit_code(fp3_status status);

FP3_API_END

#endif
