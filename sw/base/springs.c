/* SPDX-License-Identifier: Apache-2.0 */
/* springs.c - see springs.h. */
#include "springs.h"

#include "room.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TRIES 200      /* of Newton's method */
#define SHARES 40      /* of a way that is too long */
#define LIMITS 4       /* how often limits of friction follow */
#define NEARLY 1e-3    /* of a limit that needs not follow */
#define DIGITS 1e-7    /* ... of c, which is far larger: times ROUNDED what double keeps of it */
#define ROUNDED 1e-8   /* of all impulses: what may be missing of momentum */
#define HUNDREDTHS 100 /* of a direction that is kept */
#define TURNED 1e-6    /* rad: what slides in another direction needs another matrix */

void fp3_springs_begin(fp3_springs *s, uint32_t count, uint32_t size, double hardest) {
    s->count = count;
    s->size = size;
    s->hardest = hardest;
    s->rows = 0;
    fp3_sparse_begin(&s->sparse, count, size);
}

fp3_status fp3_springs_make_room(fp3_springs *s, size_t rows, fp3_error *error) {
    const size_t numbers = (size_t)(s->count + 1u) * s->size;
    const struct {
        void **array;
        uint32_t *room;
        size_t size, count;
    } all[] = {{(void **)&s->row, &s->row_room, sizeof *s->row, rows + 1},
               {(void **)&s->mass, &s->mass_room, sizeof *s->mass, numbers * s->size},
               {(void **)&s->v, &s->v_room, sizeof *s->v, numbers},
               {(void **)&s->start, &s->start_room, sizeof *s->start, numbers},
               {(void **)&s->slope, &s->slope_room, sizeof *s->slope, numbers},
               {(void **)&s->way, &s->way_room, sizeof *s->way, numbers},
               {(void **)&s->next, &s->next_room, sizeof *s->next, numbers}};
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < sizeof all / sizeof *all; i++)
        status = fp3_room(all[i].array, all[i].room, all[i].size, all[i].count, error);
    return status ? status : fp3_sparse_order(&s->sparse, error);
}

fp3_spring *fp3_springs_add(fp3_springs *s, uint32_t a, uint32_t b, float *word, int8_t *was) {
    fp3_spring *row = &s->row[s->rows++];
    *row = (fp3_spring){.a = a,
                        .b = b,
                        .k = s->hardest,
                        .least = -INFINITY,
                        .most = INFINITY,
                        .normal = FP3_NO_SPRING,
                        .normals = 1,
                        .before = (double)*word,
                        .word = word,
                        .was = was};
    return row;
}

static double dot(const double *a, const double *b, uint32_t size) {
    double sum = 0;
    for (uint32_t i = 0; i < size; i++)
        sum += a[i] * b[i];
    return sum;
}

double fp3_springs_speed(const fp3_springs *s, const fp3_spring *row, const double *v) {
    double speed = 0;
    if (row->a != FP3_NO_SPRING)
        speed += dot(row->of_a, &v[row->a * s->size], s->size);
    if (row->b != FP3_NO_SPRING)
        speed += dot(row->of_b, &v[row->b * s->size], s->size);
    return speed;
}

static void add(const fp3_springs *s, const fp3_spring *row, double by, double *to) {
    for (uint32_t i = 0; row->a != FP3_NO_SPRING && i < s->size; i++)
        to[row->a * s->size + i] += by * row->of_a[i];
    for (uint32_t i = 0; row->b != FP3_NO_SPRING && i < s->size; i++)
        to[row->b * s->size + i] += by * row->of_b[i];
}

/* Whether a row has come to a limit or left one. */
static int look_at(const fp3_springs *s, fp3_spring *row, const double *v, int is_guess) {
    const double wanted = row->c - row->k * fp3_springs_speed(s, row, v);
    const int side = is_guess ? *row->was : (wanted > row->most) - (wanted < row->least);
    row->now = side > 0 ? row->most : side < 0 ? row->least : wanted;
    const int is_new = row->side != side;
    row->side = side;
    return is_new;
}

/* What is wanted beyond the edge comes back to it along the radius. Then less is at stake across
 * that direction, and nothing along it; it is another matrix where the direction is another. */
