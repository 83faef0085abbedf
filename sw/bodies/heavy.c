/* SPDX-License-Identifier: Apache-2.0 */
/* heavy.c - see heavy.h. */
#include "heavy.h"

#include "own3.h"
#include "share.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HEAVY 50.0 /* a body over the lightest of its set */
#define TREE 250.0 /* a tree of joints over the lightest of its bodies */
#define MOST 50    /* bodies of a set that is no tree */
#define HARD 1e5   /* the spring of what does not yield, over the heaviest body */
#define ROUND 1e10 /* ... and at most, over the lightest: else its mass is lost to rounding */

/* Energy that joints may make in half a substep.
 *
 * PULLED, of M u^2/2, where the heaviest body weighs M and joints pull together what is apart at
 * speed u: to bring a body of mass m to that speed takes m u^2/2, so all that weighs up to M/200
 * comes as fast as joints want it, and who weighs more comes by as much slower as the root of that.
 * MADE, of all kinetic energy: a row that holds is a spring of HARD M at most, in which an impulse
 * p keeps p^2/(2 HARD M), and lets it go later. One that stops the heaviest body keeps 1/HARD of
 * its energy. A tenth of it is allowed: impulses change by less within half a substep. LOST, of
 * p^2/M of all impulses p: sums of some hundred products in double, each of which is rounded by up
 * to 1.1e-16 of it. */
#define PULLED 0.005
#define MADE 1e-6
#define LOST 1e-14

typedef struct fp3_heavy_place {
    uint32_t root;        /* of its set; of a root itself */
    uint32_t bodies, all; /* of a set: bodies; joints, of which `held` with what does not move */
    uint32_t held;
    float mass, least, most;
    int is_in;
    int is_moved;               /* of a set: somebody moves, or a contact has had an impulse */
    uint32_t set, number, next; /* if it is in: of the set; among its bodies; the next of them */
} place;

/* The bodies of a joint, or of a row of contacts; whether any of them moves. */
static int ends_of(const fp3_bodies *bodies, uint32_t i, int is_contact, uint32_t ends[2]) {
    if (is_contact) {
        const fp3_law_rows *rows = bodies->space ? &bodies->space->contacts : &bodies->contacts;
        const fp3_ends2 *of = &rows->ends[rows->lane[i] / FP3_WIDE];
        ends[0] = of->a[rows->lane[i] % FP3_WIDE];
        ends[1] = of->b[rows->lane[i] % FP3_WIDE];
    } else {
        ends[0] = fp3_slot_of(bodies, bodies->joint[i].a);
        ends[1] = fp3_slot_of(bodies, bodies->joint[i].b);
    }
    return ends[0] < bodies->movable || ends[1] < bodies->movable;
}

/* ---- sets ---- */

static uint32_t set_of(place *places, uint32_t k) {
    while (places[k].root != k) {
        places[k].root = places[places[k].root].root;
        k = places[k].root;
    }
    return k;
}

static void unite(place *places, uint32_t a, uint32_t b) {
    a = set_of(places, a);
    b = set_of(places, b);
    place *first = &places[a < b ? a : b], *second = &places[a < b ? b : a];
    first->all++;
    if (a == b)
        return;
    second->root = first->root;
    first->bodies += second->bodies;
    first->all += second->all;
    first->held += second->held;
    first->mass += second->mass;
    first->least = fminf(first->least, second->least);
    first->most = fmaxf(first->most, second->most);
    first->is_moved |= second->is_moved;
}

static void unite_joint(const fp3_bodies *bodies, uint32_t i, place *places) {
    uint32_t ends[2];
    if (!bodies->heavy->laws->holds(&bodies->joint[i]) || !ends_of(bodies, i, 0, ends))
        return;
    if (ends[0] < bodies->movable && ends[1] < bodies->movable)
        unite(places, ends[0], ends[1]);
    else
        places[set_of(places, ends[ends[0] < bodies->movable ? 0 : 1])].held++;
}

