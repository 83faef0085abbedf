/* SPDX-License-Identifier: Apache-2.0 */
#include "nearest.h"

#include <string.h>

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c + 'a' - 'A') : c; }

/* How many edits (insert, delete, change, swap neighbours) turn one word into the other, whatever
 * their case. */
static unsigned distance(const char *a, size_t a_length, const char *b, size_t b_length) {
    unsigned row[3][FP3_NAME_SIZE +
                    1]; /* by letters of b: for the last two letters of a, and for this one */
    unsigned *before = row[0], *last = row[1], *now = row[2];
    for (unsigned j = 0; j <= b_length; j++)
        before[j] = last[j] = j;
    for (size_t i = 1; i <= a_length; i++) {
        now[0] = (unsigned)i;
        for (size_t j = 1; j <= b_length; j++) {
            unsigned best = last[j - 1] + (lower(a[i - 1]) != lower(b[j - 1]));
            if (best > last[j] + 1)
                best = last[j] + 1;
            if (best > now[j - 1] + 1)
                best = now[j - 1] + 1;
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                lower(a[i - 2]) == lower(b[j - 1]) && best > before[j - 2] + 1)
                best = before[j - 2] + 1;
            now[j] = best;
        }
        unsigned *free_row = before;
        before = last;
        last = now;
        now = free_row;
    }
    return last[b_length];
}

/* How far a candidate is from what is wanted. Who writes F and has F_x, F_y meant that vector. */
static unsigned edits(fp3_token wanted, const char *candidate) {
    const size_t n = wanted.length;
    if (n && strncmp(candidate, wanted.text, n) == 0 && candidate[n] == '_')
        return 0;
    return distance(wanted.text, n, candidate, strlen(candidate));
}

void fp3_nearest(fp3_token wanted, const char *candidate, const char **best) {
    if (wanted.length >= FP3_NAME_SIZE || strlen(candidate) >= FP3_NAME_SIZE)
        return;
    const unsigned too_many = *best               ? edits(wanted, *best)
                              : wanted.length < 2 ? 1
                                                  : 2 + (unsigned)wanted.length / 4;
    if (edits(wanted, candidate) < too_many)
        *best = candidate;
}
