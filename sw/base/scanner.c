/* SPDX-License-Identifier: Apache-2.0 */
#include "scanner.h"

#include <assert.h>
#include <string.h>

fp3_scanner fp3_scanner_open(const char *source, size_t size) {
    if (size >= 3 && !memcmp(source, "\xef\xbb\xbf", 3)) { /* a byte order mark */
        source += 3;
        size -= 3;
    }
    return (fp3_scanner){.next = source, .end = source + size, .line_start = source, .line = 1};
}

void fp3_scanner_new_line(fp3_scanner *s, const char *start) {
    assert(start <= s->end);
    s->next = s->line_start = start;
    s->line++;
}

const char *fp3_scanner_newline(const fp3_scanner *s) {
    return memchr(s->next, '\n', (size_t)(s->end - s->next));
}

fp3_token fp3_scanner_token(const fp3_scanner *s) {
    return (fp3_token){.text = s->next,
                       .location = {s->line, (unsigned)(s->next - s->line_start) + 1},
                       .kind = FP3_TOKEN_BAD};
}
