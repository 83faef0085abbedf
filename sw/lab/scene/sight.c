/* SPDX-License-Identifier: Apache-2.0 */
/* sight.c - see sight.h. Near objects are found by a sweep along one axis. */
#include "sight.h"

#include "base/host.h"
#include "world/values_own.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SKIN                                                                                       \
    0.2 /* of the reach: how much farther lists go, so that they are good for some steps           \
         */

static size_t entries(const fp3_crowd_sight *s, const fp3_crowd_group *g) {
    return s->begin[g->objects];
}

static fp3_status take_fields(const fp3_crowd_sight *s, size_t count, double **fields,
                              fp3_error *error) {
    *fields = calloc(s->field_count * count + 1, sizeof **fields);
    return *fields ? FP3_OK : fp3_no_memory(error);
}

/* ---- links ---- */

/* The value of a field of a link; without one, the model's. */
static double field_of(const fp3_links *links, const fp3_quantity *field, size_t link) {
    for (size_t i = 0; i < links->field_count; i++)
        if (strcmp(links->names[i], field->name) == 0 && !isnan(links->fields[i][link]))
            return links->fields[i][link];
    return field->value;
}

/* The list that each end has: with another group only the first end's. Places are counted first. */
static void put_links(fp3_crowd_sight *s, const fp3_crowd_group *g, const fp3_relation *r,
                      const fp3_links *links, size_t count) {
    const int ends = r->of_kind == FP3_NONE ? 2 : 1;
    for (size_t i = 0; i < links->count; i++)
        for (int k = 0; k < ends; k++) {
            const uint32_t own = k ? links->b[i] : links->a[i],
                           other = k ? links->a[i] : links->b[i];
            const size_t at = s->begin[own]++;
            if (!s->who)
                continue;
            s->who[at] = other;
            for (uint32_t f = 0; f < s->field_count; f++)
                s->fields[f * count + at] =
                    field_of(links, &g->model->fields[r->first_field + f], i);
        }
}

/* From numbers of entries, or ends, to the beginnings. */
static void begin(fp3_crowd_sight *s, size_t objects, int is_count) {
    size_t sum = 0;
    for (size_t i = 0; is_count && i <= objects; i++) {
        const size_t more = i < objects ? s->begin[i] : 0;
        s->begin[i] = sum;
        sum += more;
    }
    for (size_t i = objects; !is_count && i > 0; i--)
        s->begin[i] = s->begin[i - 1];
    if (!is_count)
        s->begin[0] = 0;
}

static fp3_status link_all(fp3_crowd_sight *s, const fp3_crowd_group *g, const fp3_relation *r,
                           fp3_error *error) {
    const fp3_linked *linked = fp3_linked_find(g->of->params->linked, r->name);
    const size_t seen = s->room;
    if (!linked)
        return fp3_fail(error, FP3_E_ARGUMENT, "group '%s': links of '%s' are missing", g->of->name,
                        r->name);
    for (size_t i = 0; i < linked->links.count; i++)
        if (linked->links.a[i] >= g->objects || linked->links.b[i] >= seen)
            return fp3_fail(error, FP3_E_ARGUMENT, "group '%s': links of '%s': no such object",
                            g->of->name, r->name);
    put_links(s, g, r, &linked->links, 0);
    begin(s, g->objects, 1);
    const size_t count = entries(s, g);
    s->who = calloc(count + 1, sizeof *s->who);
    fp3_status status = s->who ? take_fields(s, count, &s->fields, error) : fp3_no_memory(error);
    if (!status)
        status = take_fields(s, count, &s->next, error);
    if (status)
        return status;
    s->room = count;
    put_links(s, g, r, &linked->links, count);
    begin(s, g->objects, 0);
    return FP3_OK;
}

/* ---- near objects ---- */

static fp3_status find_reach(fp3_crowd_sight *s, const fp3_crowd_group *g, const fp3_relation *r,
                             fp3_error *error) {
    const fp3_model *m = g->model;
    double *room = calloc(m->expr_count + m->param_count + m->state_count + 1u, sizeof *room);
    if (!room)
        return fp3_no_memory(error);
    double *params = room + m->expr_count, *states = params + m->param_count;
    for (uint32_t p = 0; p < m->param_count && g->objects; p++)
        params[p] = g->params[p * g->objects];
    fp3_model_evaluate(m, &(fp3_point){.params = params, .states = states}, room);
    s->reach = room[r->reach];
    free(room);
    return FP3_OK;
}