static void begin_sets(const fp3_bodies *bodies, place *places) {
    for (uint32_t k = 0; k < bodies->movable; k++) {
        const float mass = bodies->body[bodies->in_slot[k]].mass;
        places[k] = (place){.root = k,
                            .bodies = 1,
                            .mass = mass,
                            .least = mass,
                            .most = mass,
                            .set = FP3_NOBODY,
                            .is_moved = bodies->heavy->laws->is_moving(bodies, k),
                            .is_in = places[k].is_in};
    }
}

static int is_heavy_tree(const place *set) {
    return set->all + 1 == set->bodies && set->held <= 1 &&
           (double)set->mass > TREE * (double)set->least;
}

static int is_heavy(const place *set) {
    return set->bodies <= MOST && ((double)set->most > HEAVY * (double)set->least ||
                                   (!set->is_moved && set->all + set->held > 0));
}

/* Whether any body is in a heavy set. */
static int find_sets(fp3_bodies *bodies, place *places) {
    float least = INFINITY, most = 0;
    int is_any = 0;
    for (uint32_t k = 0; k < bodies->movable; k++) {
        const float mass = bodies->body[bodies->in_slot[k]].mass;
        least = fminf(least, mass);
        most = fmaxf(most, mass);
        places[k].is_in = 0;
    }
    begin_sets(bodies, places);
    for (uint32_t i = 0; i < bodies->joint_count; i++)
        unite_joint(bodies, i, places);
    for (uint32_t k = 0; k < bodies->movable && bodies->joints; k++)
        is_any |= places[k].is_in = is_heavy_tree(&places[set_of(places, k)]);
    int may_be = is_any || (double)most > HEAVY * (double)least;
    for (uint32_t k = 0; k < bodies->movable; k++)
        may_be |= !places[k].is_moved;
    if (!may_be)
        return 0;
    for (uint32_t i = 0; i < fp3_rows_count(bodies); i++) {
        uint32_t ends[2];
        ends_of(bodies, i, 1, ends);
        if (ends[0] < bodies->movable && ends[1] < bodies->movable)
            unite(places, ends[0], ends[1]);
        place *set = &places[set_of(places, ends[ends[0] < bodies->movable ? 0 : 1])];
        set->held++;
        set->is_moved |= bodies->heavy->laws->has_pushed(bodies, i);
    }
    for (uint32_t k = 0; k < bodies->movable; k++)
        is_any |= places[k].is_in |= is_heavy(&places[set_of(places, k)]);
    return is_any;
}

/* Of which all bodies that move are in heavy sets; else nothing. */
static fp3_status put_link(fp3_bodies *bodies, uint32_t i, int is_contact) {
    fp3_heavy *h = bodies->heavy;
    fp3_heavy_link link = {.of = i, .is_contact = is_contact, .next = FP3_NOBODY};
    uint32_t *const number[2] = {&link.a, &link.b}, set = 0;
    ends_of(bodies, i, is_contact, link.slot);
    for (int k = 0; k < 2; k++) {
        const place *p = link.slot[k] < bodies->movable ? &h->place[link.slot[k]] : NULL;
        *number[k] = p ? p->number : FP3_NO_SPRING;
        if (p && !p->is_in)
            return FP3_OK;
        set = p ? p->set : set;
    }
    const fp3_status status = fp3_bodies_room((void **)&h->link, &h->link_room, sizeof *h->link,
                                              h->links + 1u, bodies->error);
    if (status)
        return status;
    fp3_heavy_set *of = &h->set[set];
    *(of->links ? &h->link[of->last_link].next : &of->first_link) = h->links;
    of->last_link = h->links;
    of->links++;
    link.ratio = of->ratio;
    h->laws->begin(bodies, &link);
    h->laws->forget(bodies, &link);
    h->link[h->links++] = link;
    if (!is_contact)
        bodies->joint[i].is_heavy = 1;
    return FP3_OK;
}