static int look_at_disc(const fp3_springs *s, fp3_spring *row, const double *v, int is_guess) {
    fp3_spring *other = row + 1;
    const double x = row->c - row->k * fp3_springs_speed(s, row, v),
                 y = other->c - other->k * fp3_springs_speed(s, other, v),
                 size = sqrt(x * x + y * y);
    const int side = is_guess ? *row->was || *other->was : size > row->most;
    const double to_x = is_guess ? *row->was : x, to_y = is_guess ? *other->was : y,
                 over = side ? 1 / sqrt(to_x * to_x + to_y * to_y) : 0;
    const double off_x = over * to_x - row->along, off_y = over * to_y - other->along;
    const int is_new =
        row->side != side || (row->most > 0 && off_x * off_x + off_y * off_y > TURNED * TURNED);
    row->side = other->side = side;
    row->along = over * to_x;
    other->along = over * to_y;
    row->bent = size > row->most ? row->most / size : 1;
    row->now = side ? row->most * row->along : x;
    other->now = side ? row->most * other->along : y;
    return is_new;
}

/* Impulses at these speeds, and the momentum that they lack: the slope. Whether any row has come to
 * a limit or left one. is_guess: rows stay where they were at last. */
static int look(fp3_springs *s, const double *v, int is_guess) {
    int is_new = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        double change[FP3_SPARSE_MOST];
        for (uint32_t k = 0; k < s->size; k++)
            change[k] = v[i * s->size + k] - s->start[i * s->size + k];
        for (uint32_t k = 0; k < s->size; k++)
            s->slope[i * s->size + k] = dot(&s->mass[(i * s->size + k) * s->size], change, s->size);
    }
    for (uint32_t i = 0; i < s->rows; i++) {
        fp3_spring *row = &s->row[i];
        is_new |= row->is_disc ? look_at_disc(s, row, v, is_guess) : look_at(s, row, v, is_guess);
        add(s, row, row->before - row->now, s->slope);
        if (row->is_disc) {
            add(s, row + 1, row[1].before - row[1].now, s->slope);
            i++;
        }
    }
    return is_new;
}

/* Limits of friction; whether one is another by more than a share. Where an impulse depends on the
 * friction that follows it, this is the secant's method. */
static int limit(fp3_springs *s) {
    int is_new = 0;
    for (uint32_t i = 0; i < s->rows; i++) {
        fp3_spring *row = &s->row[i];
        if (row->normal == FP3_NO_SPRING)
            continue;
        double load = s->row[row->normal].now;
        for (uint32_t k = 1; k < row->normals; k++)
            load += s->row[row->normal + k].now;
        const double now = row->share * fmax(load, 0), most = row->most, way = most - row->last,
                     rise = way != 0 ? (now - row->last_now) / way : 0;
        is_new |= fabs(now - most) > NEARLY * fmax(now, most);
        row->most = most + (now - most) / (1 - fmin(rise, 0));
        row->least = -row->most;
        row->last = most;
        row->last_now = now;
    }
    return is_new;
}

static void add_block(double *to, const double *a, const double *b, double k, uint32_t size) {
    for (uint32_t i = 0; i < size; i++)
        for (uint32_t j = 0; j < size; j++)
            to[i * size + j] += k * a[i] * b[j];
}

/* A row that is at no limit. */
static void put_row(fp3_springs *s, const fp3_spring *r, double k) {
    const uint32_t n = s->size;
    int is_swapped;
    if (r->a != FP3_NO_SPRING)
        add_block(fp3_sparse_block(&s->sparse, r->a, r->a, &is_swapped), r->of_a, r->of_a, k, n);
    if (r->b != FP3_NO_SPRING)
        add_block(fp3_sparse_block(&s->sparse, r->b, r->b, &is_swapped), r->of_b, r->of_b, k, n);
    if (r->a == FP3_NO_SPRING || r->b == FP3_NO_SPRING)
        return;
    double *both = fp3_sparse_block(&s->sparse, r->a, r->b, &is_swapped);
    add_block(both, is_swapped ? r->of_b : r->of_a, is_swapped ? r->of_a : r->of_b, k, n);
}

/* At the edge of a disc: the row across its direction. */
static fp3_spring across(const fp3_springs *s, const fp3_spring *row) {
    const fp3_spring *other = row + 1;
    fp3_spring made = {.a = row->a, .b = row->b};
    for (uint32_t i = 0; i < s->size; i++) {
        made.of_a[i] = row->along * other->of_a[i] - other->along * row->of_a[i];
        made.of_b[i] = row->along * other->of_b[i] - other->along * row->of_b[i];
    }
    return made;
}

/* The matrix of all that are at no limit. */
static int factor(fp3_springs *s) {
    const uint32_t n = s->size;
    int is_swapped;
    fp3_sparse_clear(&s->sparse);
    for (uint32_t i = 0; i < s->count; i++)
        memcpy(fp3_sparse_block(&s->sparse, i, i, &is_swapped), &s->mass[i * n * n],
               n * n * sizeof(double));
    for (uint32_t i = 0; i < s->rows; i++) {
        const fp3_spring *r = &s->row[i];
        if (!r->side)
            put_row(s, r, r->k);
        else if (r->is_disc) {
            const fp3_spring edge = across(s, r);
            put_row(s, &edge, r->k * r->bent);
        }
    }
    return fp3_sparse_factor(&s->sparse);
}

