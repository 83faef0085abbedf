/* SPDX-License-Identifier: Apache-2.0 */
/* planes.c - see planes.h. */
#include "planes.h"

#include "base/unit.h"

#include <math.h>
#include <string.h>

#define MARGIN 0.05 /* of a range, above and below the data */

/* ---- ranges ---- */

fp3_range fp3_range_of(const double *values, size_t count) {
    fp3_range r = {INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(values[i]))
            continue;
        r.from = fmin(r.from, values[i]);
        r.to = fmax(r.to, values[i]);
    }
    if (r.from > r.to)
        return (fp3_range){-1, 1};
    /* Halves, so that no difference is infinite. */
    double margin = 2 * MARGIN * (r.to / 2 - r.from / 2);
    if (!(margin > 1e-9 * fmax(fabs(r.from), fabs(r.to))))
        margin = fmax(fabs(r.to) * MARGIN, 1e-30);
    r = (fp3_range){r.from - margin, r.to + margin};
    return isfinite(r.from) && isfinite(r.to) ? r : (fp3_range){-8e307, 8e307};
}

fp3_range fp3_range_joined(fp3_range a, fp3_range b) {
    return (fp3_range){fmin(a.from, b.from), fmax(a.to, b.to)};
}

/* ---- what names are ---- */

static const fp3_column *column(const fp3_subject *s, size_t name) {
    return &s->columns->list[name];
}

static int is_state(const fp3_column *c) {
    return c->kind == FP3_COLUMN_STATE || c->kind == FP3_COLUMN_SUM;
}

static uint32_t state_of(const fp3_subject *s, size_t name) {
    const fp3_model *model = s->program->model;
    return model ? fp3_model_state(model, column(s, name)->name) : FP3_NONE;
}

static int has_velocity(const fp3_subject *s, size_t name) {
    const uint32_t state = state_of(s, name);
    return state != FP3_NONE && s->program->model->states[state].velocity != FP3_NONE;
}

static int is_velocity_of(const fp3_subject *s, size_t name, size_t of) {
    return has_velocity(s, of) &&
           s->program->model->states[state_of(s, of)].velocity == state_of(s, name);
}

static int is_velocity(const fp3_subject *s, size_t name) {
    const fp3_model *model = s->program->model;
    const uint32_t state = state_of(s, name);
    for (uint32_t i = 0; state != FP3_NONE && i < model->state_count; i++)
        if (model->states[i].velocity == state)
            return 1;
    return 0;
}

/* By its unit; without one, a state whose derivative is another state, and which is no such
 * derivative itself. */
static int is_position(const fp3_subject *s, size_t name) {
    const char *unit = column(s, name)->unit;
    return *unit && strcmp(unit, "1") != 0 ? fp3_unit_is_length(unit)
                                           : has_velocity(s, name) && !is_velocity(s, name);
}

size_t fp3_planes_prefix(const char *name) {
    const size_t length = strlen(name);
    return length > 1 ? length - 1 - (name[length - 2] == '_') : 0;
}

/* Of letters before the last and the last itself. */
static int is_component(const char *name, char axis) {
    const size_t length = strlen(name);
    return name[length - 1] == axis && (length == 1 || (length > 2 && name[length - 2] == '_'));
}

/* One scale is theirs: the same unit; without units, components of one vector or two positions. */
static int is_alike(const fp3_subject *s, size_t a, size_t b) {
    const char *of = column(s, a)->name, *with = column(s, b)->name;
    const size_t prefix = strlen(of) - 1;
    if (strcmp(column(s, a)->unit, column(s, b)->unit) != 0)
        return 0;
    return *column(s, a)->unit || (is_position(s, a) && is_position(s, b)) ||
           (prefix && strlen(with) == prefix + 1 && !strncmp(of, with, prefix) &&
            of[prefix - 1] == '_');
}