static fp3_status put_links(fp3_bodies *bodies) {
    fp3_status status = FP3_OK;
    uint32_t ends[2];
    for (uint32_t i = 0; !status && i < bodies->joint_count; i++)
        if (bodies->heavy->laws->holds(&bodies->joint[i]) && ends_of(bodies, i, 0, ends))
            status = put_link(bodies, i, 0);
    for (uint32_t i = 0; !status && i < fp3_rows_count(bodies); i++)
        status = put_link(bodies, i, 1);
    return status;
}

static fp3_status make_room(fp3_bodies *bodies) {
    if (!bodies->heavy)
        bodies->heavy = calloc(1, sizeof *bodies->heavy);
    fp3_heavy *h = bodies->heavy;
    if (!h)
        return fp3_no_memory(bodies->error);
    return fp3_bodies_room((void **)&h->place, &h->place_room, sizeof *h->place,
                           bodies->movable + 1u, bodies->error);
}

/* Sets have numbers in the order of their first bodies; bodies in that of their slots. */
static fp3_status number_bodies(fp3_bodies *bodies) {
    fp3_heavy *h = bodies->heavy;
    for (uint32_t k = 0; k < bodies->movable; k++) {
        place *own = &h->place[k], *root = &h->place[set_of(h->place, k)];
        if (!own->is_in)
            continue;
        if (root->set == FP3_NOBODY) {
            const fp3_status status = fp3_bodies_room((void **)&h->set, &h->set_room,
                                                      sizeof *h->set, h->sets + 1u, bodies->error);
            if (status)
                return status;
            root->set = h->sets++;
            h->set[root->set] = (fp3_heavy_set){
                .first_body = k,
                .hardest = fmin(HARD * (double)root->most, ROUND * (double)root->least),
                .ratio = (double)root->most / (double)root->least};
        }
        fp3_heavy_set *set = &h->set[root->set];
        if (set->bodies)
            h->place[set->last_body].next = k;
        set->last_body = k;
        own->set = root->set;
        own->number = set->bodies++;
        own->next = FP3_NOBODY;
    }
    return FP3_OK;
}

fp3_status fp3_heavy_find(fp3_bodies *bodies, const fp3_heavy_laws *laws, float rate) {
    fp3_status status = make_room(bodies);
    fp3_heavy *h = bodies->heavy;
    if (status)
        return status;
    h->links = h->sets = 0;
    h->laws = laws;
    h->rate = (double)rate;
    for (uint32_t i = 0; i < bodies->joint_count; i++)
        bodies->joint[i].is_heavy = 0;
    if (!find_sets(bodies, h->place))
        return FP3_OK;
    status = number_bodies(bodies);
    return status ? status : put_links(bodies);
}

void fp3_heavy_free(fp3_bodies *bodies) {
    fp3_heavy *h = bodies->heavy;
    if (!h)
        return;
    fp3_springs_free(&h->springs);
    free(h->set);
    free(h->link);
    free(h->place);
    free(h->other);
    free(h);
    bodies->heavy = NULL;
}

/* ---- a substep ---- */

void fp3_heavy_forget(fp3_bodies *bodies) {
    const fp3_heavy *h = bodies->heavy;
    for (uint32_t i = 0; i < h->links; i++)
        bodies->heavy->laws->forget(bodies, &h->link[i]);
}

void fp3_heavy_end(fp3_bodies *bodies) {
    const fp3_heavy *h = bodies->heavy;
    for (uint32_t i = 0; i < h->links; i++)
        if (h->link[i].is_contact)
            h->laws->end(bodies, &h->link[i]);
}

void fp3_heavy_hold(fp3_bodies *bodies) {
    const fp3_heavy *h = bodies->heavy;
    const uint32_t fours = bodies->space ? FP3_FOURS3 : 1;
    for (uint32_t i = 0; i < h->links; i++)
        for (int k = 0; k < 2 && !h->link[i].is_contact; k++)
            bodies->pull[fours * h->link[i].slot[k]].drop = (fp3_four){0};
}