/* How fast what is missing along the way changes there. */
static double bend(const fp3_springs *s) {
    double sum = 0;
    for (uint32_t i = 0; i < s->count; i++)
        for (uint32_t k = 0; k < s->size; k++)
            sum += s->way[i * s->size + k] *
                   dot(&s->mass[(i * s->size + k) * s->size], &s->way[i * s->size], s->size);
    for (uint32_t i = 0; i < s->rows; i++) {
        const fp3_spring *row = &s->row[i];
        const double speed = row->side ? 0 : fp3_springs_speed(s, row, s->way);
        sum += row->k * speed * speed;
        if (row->side && row->is_disc) {
            const double over = row->along * fp3_springs_speed(s, row + 1, s->way) -
                                row[1].along * fp3_springs_speed(s, row, s->way);
            sum += row->k * row->bent * over * over;
        }
    }
    return sum;
}

/* Along the way what is missing falls at first; where it would rise, the way ends: by Newton's
 * method between two shares of it. Whether any row has come to a limit or left one. */
static int go(fp3_springs *s) {
    const uint32_t count = s->count * s->size;
    double from = 0, to = 1, share = 1;
    int is_new = 0;
    for (int i = 0; i < SHARES; i++) {
        for (uint32_t k = 0; k < count; k++)
            s->next[k] = s->v[k] + share * s->way[k];
        is_new |= look(s, s->next, 0);
        const double rise = dot(s->slope, s->way, count);
        if (!is_new || (rise <= 0 && share == 1))
            break;
        *(rise > 0 ? &to : &from) = share;
        const double next = share - rise / bend(s);
        if (!(fabs(next - share) > 1e-9 * share))
            break;
        share = next > from && next < to ? next : (from + to) / 2;
    }
    memcpy(s->v, s->next, count * sizeof *s->v);
    return is_new;
}

/* Numbers first .. end - 1 of bodies, which are of one kind. */
static int are_rounded(const fp3_springs *s, uint32_t first, uint32_t end) {
    double all = 0, left = 0;
    for (uint32_t k = first; k < end; k++) {
        for (uint32_t i = 0; i < s->rows; i++)
            all += (fabs(s->row[i].now) + (s->row[i].side ? 0 : DIGITS * fabs(s->row[i].c))) *
                   (fabs(s->row[i].of_a[k]) + fabs(s->row[i].of_b[k]));
        for (uint32_t i = 0; i < s->count; i++)
            left = fmax(left, fabs(s->slope[i * s->size + k]));
    }
    return left <= ROUNDED * all;
}

/* What is missing of momentum, and of angular momentum, is no more than rounding. */
static int is_rounded(const fp3_springs *s) {
    const uint32_t ways = s->size == 3 ? 2 : 3;
    return are_rounded(s, 0, ways) && are_rounded(s, ways, s->size);
}

int fp3_springs_solve(fp3_springs *s) {
    const uint32_t count = s->count * s->size;
    int is_new = 1, is_other = 1, exact = 0, limits = 0;
    memcpy(s->v, s->start, count * sizeof *s->v);
    limit(s);
    look(s, s->v, 1);
    /* Once more when all is found: what was rounded is mended. */
    for (int i = 0; i < TRIES && (exact < 2 || is_other); i++) {
        if (is_new && !factor(s))
            return 0;
        for (uint32_t k = 0; k < count; k++)
            s->way[k] = -s->slope[k];
        fp3_sparse_solve(&s->sparse, s->way);
        is_new = go(s);
        exact = is_new && !is_rounded(s) ? 0 : exact + 1;
        is_other = exact && limits < LIMITS && limit(s);
        if (is_other) {
            is_new = look(s, s->v, 0);
            limits++;
        }
    }
    const int is_found = exact > 1 && !is_other;
    for (uint32_t i = 0; i < s->rows; i++) {
        const fp3_spring *row = &s->row[i];
        const int is_of_disc = row->is_disc || (i > 0 && s->row[i - 1].is_disc);
        const double part = fabs(row->along) <= 1 ? HUNDREDTHS * row->along : 0;
        *row->was = (int8_t)(is_of_disc ? lround(part) : row->side);
    }
    return is_found;
}

void fp3_springs_keep(const fp3_springs *s) {
    for (uint32_t i = 0; i < s->rows; i++)
        *s->row[i].word = (float)s->row[i].now;
}

void fp3_springs_free(fp3_springs *s) {
    void *const all[] = {s->row, s->mass, s->v, s->start, s->slope, s->way, s->next};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
    fp3_sparse_free(&s->sparse);
}
