/* SPDX-License-Identifier: Apache-2.0 */
/* report.h - the errors of one source, each shown with its line and a caret. */
#ifndef FP3_REPORT_H
#define FP3_REPORT_H

#include <fp3/status.h>
#include <stdarg.h>

#include "token.h"

enum { FP3_REPORT_LIMIT = 20 };

typedef struct {
    const char *name, *source;
    size_t size;
    unsigned count;
    struct {
        fp3_location location;
        const char *at; /* into source, for the line shown */
        char text[256];
    } entry[FP3_REPORT_LIMIT];
} fp3_report;

/* "found 'token', expected ...". A full report takes no more. */
__attribute__((format(printf, 3, 4))) void fp3_report_expected(fp3_report *report, fp3_token found,
                                                               const char *format, ...);
int fp3_report_full(const fp3_report *report);
/* The whole report in the order of the source, malloc'ed, and its first error. FP3_E_PROGRAM, or
 * FP3_E_SYSTEM when out of memory: *text is NULL then. */
fp3_status fp3_report_fail(const fp3_report *report, char **text, fp3_error *error);

/* One error as a report has it, of a source that has been read before; malloc'ed, or NULL. */
char *fp3_report_one(const char *name, const char *source, size_t size, fp3_location at,
                     const char *text);

#endif
