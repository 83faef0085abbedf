/* SPDX-License-Identifier: Apache-2.0 */
#include "number.h"
#include "base/bits.h"

#include "host.h"

#include "scanner.h"

#include <errno.h>
#include <fp3/image.h>
#include <fp3/isa.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *fp3_number_copy(fp3_token t, char text[FP3_NUMBER_SIZE]) {
    if (t.length >= FP3_NUMBER_SIZE)
        return "a number of fewer than 256 characters";
    memcpy(text, t.text, t.length);
    text[t.length] = 0;
    return strlen(text) == t.length ? NULL : "a number";
}

/* ---- reading ---- */

static const char *in_double(const char *text, double *value) {
    char *end;
    errno = 0;
    const double number = strtod(text, &end);
    if (end == text || *end)
        return "a number";
    if (isinf(number))
        return "a number below 1.8e308, the end of double";
    if (number == 0 && errno == ERANGE)
        return "0 or a number above 4.9e-324, the start of double";
    *value = number;
    return NULL;
}

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

const char *fp3_number_decimal(const char *text, double *value) {
    return is_decimal(text) ? in_double(text, value) : "a number as 2, 0.5 or 1.5e-3";
}

const char *fp3_number_read(const char *text, double *value) {
    const char *p = text + (*text == '-' || *text == '+');
    if (strcmp(p, "inf") == 0 || strcmp(p, "nan") == 0) {
        *value = copysign(*p == 'i' ? INFINITY : NAN, *text == '-' ? -1.0 : 1.0);
        return NULL;
    }
    return fp3_is_digit(*p) || *p == '.' ? in_double(text, value) : "a number";
}

/* ---- to FP32 ---- */

const char *fp3_number_fits(float rounded, int is_zero, int is_infinite) {
    if (isinf(rounded) && !is_infinite)
        return "a number below 3.4028236e38, the end of FP32";
    if (rounded == 0 && !is_zero)
        return "0 or a number above 7e-46, the start of FP32";
    return NULL;
}

const char *fp3_number_single(double value, float *single) {
    *single = (float)value;
    return fp3_number_fits(*single, value == 0, isinf(value));
}

const char *fp3_number_written(double value, float *single) {
    const char *expected = fp3_number_single(value, single);
    return *single == 0 ? NULL : expected;
}

double fp3_number_given(double value, unsigned words) {
    float first;
    if (fp3_number_single(value, &first) || !isnormal(first))
        return value;
    return words == 1 ? (double)first : (double)first + (double)(float)(value - (double)first);
}

const char *fp3_number_step(double value, float *single) {
    *single = (float)value;
    return value > 0 && *single > 0 && isfinite(*single)
               ? NULL
               : "a time step from 1.4e-45 to 3.4028235e38, the positive numbers of FP32";
}

/* ---- writing ---- */

void fp3_number_text(uint32_t bits, char text[FP3_NUMBER_TEXT_SIZE]) {
    const float value = fp3_value_of(bits);
    if (isinf(value)) {
        snprintf(text, FP3_NUMBER_TEXT_SIZE, "%sinf", bits >> 31 ? "-" : "");
        return;
    }
    if ((bits & 0x7fffffffu) == FP3_BITS_NAN) {
        snprintf(text, FP3_NUMBER_TEXT_SIZE, "%snan", bits >> 31 ? "-" : "");
        return;
    }
    if (isnan(value)) {
        snprintf(text, FP3_NUMBER_TEXT_SIZE, "bits:0x%08x", bits);
        return;
    }
    FP3_HOST;
    for (int digits = 1; digits <= 9; digits++) { /* nine always suffice */
        snprintf(text, FP3_NUMBER_TEXT_SIZE, "%.*g", digits, (double)value);
        float again = strtof(text, NULL);
        if (!memcmp(&again, &value, sizeof value))
            break;
    }
    if (!strpbrk(text, ".e"))
        strcat(text, ".0");
}