/* What a body does that no force moves. */
static double given(const fp3_bodies *bodies, uint32_t number, uint32_t slot, const double *by) {
    double v[FP3_SPARSE_MOST], sum = 0;
    if (number != FP3_NO_SPRING)
        return 0;
    bodies->heavy->laws->speed(bodies, slot, v);
    for (uint32_t i = 0; i < bodies->heavy->springs.size; i++)
        sum += v[i] * by[i];
    return sum;
}

fp3_spring *fp3_heavy_put(fp3_bodies *bodies, fp3_heavy_link *link, const fp3_heavy_row *of) {
    fp3_springs *s = &bodies->heavy->springs;
    fp3_spring *row = fp3_springs_add(s, link->a, link->b, of->word, &link->was[of->which]);
    memcpy(row->of_a, of->of_a, s->size * sizeof *row->of_a);
    memcpy(row->of_b, of->of_b, s->size * sizeof *row->of_b);
    row->k = fmin(of->k, row->k);
    row->want = of->want;
    row->given = given(bodies, link->a, link->slot[0], of->of_a) +
                 given(bodies, link->b, link->slot[1], of->of_b);
    row->c = (of->keeps_before ? row->before : 0) - row->k * (row->want + row->given);
    return row;
}

/* As contact2.ode: along the normal, while there is a gap, no faster than to close it; in an
 * overlap a soft push. */
fp3_spring *fp3_heavy_push(fp3_bodies *bodies, fp3_heavy_link *link, fp3_heavy_row of, double gap,
                           int push) {
    const int is_soft = push && !(gap > 0);
    of.k = is_soft ? link->mass[of.which] * link->stiff : INFINITY;
    of.want = gap > 0 ? gap * (bodies->def.substeps / bodies->def.h)
              : push  ? fmax(link->rate * gap, -bodies->def.push)
                      : 0;
    of.keeps_before = !is_soft;
    fp3_spring *row = fp3_heavy_put(bodies, link, &of);
    row->least = 0;
    row->now = push ? link->held[of.which] : row->before;
    return row;
}

void fp3_heavy_drive(fp3_bodies *bodies, fp3_heavy_link *link, const fp3_drive3 *d, int which,
                     float words[4], const double *of_a, const double *of_b, int push) {
    const double inverse = bodies->def.substeps / bodies->def.h,
                 rate = push && !bodies->heavy->is_calm ? bodies->heavy->rate : 0;
    const double gaps[2] = {d->over, d->under};
    double back_a[FP3_SPARSE_MOST], back_b[FP3_SPARSE_MOST];
    for (uint32_t i = 0; i < bodies->heavy->springs.size; i++) {
        back_a[i] = -of_a[i];
        back_b[i] = -of_b[i];
    }
    if (d->is_firm || d->soft.soft > 0) {
        const fp3_heavy_row row = {which,
                                   &words[0],
                                   of_a,
                                   of_b,
                                   d->is_firm ? INFINITY
                                              : (double)d->mass * d->soft.soft / d->soft.fade,
                                   d->off * (d->is_firm ? rate : (double)d->soft.rate),
                                   d->is_firm};
        fp3_heavy_put(bodies, link, &row)->is_driven = !d->is_firm;
    }
    if (d->most > 0) {
        const fp3_heavy_row row = {which + 1, &words[1], of_a, of_b, INFINITY, -d->speed, 1};
        fp3_spring *motor = fp3_heavy_put(bodies, link, &row);
        motor->is_driven = 1;
        motor->most = d->most;
        motor->least = -motor->most;
    }
    for (int i = 0; i < 2; i++) {
        const fp3_heavy_row row = {which + 2 + i,
                                   &words[2 + i],
                                   i ? back_a : of_a,
                                   i ? back_b : of_b,
                                   INFINITY,
                                   gaps[i] * (gaps[i] > 0 ? inverse : rate),
                                   1};
        if (gaps[i] < FP3_NO_LIMIT3)
            fp3_heavy_put(bodies, link, &row)->least = 0;
    }
}

