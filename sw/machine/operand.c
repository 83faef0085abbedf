/* SPDX-License-Identifier: Apache-2.0 */
#include "operand.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "base/scanner.h"

static const char *bits_number(const char *text, uint32_t *bits) {
    static const char expected[] = "FP32 bits as bits:0x and one to eight hexadecimal digits";
    if (text[0] != '0' || text[1] != 'x')
        return expected;
    text += 2;
    size_t length = strspn(text, "0123456789abcdefABCDEF");
    if (length < 1 || length > 8 || text[length])
        return expected;
    *bits = (uint32_t)strtoul(text, NULL, 16);
    return NULL;
}

const char *fp3_asm_number(fp3_token t, uint32_t *bits) {
    char text[FP3_NUMBER_SIZE];
    const char *expected = fp3_number_copy(t, text);
    if (expected)
        return expected;
    if (!strncmp(text, "bits:", 5))
        return bits_number(text + 5, bits);
    int negative = text[0] == '-';
    const char *unsigned_text = text + (text[0] == '-' || text[0] == '+');
    if (!strcmp(unsigned_text, "nan")) {
        *bits = FP3_BITS_NAN | (uint32_t)negative << 31;
        return NULL;
    }
    int infinite = !strcmp(unsigned_text, "inf");
    if (!infinite && !fp3_is_digit(*unsigned_text) && *unsigned_text != '.')
        return "a number";
    char *end = NULL;
    errno = 0;
    float value = strtof(text, &end);
    if (end == text || *end)
        return "a number";
    memcpy(bits, &value, sizeof value);
    return fp3_number_fits(value, errno != ERANGE, infinite);
}

int fp3_asm_register(fp3_token t, uint32_t *operand) {
    const char *p = t.text, *end = t.text + t.length;
    if (t.kind == FP3_TOKEN_RAW)
        p++;
    else if (t.kind != FP3_TOKEN_NAME)
        return 0;
    int object = p < end && *p == FP3_BANK_OBJECT_PREFIX,
        shared = p < end && *p == FP3_BANK_SHARED_PREFIX;
    if (!object && !shared)
        return 0;
    p++;
    if (p == end || (*p == '0' && end - p > 1))
        return 0;
    uint32_t number = 0;
    for (; p < end; p++) {
        if (!fp3_is_digit(*p))
            return 0;
        if (number < 1000) /* beyond that it is out of range anyway */
            number = 10 * number + (uint32_t)(*p - '0');
    }
    if (number >= (object ? FP3_BANK_OBJECT_COUNT : FP3_BANK_SHARED_COUNT))
        *operand = ASM_NOWHERE;
    else
        *operand = number + fp3_asm_base(object);
    return 1;
}

void fp3_asm_register_text(uint32_t operand, char text[FP3_NAME_SIZE]) {
    const int object = fp3_asm_is_object(operand);
    snprintf(text, FP3_NAME_SIZE, "%c%u", object ? FP3_BANK_OBJECT_PREFIX : FP3_BANK_SHARED_PREFIX,
             operand - fp3_asm_base(object));
}
