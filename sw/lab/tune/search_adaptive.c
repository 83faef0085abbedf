/* SPDX-License-Identifier: Apache-2.0 */
/* search_adaptive.c - the tolerance of adaptive steps that meets a target.
 *
 * Over the span, errors are about proportional to the tolerance of a step: the estimate is of the
 * order of the error that steps add up to. The loosest one that meets the target costs the least.
 */
#include "search.h"

#include <fp3/engine.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define LOOKS_MOST 24 /* runs of the sample for one size */
#define MOST 0.5      /* the loosest tolerance */
#define LEAST 0x1p-44 /* no program takes a tighter one; most refuse much looser ones */
#define FARTHER 64    /* the most by which a guess changes it */
#define NEARER 1.25   /* the least */
#define UNKNOWN 0.125 /* what it is changed by where the error tells nothing */
#define MARGIN 1.05   /* of a guess, which else just misses */
#define CLOSE 1.03    /* two tolerances that need not be told apart, ... */
#define ALIKE 0.03    /* ... or the share of attempts that is not worth a look */
#define NOTHING_GAINED                                                                             \
    0.8            /* a tighter tolerance that leaves so much of the error is spent on rounding */
#define SMALL 0.1  /* from here on errors fall with the tolerance ... */
#define HOPELESS 2 /* ... and what needs so many times the most attempts is not tried */
#define APART 8    /* sizes of states that ask for more than one `absolute` */
#define SIZES 3

typedef struct {
    const fp3_search *search;
    const fp3_candidate *candidate;
    fp3_tune_row *row;
    double size;    /* of a state that `absolute` is the tolerance of */
    double most;    /* attempts that are of interest */
    unsigned looks; /* for this size */
    fp3_error *error;
} seeker;

/* A tolerance, and what it leads to. */
typedef struct {
    double tolerance;
    fp3_meter_found found; /* is_out: it costs too much, or is too tight for a program */
} point;

static int is_good(const seeker *s, const point *p) { return p->found.worst <= s->search->target; }

/* Three digits are enough for it, and for who reads it. */
static double tidy(double x) {
    char text[32];
    snprintf(text, sizeof text, "%.2e", x);
    return strtod(text, NULL);
}

static double cycles(const seeker *s, double attempts) {
    return fp3_candidate_cycles(s->candidate, s->search->config, attempts);
}

/* The most attempts that are of interest. */
static double find_most(const seeker *s) {
    const double limit = fmin(s->search->dearest, s->search->cheaper);
    const double once = cycles(s, 1), each = cycles(s, 2) - once;
    return fmin(1 + (limit - once) / each, FP3_ADAPTIVE_ATTEMPTS);
}

static void note(const seeker *s, const point *p, double absolute) {
    fp3_tune_row *row = s->row;
    const double cost = cycles(s, p->found.made);
    fp3_search_note(row, cost, p->found.worst);
    if (is_good(s, p) ? row->is_met && cost >= row->cycles
                      : row->is_met || (row->tolerance > 0 && !(p->found.worst < row->error)))
        return;
    row->is_met = is_good(s, p);
    row->tolerance = p->tolerance;
    row->absolute = absolute;
    row->attempts = p->found.made;
    row->error = p->found.worst;
    row->cycles = cost;
}

static fp3_status look(seeker *s, double tolerance, point *p) {
    const fp3_search *q = s->search;
    p->tolerance = tidy(fmin(fmax(tolerance, LEAST), MOST));
    const double absolute = tidy(p->tolerance * s->size);
    const fp3_stepping how = {.tolerance = p->tolerance,
                              .absolute = absolute,
                              .most = s->most,
                              .maxstep = s->candidate->maxstep};
    const fp3_status status =
        fp3_meter_read(q->meter, q->sample, s->candidate->measured, &how, &p->found, s->error);
    s->looks++;
    if (!status)
        note(s, p, absolute);
    return status;
}

/* What the error asks for, if it goes with the tolerance. */
static double factor(const seeker *s, const point *p) {
    const double error = p->found.worst;
    return error < 1 ? s->search->target / (MARGIN * fmax(error, 1e-30)) : UNKNOWN;
}

/* A tolerance that meets the target would need far too many attempts. */
static int is_hopeless(const seeker *s, const point *p) {
    const unsigned order = s->candidate->integrator->embedded_order;
    return p->found.worst < SMALL &&
           p->found.made * pow(p->found.worst / s->search->target, 1.0 / (order + 1)) >
               HOPELESS * s->most;
}

/* Tighter, from one that fails. *tight then is good, or out of reach; or there is none: nothing
 * helps. */
static fp3_status tighten(seeker *s, point *loose, point *tight, int *is_found) {
    fp3_status status = FP3_OK;
    unsigned idle = 0;
    *is_found = 0;
    while (!status && s->looks < LOOKS_MOST && loose->tolerance > LEAST && idle < 2 &&
           !is_hopeless(s, loose)) {
        const double least = idle ? UNKNOWN : 1 / NEARER; /* a little less gains little anyway */
        const double by = fmin(fmax(factor(s, loose), 1.0 / FARTHER), least);
        status = look(s, loose->tolerance * by, tight);
        *is_found = is_good(s, tight) || tight->found.is_out;
        if (status || *is_found)
            return status;
        idle = tight->found.worst < 1 && tight->found.worst > NOTHING_GAINED * loose->found.worst
                   ? idle + 1
                   : 0;
        *loose = *tight;
    }
    return status;
}

