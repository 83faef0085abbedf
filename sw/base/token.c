/* SPDX-License-Identifier: Apache-2.0 */
#include "token.h"

#include <stdio.h>
#include <string.h>

int fp3_token_is(fp3_token t, const char *text) {
    return strlen(text) == t.length && !memcmp(text, t.text, t.length);
}

int fp3_token_same(fp3_token a, fp3_token b) {
    return a.length == b.length && !memcmp(a.text, b.text, a.length);
}

const char *fp3_token_shown(fp3_token t, char text[FP3_TOKEN_SHOWN_SIZE]) {
    if (t.kind == FP3_TOKEN_END)
        return "end of line";
    if (t.kind == FP3_TOKEN_END_OF_FILE)
        return "end of file";
    size_t used = 0;
    text[used++] = '\'';
    for (size_t i = 0; i < t.length; i++) {
        if (used > FP3_TOKEN_SHOWN_SIZE - 12) {
            used += (size_t)sprintf(text + used, "...");
            break;
        }
        unsigned char c = (unsigned char)t.text[i];
        if (c >= ' ' && c < 0x7f)
            text[used++] = (char)c;
        else
            used += (size_t)sprintf(text + used, "\\x%02x", c);
    }
    text[used++] = '\'';
    text[used] = 0;
    return text;
}
