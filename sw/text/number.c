#include "number.h"

#include <fp3/asm.h>
#include <fp3/isa.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

fp3_number_locale fp3_number_locale_enter(void) {
    /* "C" is built in: newlocale cannot fail. */
    const locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    return (fp3_number_locale){c, uselocale(c)};
}

void fp3_number_locale_leave(fp3_number_locale locale) {
    uselocale(locale.before);
    freelocale(locale.c);
}

const char *fp3_number_copy(fp3_token t, char text[FP3_NUMBER_SIZE]) {
    if (t.length >= FP3_NUMBER_SIZE)
        return "a number of fewer than 256 characters";
    memcpy(text, t.text, t.length);
    text[t.length] = 0;
    return strlen(text) == t.length ? NULL : "a number";
}

void fp3_number_text(uint32_t bits, char text[FP3_NUMBER_TEXT_SIZE]) {
    float value;
    memcpy(&value, &bits, sizeof value);
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
    const fp3_number_locale locale = fp3_number_locale_enter();
    for (int digits = 1; digits <= 9; digits++) { /* nine always suffice */
        snprintf(text, FP3_NUMBER_TEXT_SIZE, "%.*g", digits, (double)value);
        float again = strtof(text, NULL);
        if (!memcmp(&again, &value, sizeof value))
            break;
    }
    fp3_number_locale_leave(locale);
    if (!strpbrk(text, ".e"))
        strcat(text, ".0");
}
