/* SPDX-License-Identifier: Apache-2.0 */
/* search.c - see search.h.
 *
 * The error falls with the power of the order until rounding stops it. So a look tells about how
 * many steps the target needs; what is left is bracketed and divided.
 */
#include "search.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#define LOOKS_MOST 24      /* runs of the sample for one candidate */
#define RESOLUTION 32      /* the fewest steps are found to 1/32 of them */
#define FARTHER 8          /* the most by which a guess multiplies steps */
#define NEARLY 30          /* an error so many targets large may be rounding: fewer steps may do */
#define HALVINGS 4         /* ... down to an eighth */
#define FAR 4              /* so many times where a search begins is no place to begin */
#define SMALL 0.1          /* from here on errors fall as the order says ... */
#define HOPELESS 4         /* ... and steps that need so many times the most are not tried */
#define MARGIN 1.03        /* of a guess, which else just misses */
#define NOTHING_GAINED 0.8 /* steps that leave so much of the error are spent on rounding */
#define GIVEN_UP 100       /* of so many steps one may go for a better end ... */
#define END 0.01           /* ... unless it is good to this share of the target */

typedef struct {
    const fp3_search *search;
    const fp3_candidate *candidate;
    fp3_tune_row *row;
    fp3_error *error;
    double most_attempts; /* of steps that are cut */
} seeker;

/* h is rounded to FP32, so that most numbers of steps end beside the span. Of the numbers from the
 * first to the last, the first that ends at it, or the one that ends nearest. */
static uint64_t find_end(const seeker *s, uint64_t first, uint64_t last) {
    const fp3_sample *sample = s->search->sample;
    uint64_t best = first;
    double least = INFINITY;
    if (s->candidate->is_cut)
        return first;
    for (uint64_t n = first;; n += first < last ? 1u : UINT64_MAX) {
        const double end = (double)n * (double)fp3_meter_h(sample, n, 0);
        const double late = fabs(end - sample->span);
        if (late < least) {
            best = n;
            least = late;
            if (fp3_sample_gap(sample, end) <= END * s->search->target)
                return n;
        }
        if (n == last)
            return best;
    }
}

/* A few less may end better. */
static uint64_t tidy(const seeker *s, double most) {
    const uint64_t steps = (uint64_t)fmax(1, ceil(most));
    return find_end(s, steps, steps - steps / GIVEN_UP);
}

static double cycles(const seeker *s, uint64_t steps) {
    return fp3_candidate_cycles(s->candidate, s->search->config, (double)steps);
}

void fp3_search_note(fp3_tune_row *row, double cost, double error) {
    row->lowest = fmin(row->lowest, error);
    if (row->looks < FP3_TUNE_LOOKS_MOST)
        row->look[row->looks++] = (fp3_tune_look){cost, error};
}

static fp3_status look(const seeker *s, uint64_t steps, double *found) {
    const fp3_search *q = s->search;
    const fp3_candidate *c = s->candidate;
    const fp3_stepping how = {.steps = steps, .most = s->most_attempts, .is_cut = c->is_cut};
    fp3_meter_found of;
    const fp3_status status =
        fp3_meter_read(q->meter, q->sample, s->candidate->measured, &how, &of, s->error);
    *found = of.worst;
    const double cost = c->is_cut ? fp3_candidate_cycles(c, q->config, of.made) : cycles(s, steps);
    fp3_search_note(s->row, cost, *found);
    const int is_met = *found <= q->target && cost < q->cheaper;
    if (!status && (is_met || (!s->row->is_met && (!s->row->steps || *found < s->row->error)))) {
        s->row->steps = steps;
        s->row->h = fp3_meter_h(q->sample, steps, c->is_cut);
        s->row->attempts = c->is_cut ? of.made : 0;
        s->row->error = *found;
        s->row->cycles = cost;
        s->row->is_met = is_met;
    }
    return status;
}

