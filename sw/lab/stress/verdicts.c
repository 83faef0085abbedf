/* SPDX-License-Identifier: Apache-2.0 */
/* verdicts.c - see verdicts.h. */
#include "verdicts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *fp3_relation_name(fp3_comparison relation) {
    static const char *const names[] = {"within", "at most", "at least"};
    return names[relation];
}

/* A figure that is NaN never holds. */
static int holds(const fp3_verdict *v) {
    switch (v->relation) {
    case FP3_WITHIN:
        return fabs(v->measured - v->expected) <= v->tolerance ||
               (isinf(v->measured) && v->measured == v->expected);
    case FP3_AT_MOST:
        return v->measured <= v->expected + v->tolerance;
    case FP3_AT_LEAST:
        return v->measured >= v->expected - v->tolerance;
    }
    return 0;
}

static void *grow(void *list, size_t count, size_t size) {
    return realloc(list, (count + 1) * size);
}

fp3_status fp3_verdicts_add(fp3_verdicts *verdicts, const fp3_verdict *verdict, fp3_error *error) {
    fp3_verdict *more = grow(verdicts->list, verdicts->count, sizeof *more);
    if (!more)
        return fp3_no_memory(error);
    verdicts->list = more;
    fp3_verdict *v = &more[verdicts->count++];
    *v = *verdict;
    v->holds = holds(v);
    v->because = NULL;
    v->why[0] = '\0';
    if (v->holds)
        return FP3_OK;
    const int has_reason = verdict->because && verdict->because[0];
    snprintf(v->why, sizeof v->why, "%.6g is not %s %.6g%s%s", v->measured,
             fp3_relation_name(v->relation), v->expected, has_reason ? "; " : "",
             has_reason ? verdict->because : "");
    return FP3_OK;
}

fp3_status fp3_verdicts_draw(fp3_verdicts *verdicts, const char *figure, const char *series,
                             const double *x, const double *y, size_t count, fp3_error *error) {
    fp3_curve *more = grow(verdicts->curves, verdicts->curve_count, sizeof *more);
    if (!more)
        return fp3_no_memory(error);
    verdicts->curves = more;
    fp3_curve *c = &more[verdicts->curve_count++];
    *c = (fp3_curve){.figure = figure, .count = count};
    snprintf(c->series, sizeof c->series, "%s", series);
    c->x = calloc(count + 1, sizeof *c->x);
    c->y = calloc(count + 1, sizeof *c->y);
    if (!c->x || !c->y)
        return fp3_no_memory(error);
    memcpy(c->x, x, count * sizeof *x);
    memcpy(c->y, y, count * sizeof *y);
    return FP3_OK;
}

void fp3_verdicts_free(fp3_verdicts *verdicts) {
    for (size_t i = 0; i < verdicts->curve_count; i++) {
        free(verdicts->curves[i].x);
        free(verdicts->curves[i].y);
    }
    free(verdicts->list);
    free(verdicts->curves);
    *verdicts = (fp3_verdicts){0};
}

size_t fp3_verdicts_failed(const fp3_verdicts *verdicts) {
    size_t failed = 0;
    for (size_t i = 0; i < verdicts->count; i++)
        failed += !verdicts->list[i].holds;
    return failed;
}
