#include "report.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void fp3_report_expected(report *r, token found, const char *format, ...) {
    if (fp3_report_full(r))
        return;
    char shown[TOKEN_SHOWN_SIZE];
    r->entry[r->count].line = found.line;
    r->entry[r->count].column = found.column;
    r->entry[r->count].at = found.text;
    char *text = r->entry[r->count].text;
    size_t room = sizeof r->entry[r->count].text;
    size_t used =
        (size_t)snprintf(text, room, "found %s, expected ", fp3_token_shown(found, shown));
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + used, room - used, format, arguments);
    va_end(arguments);
    r->count++;
}

int fp3_report_full(const report *r) { return r->count == REPORT_LIMIT; }

/* Each byte takes one column and none drives the terminal. */
static char printable(char c) { return c == '\t' ? ' ' : c >= ' ' && c < 0x7f ? c : '?'; }

/* The line around the place, and a caret under it. */
static void show_line(FILE *out, const report *r, const char *at) {
    enum { BEFORE = 60, AFTER = 40 };
    const char *start = at, *end = at, *source_end = r->source + r->size;
    while (start > r->source && start[-1] != '\n' && at - start < BEFORE)
        start--;
    while (end < source_end && *end != '\n' && end - at < AFTER)
        end++;
    while (end > at && end[-1] == '\r')
        end--;
    fprintf(out, "    ");
    for (const char *p = start; p < end; p++)
        fputc(printable(*p), out);
    fprintf(out, "\n    %*s^\n", (int)(at - start), "");
}

static int by_place(const report *r, unsigned a, unsigned b) {
    if (r->entry[a].line != r->entry[b].line)
        return r->entry[a].line < r->entry[b].line;
    if (r->entry[a].column != r->entry[b].column)
        return r->entry[a].column < r->entry[b].column;
    return a < b;
}

char *fp3_report_text(report *r) {
    unsigned order[REPORT_LIMIT];
    for (unsigned i = 0; i < r->count; i++) {
        unsigned to = i;
        for (; to > 0 && by_place(r, i, order[to - 1]); to--)
            order[to] = order[to - 1];
        order[to] = i;
    }
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    for (unsigned i = 0; i < r->count; i++) {
        for (const char *c = r->name; *c; c++)
            fputc((unsigned char)*c < ' ' || *c == 0x7f ? '?' : *c, out);
        fprintf(out, ":%u:%u: error: %s\n", r->entry[order[i]].line, r->entry[order[i]].column,
                r->entry[order[i]].text);
        show_line(out, r, r->entry[order[i]].at);
    }
    if (fp3_report_full(r))
        fprintf(out, "%d errors; there may be more\n", REPORT_LIMIT);
    if (fclose(out)) {
        free(text);
        return NULL;
    }
    return text;
}

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c + 'a' - 'A') : c; }

/* Edits (insert, delete, change, swap neighbours) between two words, whatever their case. */
static unsigned distance(const char *a, size_t a_length, const char *b, size_t b_length) {
    unsigned row[3][FP3_NAME_SIZE + 1]; /* of b, for the last two letters of a and this one */
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

void fp3_report_nearest(token wanted, const char *candidate, const char **best) {
    size_t length = strlen(candidate);
    if (wanted.length >= FP3_NAME_SIZE || length >= FP3_NAME_SIZE)
        return;
    unsigned edits = distance(wanted.text, wanted.length, candidate, length);
    unsigned allowed = wanted.length < 2 ? 0 : 1 + (unsigned)wanted.length / 4;
    if (*best) {
        unsigned best_edits = distance(wanted.text, wanted.length, *best, strlen(*best));
        allowed = best_edits == 0 ? 0 : best_edits - 1;
        if (best_edits == 0)
            return;
    }
    if (edits <= allowed)
        *best = candidate;
}
