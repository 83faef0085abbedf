/* report.h - the errors of one source, shown with their lines. */
#ifndef FP3_REPORT_H
#define FP3_REPORT_H

#include <stddef.h>

#include "token.h"

enum { REPORT_LIMIT = 20 };

typedef struct {
    const char *name, *source;
    size_t size;
    unsigned count;
    struct {
        unsigned line, column;
        const char *at; /* into source, for the line shown */
        char text[256];
    } entry[REPORT_LIMIT];
} report;

/* "found 'token', expected ...". */
__attribute__((format(printf, 3, 4))) void fp3_report_expected(report *report, token found,
                                                               const char *format, ...);
int fp3_report_full(const report *report);
/* All of it in the order of the source; malloc'ed, or NULL when out of memory. */
char *fp3_report_text(report *report);

/* Keeps in *best the candidate that wanted is most likely a slip of. Start with *best NULL. */
void fp3_report_nearest(token wanted, const char *candidate, const char **best);

#endif
