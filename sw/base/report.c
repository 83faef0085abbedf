/* SPDX-License-Identifier: Apache-2.0 */
#include "report.h"

#include "printable.h"
#include "scanner.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void fp3_report_expected(fp3_report *r, fp3_token found, const char *format, ...) {
    va_list arguments;
    if (fp3_report_full(r))
        return;
    assert(found.text >= r->source && found.text <= r->source + r->size);
    char shown[FP3_TOKEN_SHOWN_SIZE];
    r->entry[r->count].location = found.location;
    r->entry[r->count].at = found.text;
    char *text = r->entry[r->count].text;
    const size_t room = sizeof r->entry[r->count].text;
    const size_t used =
        (size_t)snprintf(text, room, "found %s, expected ", fp3_token_shown(found, shown));
    va_start(arguments, format);
    vsnprintf(text + used, room - used, format, arguments);
    va_end(arguments);
    r->count++;
}

int fp3_report_full(const fp3_report *r) { return r->count == FP3_REPORT_LIMIT; }

/* Each byte takes one column, and no byte may control the terminal. */
static char printable(char c) { return c == '\t' ? ' ' : c >= ' ' && c < 0x7f ? c : '?'; }

/* The line around this byte of the source, and a caret under the byte. */
static void show_line(FILE *out, const fp3_report *r, const char *at) {
    enum { BEFORE = 60, AFTER = 40 };
    const char *start = at, *end = at, *source_end = r->source + r->size;
    while (start > r->source && start[-1] != '\n' && at - start < BEFORE)
        start--;
    if (start == r->source)
        start = fp3_scanner_open(r->source, r->size).next; /* behind a byte order mark */
    while (end < source_end && *end != '\n' && end - at < AFTER)
        end++;
    while (end > at && end[-1] == '\r')
        end--;
    fprintf(out, "    ");
    for (const char *p = start; p < end; p++)
        fputc(printable(*p), out);
    fprintf(out, "\n    %*s^\n", (int)(at - start), "");
}

static void show(FILE *out, const fp3_report *r, fp3_location location, const char *at,
                 const char *text) {
    for (size_t i = 0; r->name[i]; i++)
        fputc(fp3_printable(r->name, i), out);
    fprintf(out, ":%u:%u: error: %s\n", location.line, location.column, text);
    show_line(out, r, at);
}

/* Errors at one location stay in the order in which they were found. */
static void sort(const fp3_report *r, unsigned order[FP3_REPORT_LIMIT]) {
    for (unsigned i = 0; i < r->count; i++) {
        unsigned to = i;
        for (;
             to > 0 && fp3_location_before(r->entry[i].location, r->entry[order[to - 1]].location);
             to--)
            order[to] = order[to - 1];
        order[to] = i;
    }
}

static char *text_of(const fp3_report *r, const unsigned *order) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    for (unsigned i = 0; i < r->count; i++)
        show(out, r, r->entry[order[i]].location, r->entry[order[i]].at, r->entry[order[i]].text);
    if (fp3_report_full(r))
        fprintf(out, "%d errors; there may be more\n", FP3_REPORT_LIMIT);
    if (fclose(out)) {
        free(text);
        return NULL;
    }
    return text;
}

fp3_status fp3_report_fail(const fp3_report *r, char **text, fp3_error *error) {
    unsigned order[FP3_REPORT_LIMIT];
    sort(r, order);
    const unsigned first = order[0];
    const fp3_location at = r->entry[first].location;
    *text = text_of(r, order);
    return *text ? fp3_fail_at(error, FP3_E_PROGRAM, r->name, at.line, at.column, "%s",
                               r->entry[first].text)
                 : fp3_no_memory(error);
}

/* The byte at a location. */
static const char *find(const fp3_scanner *from, fp3_location location) {
    fp3_scanner s = *from;
    for (const char *newline; s.line < location.line && (newline = fp3_scanner_newline(&s));)
        fp3_scanner_new_line(&s, newline + 1);
    const size_t left = (size_t)(s.end - s.next);
    return s.next + (location.column - 1 < left ? location.column - 1 : left);
}

char *fp3_report_one(const char *name, const char *source, size_t size, fp3_location location,
                     const char *text) {
    const fp3_report r = {.name = name, .source = source, .size = size};
    const fp3_scanner s = fp3_scanner_open(source, size);
    char *made = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&made, &length);
    if (!out)
        return NULL;
    show(out, &r, location, find(&s, location), text);
    if (!fclose(out))
        return made;
    free(made);
    return NULL;
}