static void put_body(fp3_bodies *bodies, uint32_t slot, uint32_t n) {
    const fp3_heavy *h = bodies->heavy;
    const uint32_t number = h->place[slot].number;
    double *mass = &h->springs.mass[number * n * n];
    memset(mass, 0, n * n * sizeof *mass);
    h->laws->weigh(bodies, slot, mass);
    h->laws->speed(bodies, slot, &h->springs.start[number * n]);
}

static int find(fp3_bodies *bodies, const fp3_heavy_set *set, int push, int is_calm) {
    fp3_heavy *h = bodies->heavy;
    h->is_calm = is_calm;
    h->springs.rows = 0;
    for (uint32_t k = set->first_body; k != FP3_NOBODY; k = h->place[k].next)
        put_body(bodies, k, h->springs.size);
    for (uint32_t i = set->first_link; i != FP3_NOBODY; i = h->link[i].next)
        h->laws->fill(bodies, &h->link[i], push);
    return fp3_springs_solve(&h->springs);
}

/* ---- energy ---- */

/* Of all bodies' motion: what it was, and how much more it is. */
typedef struct {
    double before, more, heaviest;
} energy;

static energy energy_of(const fp3_bodies *bodies, const fp3_heavy_set *set) {
    const fp3_heavy *h = bodies->heavy;
    const uint32_t n = h->springs.size;
    energy sum = {0, 0, 0};
    for (uint32_t k = set->first_body; k != FP3_NOBODY; k = h->place[k].next) {
        const size_t first = (size_t)h->place[k].number * n;
        const double *from = h->springs.start + first, *to = h->springs.v + first;
        double mass[FP3_SPARSE_MOST * FP3_SPARSE_MOST] = {0};
        h->laws->weigh(bodies, k, mass);
        sum.heaviest = fmax(sum.heaviest, mass[0]);
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t j = 0; j < n; j++) {
                sum.before += 0.5 * mass[i * n + j] * from[i] * from[j];
                sum.more += 0.5 * mass[i * n + j] * (to[i] - from[i]) * (to[j] + from[j]);
            }
    }
    return sum;
}

static int is_turn(const fp3_springs *s, const fp3_spring *row) {
    double sum = 0;
    for (uint32_t i = 0; i < (s->size == 3 ? 2 : 3); i++)
        sum += fabs(row->of_a[i]) + fabs(row->of_b[i]);
    return !(sum > 0);
}

/* What nobody gave: neither motors, springs and belts, nor who moves by itself. *may: how much that
 * may be, where contacts push apart what overlaps and joints pull together what is apart. */
static double made(const fp3_bodies *bodies, const fp3_heavy_set *set, double *may) {
    const fp3_springs *s = &bodies->heavy->springs;
    const energy all = energy_of(bodies, set);
    double sum = all.more, squares = 0, pull = 0, push = 0;
    for (uint32_t i = 0; i < s->rows; i++) {
        const fp3_spring *row = &s->row[i];
        const double by = row->now - row->before,
                     fast = is_turn(s, row) ? bodies->def.size * row->want : row->want;
        squares += row->now * row->now;
        sum -=
            row->is_driven
                ? 0.5 * by * (fp3_springs_speed(s, row, s->start) + fp3_springs_speed(s, row, s->v))
                : -by * row->given;
        if (!row->is_driven && row->least == 0)
            push = fmax(push, -fast);
        else if (!row->is_driven)
            pull = fmax(pull, fabs(fast));
    }
    *may = 0.5 * all.heaviest * (push * push + PULLED * pull * pull) + MADE * all.before +
           LOST * squares / all.heaviest;
    return sum;
}

/* Between what was found first (share 1) and what is there (0). */
static void mix(fp3_heavy *h, double share) {
    fp3_springs *s = &h->springs;
    const uint32_t count = s->count * s->size;
    for (uint32_t i = 0; i < count; i++)
        s->v[i] += share * (h->other[i] - s->v[i]);
    for (uint32_t i = 0; i < s->rows; i++)
        s->row[i].now += share * (h->other[count + i] - s->row[i].now);
}