/* Looser, from one that is good or out of reach. *loose then fails; or there is none. */
static fp3_status loosen(seeker *s, point *tight, point *loose, int *is_found) {
    fp3_status status = FP3_OK;
    *is_found = 0;
    while (!status && s->looks < LOOKS_MOST && tight->tolerance < MOST) {
        const double by = tight->found.is_out ? 1 / UNKNOWN : factor(s, tight);
        status = look(s, tight->tolerance * fmin(fmax(by, NEARER), FARTHER), loose);
        *is_found = !is_good(s, loose) && !loose->found.is_out;
        if (status || *is_found)
            return status;
        *tight = *loose;
    }
    return status;
}

static fp3_status divide(seeker *s, point tight, point loose) {
    fp3_status status = FP3_OK;
    int may_guess = is_good(s, &tight);
    while (!status && s->looks < LOOKS_MOST && loose.tolerance > CLOSE * tight.tolerance) {
        if (is_good(s, &tight) && tight.found.made - loose.found.made < ALIKE * tight.found.made &&
            isfinite(loose.found.worst))
            break;
        if (!is_good(s, &tight) && is_hopeless(s, &loose))
            break;
        double next = sqrt(tight.tolerance * loose.tolerance);
        const double guess = tight.tolerance * factor(s, &tight);
        if (may_guess && guess > CLOSE * tight.tolerance && guess < loose.tolerance / CLOSE)
            next = guess;
        point middle;
        status = look(s, next, &middle);
        may_guess = is_good(s, &middle);
        if (is_good(s, &middle) || middle.found.is_out)
            tight = middle;
        else
            loose = middle;
    }
    return status;
}

static fp3_status seek(seeker *s) {
    point tight, loose;
    int is_found = 0;
    s->looks = 0;
    fp3_status status = look(s, s->search->target, &tight);
    if (status)
        return status;
    if (is_good(s, &tight) || tight.found.is_out)
        status = loosen(s, &tight, &loose, &is_found);
    else {
        loose = tight;
        status = tighten(s, &loose, &tight, &is_found);
    }
    return status || !is_found ? status : divide(s, tight, loose);
}

/* ---- what `absolute` is of ---- */

/* The mean over the sample of how large a state becomes. */
static double size_of(const fp3_sample *sample, uint32_t state) {
    double sum = 0;
    for (size_t i = 0; i < sample->count; i++)
        sum += sample->sizes[i * sample->model->state_count + state];
    return sum / (double)sample->count;
}

/* The smallest state asks for an `absolute` that larger ones are slow with where they cross 0.
 * Which one costs the least is not known beforehand. */
static unsigned find_sizes(const fp3_sample *sample, double sizes[SIZES]) {
    double least = INFINITY, most = 0;
    for (uint32_t i = 0; i < sample->model->state_count; i++) {
        const double size = size_of(sample, i);
        if (!(size > 0))
            continue;
        least = fmin(least, size);
        most = fmax(most, size);
    }
    sizes[0] = most > 0 ? least : 1;
    sizes[1] = sqrt(least * most);
    sizes[2] = most;
    return most > APART * least ? SIZES : 1;
}

static void explain(const seeker *s) {
    fp3_tune_row *row = s->row;
    if (row->is_met)
        snprintf(row->why, sizeof row->why, "meets the target");
    else if (isfinite(s->search->cheaper))
        snprintf(row->why, sizeof row->why,
                 "misses the target with %.0f attempts; more would cost more than the best so far",
                 s->most);
    else
        snprintf(row->why, sizeof row->why,
                 "misses the target with every tolerance that was tried");
}

fp3_status fp3_search_tolerance(const fp3_search *search, const fp3_candidate *candidate,
                                fp3_tune_row *row, fp3_error *error) {
    seeker s = {.search = search, .candidate = candidate, .row = row, .error = error};
    double sizes[SIZES];
    const unsigned count = find_sizes(search->sample, sizes);
    fp3_status status = FP3_OK;
    row->looks = 0;
    row->is_met = 0;
    row->tolerance = row->absolute = row->attempts = 0;
    row->lowest = row->error = INFINITY;
    s.most = find_most(&s);
    if (s.most < 1) {
        row->cycles = cycles(&s, 1);
        snprintf(row->why, sizeof row->why,
                 "skipped: one attempt costs more than the best so "
                 "far");
        return FP3_OK;
    }
    for (unsigned i = 0; !status && i < count; i++) {
        s.size = sizes[i];
        if (row->is_met)
            s.most = fmin(s.most, row->attempts);
        status = seek(&s);
    }
    explain(&s);
    return status;
}
