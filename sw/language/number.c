#include "number.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "text/number.h"
#include "text/scanner.h"

static int is_decimal(const char *p) {
    size_t before = strspn(p, "0123456789"), after = 0;
    p += before;
    if (*p == '.') {
        after = strspn(p + 1, "0123456789");
        p += 1 + after;
    }
    if (before + after == 0)
        return 0;
    if (*p == 'e' || *p == 'E') {
        p += 1 + (p[1] == '+' || p[1] == '-');
        if (!fp3_is_digit(*p))
            return 0;
        p += strspn(p, "0123456789");
    }
    return !*p;
}

const char *fp3_ode_number(fp3_token t, double *value) {
    char text[FP3_NUMBER_SIZE];
    const char *expected = fp3_number_copy(t, text);
    if (expected)
        return expected;
    if (!is_decimal(text))
        return "a number as 2, 0.5 or 1.5e-3";
    errno = 0;
    *value = strtod(text, NULL);
    if (isinf(*value))
        return "a number below 1.8e308, the end of double";
    if (*value == 0 && errno == ERANGE)
        return "0 or a number above 4.9e-324, the start of double";
    return NULL;
}