static fp3_status note(fp3_bodies *bodies) {
    fp3_heavy *h = bodies->heavy;
    const fp3_springs *s = &h->springs;
    const uint32_t count = s->count * s->size;
    const fp3_status status = fp3_bodies_room((void **)&h->other, &h->other_room, sizeof *h->other,
                                              (size_t)count + s->rows, bodies->error);
    if (status)
        return status;
    memcpy(h->other, s->v, count * sizeof *h->other);
    for (uint32_t i = 0; i < s->rows; i++)
        h->other[count + i] = s->row[i].now;
    return FP3_OK;
}

/* With less and less of what made the energy, until it is what may be: it is a square of the share.
 */
static void take_back(fp3_bodies *bodies, const fp3_heavy_set *set, double most, double may) {
    double unused;
    const double least = made(bodies, set, &unused);
    if (!(least < may))
        return;
    mix(bodies->heavy, 0.5);
    const double a = 2 * (most + least) - 4 * made(bodies, set, &unused), b = most - least - a,
                 root = sqrt(fmax(b * b + 4 * a * (may - least), 0)),
                 share = 2 * (may - least) / (b + root);
    mix(bodies->heavy, 2 * share - 1); /* from the middle */
}

/* Joints make energy where they contradict each other: what would satisfy all is far and fast. So
 * does a light body that resists for a while as a heavy one. */
static fp3_status calm(fp3_bodies *bodies, const fp3_heavy_set *set, int push, int *is_found) {
    double may;
    const double most = *is_found ? made(bodies, set, &may) : 0;
    if (*is_found && most <= may)
        return FP3_OK;
    const int was_found = *is_found;
    const fp3_status status = note(bodies);
    if (status)
        return status;
    *is_found = find(bodies, set, push, 1);
    if (*is_found && was_found)
        take_back(bodies, set, most, may);
    return FP3_OK;
}

static int has_joints(const fp3_heavy *h, const fp3_heavy_set *set) {
    return !h->link[set->first_link].is_contact; /* they come first */
}

/* ---- all sets ---- */

static fp3_status solve(fp3_bodies *bodies, const fp3_heavy_set *set, int push) {
    fp3_heavy *h = bodies->heavy;
    fp3_springs *s = &h->springs;
    const uint32_t n = bodies->space ? 6 : 3;
    fp3_springs_begin(s, set->bodies, n, set->hardest);
    fp3_status status = FP3_OK;
    for (uint32_t i = set->first_link; !status && i != FP3_NOBODY; i = h->link[i].next)
        if (h->link[i].a != FP3_NO_SPRING && h->link[i].b != FP3_NO_SPRING)
            status = fp3_sparse_meet(&s->sparse, h->link[i].a, h->link[i].b, bodies->error);
    if (!status)
        status = fp3_springs_make_room(s, (size_t)set->links * sizeof h->link->was, bodies->error);
    if (status)
        return status;
    int is_found = find(bodies, set, push, 0);
    if (has_joints(h, set))
        status = calm(bodies, set, push, &is_found);
    if (status || !is_found)
        return status;
    fp3_springs_keep(s);
    for (uint32_t k = set->first_body; k != FP3_NOBODY; k = h->place[k].next) {
        double change[FP3_SPARSE_MOST];
        for (uint32_t i = 0; i < n; i++)
            change[i] = s->v[h->place[k].number * n + i] - s->start[h->place[k].number * n + i];
        h->laws->move(bodies, k, change);
    }
    return FP3_OK;
}

fp3_status fp3_heavy_solve(fp3_bodies *bodies, int push) {
    fp3_heavy *h = bodies->heavy;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < h->sets; i++)
        if (h->set[i].links && fp3_share_has(bodies, h->set[i].first_body, h->set[i].first_body))
            status = solve(bodies, &h->set[i], push);
    return status;
}
