#include <fp3/asm.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void fp3_number_text(uint32_t bits, char text[FP3_NUMBER_TEXT_SIZE]) {
    float value;
    memcpy(&value, &bits, sizeof value);
    if (isinf(value)) {
        snprintf(text, FP3_NUMBER_TEXT_SIZE, "%sinf", bits >> 31 ? "-" : "");
        return;
    }
    if ((bits & 0x7fffffffu) == 0x7fc00000u) {
        snprintf(text, FP3_NUMBER_TEXT_SIZE, "%snan", bits >> 31 ? "-" : "");
        return;
    }
    if (isnan(value)) {
        snprintf(text, FP3_NUMBER_TEXT_SIZE, "bits:0x%08x", bits);
        return;
    }
    /* The program may have set a locale that writes commas. "C" is built in: no failure. */
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0), before = uselocale(c);
    for (int digits = 1; digits <= 9; digits++) { /* nine always suffice */
        snprintf(text, FP3_NUMBER_TEXT_SIZE, "%.*g", digits, (double)value);
        float again = strtof(text, NULL);
        if (!memcmp(&again, &value, sizeof value))
            break;
    }
    uselocale(before);
    freelocale(c);
    if (!strpbrk(text, ".e"))
        strcat(text, ".0");
}