size_t fp3_planes_vector(const fp3_subject *s, size_t name) {
    const char *first = column(s, name)->name;
    size_t count = 1;
    if (!is_component(first, 'x'))
        return 1;
    for (; count < 3 && name + count < s->columns->count; count++) {
        const char *next = column(s, name + count)->name;
        if (!is_component(next, "xyz"[count]) || strlen(next) != strlen(first) ||
            strncmp(next, first, strlen(first) - 1) != 0 || !is_alike(s, name, name + count))
            break;
    }
    return count;
}

/* ---- orbits ---- */

static fp3_range range_along(const fp3_figure *f, size_t name) {
    const size_t count = f->object_count * f->points;
    return fp3_range_of(f->values + name * count, count);
}

static double extent(const fp3_figure *f, const size_t *vectors, size_t count, size_t axis) {
    fp3_range r = range_along(f, vectors[0] + axis);
    for (size_t i = 1; i < count; i++)
        r = fp3_range_joined(r, range_along(f, vectors[i] + axis));
    return r.to - r.from;
}

/* Of three components the two with the widest ranges, in their order. */
static void choose_axes(const fp3_figure *f, const size_t *vectors, size_t count, size_t components,
                        size_t axes[2]) {
    double wide[3] = {0};
    size_t least = 2;
    for (size_t i = 0; i < components && components == 3; i++)
        wide[i] = extent(f, vectors, count, i);
    for (size_t i = 3; i-- > 0 && components == 3;)
        least = wide[i] < wide[least] ? i : least;
    axes[0] = least == 0 ? 1 : 0;
    axes[1] = least == 2 ? 1 : 2;
}

static int is_orbit(const fp3_subject *s, size_t name) {
    const size_t count = fp3_planes_vector(s, name);
    int is = count > 1;
    for (size_t i = 0; i < count; i++)
        is &= is_position(s, name + i);
    return is;
}

/* The vector that begins at name and those like it, unless it is like one before. */
static int find_orbit(const fp3_figure *f, size_t name, fp3_plane *plane) {
    const fp3_subject *s = f->subject;
    size_t vectors[FP3_CURVES_MOST], axes[2];
    *plane = (fp3_plane){.is_orbit = 1, .has_one_scale = 1};
    if (!is_orbit(s, name))
        return 0;
    const size_t components = fp3_planes_vector(s, name);
    for (size_t i = 0; i < s->columns->count && plane->count < FP3_CURVES_MOST; i++) {
        if (!is_orbit(s, i) || fp3_planes_vector(s, i) != components || !is_alike(s, i, name))
            continue;
        if (i < name)
            return 0;
        vectors[plane->count++] = i;
    }
    choose_axes(f, vectors, plane->count, components, axes);
    for (size_t i = 0; i < plane->count; i++) {
        plane->x[i] = vectors[i] + axes[0];
        plane->y[i] = vectors[i] + axes[1];
    }
    return 1;
}

/* ---- phase planes ---- */

static int is_in_orbit(const fp3_subject *s, size_t name) {
    for (size_t i = 0; i <= name; i++)
        if (is_orbit(s, i) && name < i + fp3_planes_vector(s, i))
            return 1;
    return 0;
}

static fp3_plane plane_of(const fp3_subject *s, size_t x, size_t y) {
    return (fp3_plane){.x = {x}, .y = {y}, .count = 1, .has_one_scale = is_alike(s, x, y)};
}

size_t fp3_planes_find(const fp3_figure *f, fp3_plane planes[FP3_PLANES_MOST]) {
    const fp3_subject *s = f->subject;
    const size_t names =
        s->columns->count - (column(s, s->columns->count - 1)->kind == FP3_COLUMN_LIFE);
    size_t count = 0;
    for (size_t i = 0; i < names && count < FP3_PLANES_MOST; i++)
        count += (size_t)find_orbit(f, i, &planes[count]);
    for (size_t x = 0; x < names; x++)
        for (size_t y = 0; y < names && count < FP3_PLANES_MOST; y++)
            if (is_velocity_of(s, y, x) && !is_in_orbit(s, x))
                planes[count++] = plane_of(s, x, y);
    if (!count && names == 2 && is_state(column(s, 0)) && is_state(column(s, 1)))
        planes[count++] = plane_of(s, 0, 1);
    return count;
}