static fp3_status open_group(fp3_crowd *crowd, uint32_t group, fp3_error *error) {
    fp3_crowd_group *g = &crowd->groups[group];
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < g->model->relation_count; i++) {
        const fp3_relation *r = &g->model->relations[i];
        fp3_crowd_sight *s = &g->sights[i];
        const size_t seen = crowd->groups[s->group].objects;
        if (r->kind == FP3_ALL)
            continue;
        s->field_count = r->field_count;
        s->begin = calloc(g->objects + 2, sizeof *s->begin);
        if (!s->begin)
            return fp3_no_memory(error);
        if (r->kind == FP3_LINKS) {
            s->room = seen;
            status = link_all(s, g, r, error);
            continue;
        }
        s->own = calloc(r->dimensions * g->objects + 1, sizeof *s->own);
        s->theirs = calloc(r->dimensions * seen + 1, sizeof *s->theirs);
        status = s->own && s->theirs ? find_reach(s, g, r, error) : fp3_no_memory(error);
    }
    return status;
}

fp3_status fp3_sight_open(fp3_crowd *crowd, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < crowd->group_count; k++)
        status = open_group(crowd, k, error);
    return status;
}

typedef struct {
    double place; /* on the axis */
    size_t object;
} stand;

/* What a relation of near objects looks at. */
typedef struct {
    const fp3_relation *r;
    fp3_crowd_sight *s;
    const fp3_crowd_group *g, *other;
    const double *own[3], *theirs[3], *radius, *their_radius; /* radii: NULL: none */
    stand *order;                                             /* of the others along the axis */
    unsigned axis;
    double far; /* the largest radius of the others */
} look;

static look look_at(const fp3_crowd *crowd, double *const *states, const fp3_crowd_group *g,
                    uint32_t relation) {
    const fp3_relation *r = &g->model->relations[relation];
    look l = {.r = r, .s = &g->sights[relation], .g = g};
    l.other = &crowd->groups[l.s->group];
    const uint32_t first = r->of_kind == FP3_NONE ? r->position : r->theirs;
    for (uint32_t k = 0; k < r->dimensions && k < 3; k++) {
        l.own[k] = states[g - crowd->groups] + (r->position + k) * g->objects;
        l.theirs[k] = fp3_crowd_theirs(crowd, states, g, r, 0, first + k);
    }
    if (r->radius != FP3_NONE)
        l.radius = g->params + r->radius * g->objects;
    if (r->their_radius != FP3_NONE)
        l.their_radius = fp3_crowd_theirs(crowd, states, g, r, 1, r->their_radius);
    for (size_t j = 0; l.their_radius && j < l.other->objects; j++)
        l.far = fmax(l.far, l.their_radius[j]);
    return l;
}

static int has_moved(size_t objects, unsigned axes, const double *const *now, const double *then,
                     double way) {
    for (size_t i = 0; i < objects; i++) {
        double square = 0;
        for (unsigned k = 0; k < axes; k++) {
            const double d = now[k][i] - then[k * objects + i];
            square += d * d;
        }
        if (!(square <= way * way))
            return 1;
    }
    return 0;
}

static int is_stale(const look *l) {
    const double way = l->s->skin / 2;
    return !l->s->who || has_moved(l->g->objects, l->r->dimensions, l->own, l->s->own, way) ||
           (l->other != l->g &&
            has_moved(l->other->objects, l->r->dimensions, l->theirs, l->s->theirs, way));
}

static int by_place(const void *a, const void *b) {
    const double p = ((const stand *)a)->place, q = ((const stand *)b)->place;
    return (p > q) - (p < q);
}

static int by_number(const void *a, const void *b) {
    const uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
    return (p > q) - (p < q);
}

/* The others in order along the axis on which they are farthest apart. */
static fp3_status sort(look *l, fp3_error *error) {
    const size_t n = l->other->objects;
    double most = -1;
    l->order = calloc(n + 1, sizeof *l->order);
    if (!l->order)
        return fp3_no_memory(error);
    for (unsigned k = 0; k < l->r->dimensions; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t j = 0; j < n; j++) {
            low = fmin(low, l->theirs[k][j]);
            high = fmax(high, l->theirs[k][j]);
        }
        if (high - low > most) {
            most = high - low;
            l->axis = k;
        }
    }
    for (size_t j = 0; j < n; j++)
        l->order[j] = (stand){l->theirs[l->axis][j], j};
    qsort(l->order, n, sizeof *l->order, by_place);
    return FP3_OK;
}

static int is_candidate(const look *l, size_t i, size_t j) {
    const double reach = l->s->reach + l->s->skin + (l->radius ? l->radius[i] : 0) +
                         (l->their_radius ? l->their_radius[j] : 0);
    double square = 0;
    for (unsigned k = 0; k < l->r->dimensions; k++)
        square += (l->theirs[k][j] - l->own[k][i]) * (l->theirs[k][j] - l->own[k][i]);
    return square < reach * reach && (l->other != l->g || i != j);
}

static fp3_status append(fp3_crowd_sight *s, size_t at, size_t who, fp3_error *error) {
    if (at == s->room) {
        const size_t room = 2 * s->room + 64;
        uint32_t *more = realloc(s->who, room * sizeof *more);
        if (!more)
            return fp3_no_memory(error);
        s->who = more;
        s->room = room;
    }
    s->who[at] = (uint32_t)who;
    return FP3_OK;
}

