#include <fp3/status.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

fp3_status fp3_fail(fp3_error *error, fp3_status status, const char *format, ...) {
    if (!error)
        return status;
    /* The arguments may point into error->text itself. */
    fp3_error fresh;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(fresh.text, sizeof fresh.text, format, arguments);
    va_end(arguments);
    *error = fresh;
    /* A name or path in the message must not break the promise of one printable line. */
    for (char *c = error->text; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7f)
            *c = '?';
    return status;
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
