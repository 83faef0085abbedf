/* SPDX-License-Identifier: Apache-2.0 */
#include <fp3/status.h>

#include "host.h"
#include "printable.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define ROOM 8192 /* of a whole message: two paths, and what is said of them */

/* Of a message that is too long the middle goes, mostly that of a path: its end says why. */
static void shorten(const char *whole, fp3_error *error) {
    const size_t size = strlen(whole), room = sizeof error->text - 1;
    size_t head = size <= room ? size : room / 3;
    const char *tail = size <= room ? "" : whole + size - (room - head - 3);
    while (*tail && (whole[head] & 0xc0) == 0x80) /* no part of a letter */
        head--;
    while ((*tail & 0xc0) == 0x80)
        tail++;
    snprintf(error->text, sizeof error->text, "%.*s%s%s", (int)head, whole, *tail ? "..." : "",
             tail);
    if (error->message > head) {
        const char *message = whole + error->message;
        error->path_size = 0; /* it is not whole */
        error->message = (unsigned)(head + 3 + (message > tail ? (size_t)(message - tail) : 0));
    }
}

/* Behind the place, which whole has. The arguments may point into error->text itself. */
static fp3_status fail(fp3_error *error, fp3_status status, const fp3_error *place,
                       char whole[ROOM], const char *format, va_list arguments) {
    FP3_HOST;
    const size_t used = strlen(whole);
    vsnprintf(whole + used, ROOM - used, format, arguments);
    /* A name or path in the message must not break the promise of one printable line. */
    for (size_t i = 0; whole[i]; i++)
        whole[i] = fp3_printable(whole, i);
    *error = *place;
    error->message = (unsigned)used;
    shorten(whole, error);
    return status;
}

fp3_status fp3_fail(fp3_error *error, fp3_status status, const char *format, ...) {
    if (!error)
        return status;
    char whole[ROOM] = "";
    va_list arguments;
    va_start(arguments, format);
    fail(error, status, &(fp3_error){.text = ""}, whole, format, arguments);
    va_end(arguments);
    return status;
}

fp3_status fp3_fail_at(fp3_error *error, fp3_status status, const char *path, unsigned line,
                       unsigned column, const char *format, ...) {
    if (!error)
        return status;
    char whole[ROOM] = "";
    const size_t length = path ? strnlen(path, ROOM / 2) : 0;
    const fp3_error place = {.line = line, .column = column, .path_size = (unsigned)length};
    const int size = (int)length;
    if (column)
        snprintf(whole, ROOM, "%.*s%s%u:%u: error: ", size, path ? path : "", path ? ":" : "", line,
                 column);
    else if (line)
        snprintf(whole, ROOM, "%.*s%s%u: ", size, path ? path : "", path ? ":" : "", line);
    else if (path)
        snprintf(whole, ROOM, "%.*s: ", size, path);
    va_list arguments;
    va_start(arguments, format);
    fail(error, status, &place, whole, format, arguments);
    va_end(arguments);
    return status;
}

const char *fp3_version(uint32_t *number) {
    uint32_t n = 0, part = 0;
    for (const char *c = FP3_VERSION; *c; c++) {
        part = *c == '.' ? 0 : 10 * part + (uint32_t)(*c - '0');
        n = *c == '.' ? 100 * n : n - n % 100 + part;
    }
    if (number)
        *number = n;
    return FP3_VERSION;
}

int fp3_exit_code(fp3_status status) {
    switch (status) {
    case FP3_OK:
        return 0;
    case FP3_E_ARGUMENT:
    case FP3_E_PROGRAM:
        return 2;
    case FP3_E_FAILED:
        return 3;
    case FP3_E_LIMIT:
    case FP3_E_SYSTEM:
    case FP3_E_MISMATCH:
        break;
    }
    return 1;
}