static int remembers(const fp3_crowd_sight *s, size_t entry, size_t entries) {
    for (uint32_t f = 0; f < s->field_count; f++)
        if (s->fields[f * entries + entry] != 0)
            return 1;
    return 0;
}

/* Only the end of a step makes a pair forget: until then it stays, however far it is. */
static fp3_status keep(const look *l, size_t i, const size_t *old_begin, const uint32_t *old_who,
                       size_t *at, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t e = old_begin[i]; !status && e < old_begin[i + 1]; e++)
        if (remembers(l->s, e, old_begin[l->g->objects]) && !is_candidate(l, i, old_who[e])) {
            status = append(l->s, *at, old_who[e], error);
            *at += !status;
        }
    return status;
}

/* The candidates of one object. */
static fp3_status gather(const look *l, size_t i, const size_t *old_begin, const uint32_t *old_who,
                         size_t *at, fp3_error *error) {
    const double x = l->own[l->axis][i];
    const double way = l->s->reach + l->s->skin + (l->radius ? l->radius[i] : 0) + l->far;
    size_t low = 0, high = l->other->objects;
    fp3_status status = FP3_OK;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (l->order[middle].place < x - way)
            low = middle + 1;
        else
            high = middle;
    }
    const size_t first = *at;
    for (; !status && low < l->other->objects && l->order[low].place <= x + way; low++)
        if (is_candidate(l, i, l->order[low].object)) {
            status = append(l->s, *at, l->order[low].object, error);
            *at += !status;
        }
    if (!status)
        status = keep(l, i, old_begin, old_who, at, error);
    if (*at - first > 1)
        qsort(l->s->who + first, *at - first, sizeof *l->s->who, by_number);
    return status;
}

/* What pairs remember goes from the list of before to the new one. */
static fp3_status carry(const look *l, const size_t *old_begin, const uint32_t *old_who,
                        fp3_error *error) {
    fp3_crowd_sight *s = l->s;
    const size_t objects = l->g->objects, old = old_begin[objects], count = s->begin[objects];
    double *fields = NULL, *next = NULL;
    fp3_status status = take_fields(s, count, &fields, error);
    if (!status)
        status = take_fields(s, count, &next, error);
    for (size_t i = 0; !status && i < objects; i++)
        for (size_t a = old_begin[i], b = s->begin[i]; a < old_begin[i + 1] && b < s->begin[i + 1];)
            if (old_who[a] != s->who[b]) {
                old_who[a] < s->who[b] ? a++ : b++;
            } else {
                for (uint32_t f = 0; f < s->field_count; f++)
                    fields[f * count + b] = s->fields[f * old + a];
                a++, b++;
            }
    if (status) {
        free(fields);
        free(next);
        return status;
    }
    free(s->fields);
    free(s->next);
    s->fields = fields;
    s->next = next;
    return FP3_OK;
}

static void note(size_t objects, unsigned axes, const double *const *now, double *then) {
    for (unsigned k = 0; k < axes; k++)
        memcpy(then + k * objects, now[k], objects * sizeof *then);
}

static fp3_status make(look *l, fp3_error *error) {
    fp3_crowd_sight *s = l->s;
    size_t *old_begin = s->begin, at = 0;
    uint32_t *old_who = s->who;
    double most = l->far;
    for (size_t i = 0; l->radius && i < l->g->objects; i++)
        most = fmax(most, l->radius[i] + l->far);
    s->skin = SKIN * (s->reach + most);
    s->begin = calloc(l->g->objects + 2, sizeof *s->begin);
    s->who = NULL;
    s->room = 0;
    fp3_status status = s->begin ? append(s, 0, 0, error) : fp3_no_memory(error);
    if (!status)
        status = sort(l, error);
    for (size_t i = 0; !status && i < l->g->objects; i++) {
        if (!l->g->is_stopped[i])
            status = gather(l, i, old_begin, old_who, &at, error);
        s->begin[i + 1] = at;
    }
    if (!status)
        status = carry(l, old_begin, old_who, error);
    note(l->g->objects, l->r->dimensions, l->own, s->own);
    note(l->other->objects, l->r->dimensions, l->theirs, s->theirs);
    free(l->order);
    free(old_begin);
    free(old_who);
    return status;
}

void fp3_sight_forget(fp3_crowd *crowd) {
    for (uint32_t k = 0; k < crowd->group_count; k++)
        for (uint32_t i = 0; i < crowd->groups[k].model->relation_count; i++)
            if (crowd->groups[k].sights[i].own)
                crowd->groups[k].sights[i].own[0] = NAN;
}

fp3_status fp3_sight_look(fp3_crowd *crowd, double *const *states, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; k < crowd->group_count; k++) {
        const fp3_crowd_group *g = &crowd->groups[k];
        for (uint32_t i = 0; !status && i < g->model->relation_count; i++) {
            if (g->model->relations[i].kind != FP3_NEAR)
                continue;
            look l = look_at(crowd, states, g, i);
            if (is_stale(&l))
                status = make(&l, error);
        }
    }
    return status;
}