/* The most steps that cost less. */
static uint64_t most_below(const seeker *s, double limit) {
    uint64_t low = 0, high = FP3_STEPS_LIMIT;
    while (low < high) {
        const uint64_t middle = high - (high - low) / 2;
        if (cycles(s, middle) < limit)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* The most steps that are of interest; 0: not even the fewest. What is cut makes attempts beside
 * them. */
static uint64_t find_most(const seeker *s) {
    const uint64_t most = most_below(s, fmin(s->search->dearest, s->search->cheaper));
    return most ? tidy(s, (double)most) : 0;
}

/* By the order, even many more steps than are of interest are too few. */
static int is_hopeless(const seeker *s, uint64_t steps, uint64_t most, double error) {
    const unsigned order = s->candidate->measured->order;
    return error < SMALL &&
           (double)steps * pow(error / s->search->target, 1.0 / (order ? order : 1)) >
               HOPELESS * (double)most;
}

/* So many steps would meet the target if the error fell as the order says. */
static double guess(const seeker *s, uint64_t steps, double error) {
    const unsigned order = s->candidate->measured->order;
    if (!(error < 1))
        return 2.0 * (double)steps;
    const double factor = MARGIN * pow(error / s->search->target, 1.0 / (order ? order : 1));
    return (double)steps * fmin(factor, FARTHER);
}

/* Upwards from where the search begins. *low failed, *high met the target; 0: nothing did. */
static fp3_status climb(const seeker *s, uint64_t most, uint64_t *low, uint64_t *high) {
    uint64_t steps = s->search->first < most ? tidy(s, (double)s->search->first) : most;
    double last = INFINITY, error = INFINITY;
    unsigned idle = 0;
    fp3_status status = FP3_OK;
    while (!status && s->row->looks < LOOKS_MOST) {
        status = look(s, steps, &error);
        if (status || error <= s->search->target)
            break;
        *low = steps;
        idle = error < 1 && error > NOTHING_GAINED * last ? idle + 1 : 0;
        if (steps == most || idle == 2 || is_hopeless(s, steps, most, error))
            return FP3_OK;
        last = error;
        const double next = fmax(guess(s, steps, error), 1.25 * (double)steps);
        steps = next < (double)most ? tidy(s, next) : most;
    }
    *high = error <= s->search->target ? steps : 0;
    return status;
}

/* From the most steps that are of interest downwards, as far as rounding may be what stands in the
 * way. */
static fp3_status descend(const seeker *s, uint64_t most, uint64_t *high) {
    double error = INFINITY;
    fp3_status status = FP3_OK;
    *high = 0;
    for (unsigned i = 0; !status && i < HALVINGS; i++) {
        const uint64_t steps = i ? tidy(s, (double)most / (1u << i)) : most;
        status = look(s, steps, &error);
        if (!status && error <= s->search->target)
            *high = steps;
        if (*high || !(error < NEARLY * s->search->target) || steps == 1)
            break;
    }
    return status;
}

/* Where nothing is known, more steps may be what it takes, or fewer. */
static fp3_status roam(const seeker *s, uint64_t most, uint64_t *low, uint64_t *high) {
    const uint64_t first = s->search->first < most ? s->search->first : most;
    fp3_status status = climb(s, most, low, high);
    if (status || *high || first == 1)
        return status;
    *low = 0;
    return descend(s, tidy(s, (double)first / 2), high);
}

/* Between the two, guessing by the order first. */
static fp3_status divide(const seeker *s, uint64_t low, uint64_t high, double error) {
    fp3_status status = FP3_OK;
    while (!status && s->row->looks < LOOKS_MOST && high - low > 1 &&
           high - low > high / RESOLUTION) {
        double steps = sqrt((double)(low ? low : 1) * (double)high);
        if (error > 0 && error < s->search->target / 2)
            steps = fmax(guess(s, high, error), steps / 2);
        uint64_t next = tidy(s, fmax(steps, (double)low + 1));
        if (next >= high || next <= low)
            next = tidy(s, (double)(low + high) / 2);
        if (next >= high)
            next = high - 1;
        if (next <= low)
            break;
        double found = INFINITY;
        status = look(s, next, &found);
        if (found <= s->search->target) {
            high = next;
            error = found;
        } else {
            low = next;
            error = 0; /* a guess failed: halve */
        }
    }
    return status;
}

/* Or a few more than the fewest. */
static fp3_status end_well(const seeker *s, uint64_t most) {
    const uint64_t steps = s->row->steps, last = steps + steps / RESOLUTION;
    const uint64_t better = find_end(s, steps, last < most ? last : most);
    double error;
    return better == steps ? FP3_OK : look(s, better, &error);
}

static void explain(const seeker *s, uint64_t most) {
    fp3_tune_row *row = s->row;
    if (row->is_met)
        snprintf(row->why, sizeof row->why, "meets the target");
    else if (isfinite(s->search->cheaper) && s->candidate->is_cut)
        snprintf(row->why, sizeof row->why,
                 "misses the target with %" PRIu64
                 " steps and the steps at events; more would cost more than the best so far",
                 most);
    else if (isfinite(s->search->cheaper))
        snprintf(row->why, sizeof row->why,
                 "misses the target with %" PRIu64
                 " steps; more would cost more than the best so far",
                 most);
    else
        snprintf(row->why, sizeof row->why,
                 "misses the target with %" PRIu64 " steps, and by its order also with %" PRIu64
                 ", the most that are tried",
                 row->steps, most);
}

fp3_status fp3_search_steps(const fp3_search *search, const fp3_candidate *candidate,
                            fp3_tune_row *row, fp3_error *error) {
    seeker s = {search, candidate, row, error, 0};
    const uint64_t most = find_most(&s);
    if (candidate->is_cut)
        s.most_attempts = (double)most_below(&s, search->dearest);
    uint64_t low = 0, high = 0;
    row->looks = 0;
    row->is_met = 0;
    row->steps = 0;
    row->attempts = 0;
    row->lowest = row->error = INFINITY;
    if (!most) {
        row->cycles = cycles(&s, 1);
        snprintf(row->why, sizeof row->why, "skipped: one step costs more than the best so far");
        return FP3_OK;
    }
    const int is_bounded = isfinite(search->cheaper) && most <= FAR * search->first;
    fp3_status status = is_bounded ? descend(&s, most, &high) : roam(&s, most, &low, &high);
    if (!status && high)
        status = divide(&s, low, high, row->error);
    if (!status && high)
        status = end_well(&s, most);
    explain(&s, most);
    return status;
}
