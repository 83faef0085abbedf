#include <fp3/status.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Behind the place, which is in fresh. The arguments may point into error->text itself. */
static fp3_status fail(fp3_error *error, fp3_status status, fp3_error *fresh, const char *format,
                       va_list arguments) {
    fresh->message = (unsigned)strlen(fresh->text);
    vsnprintf(fresh->text + fresh->message, sizeof fresh->text - fresh->message, format, arguments);
    /* A name or path in the message must not break the promise of one printable line. */
    for (char *c = fresh->text; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7f)
            *c = '?';
    *error = *fresh;
    return status;
}

fp3_status fp3_fail(fp3_error *error, fp3_status status, const char *format, ...) {
    if (!error)
        return status;
    fp3_error fresh = {.text = ""};
    va_list arguments;
    va_start(arguments, format);
    fail(error, status, &fresh, format, arguments);
    va_end(arguments);
    return status;
}

fp3_status fp3_fail_at(fp3_error *error, fp3_status status, const char *path, unsigned line,
                       unsigned column, const char *format, ...) {
    if (!error)
        return status;
    fp3_error fresh = {.text = "", .line = line, .column = column};
    const size_t size = sizeof fresh.text, length = path ? strnlen(path, size - 1) : 0;
    fresh.path_size = (unsigned)length;
    if (column)
        snprintf(fresh.text, size, "%s%s%u:%u: error: ", path ? path : "", path ? ":" : "", line,
                 column);
    else if (line)
        snprintf(fresh.text, size, "%s%s%u: ", path ? path : "", path ? ":" : "", line);
    else if (path)
        snprintf(fresh.text, size, "%s: ", path);
    va_list arguments;
    va_start(arguments, format);
    fail(error, status, &fresh, format, arguments);
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
