/* SPDX-License-Identifier: Apache-2.0 */
/* shapes.c - the shapes of a body in a scene. */
#include "read.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum {
    CIRCLE,
    BOX,
    CAPSULE,
    POLYGON,
    CHAIN,
    SPHERE,
    HULL,
    PLANE,
    MESH,
    HEIGHTS,
    KINDS
} kind;

static const char *const kinds[] = {"circle", "box",  "capsule", "polygon", "chain",
                                    "sphere", "hull", "plane",   "mesh",    "heights"};
static const char expected[] =
    "one of circle = RADIUS, box = [HALF_X, HALF_Y], capsule = ([X, Y], "
    "[X, Y]), polygon = (...) and chain = (...); in space of sphere, "
    "box, capsule, hull = (...), plane = NORMAL, mesh = ... and heights = ...";

/* A number of fp3_shape_def. */
typedef struct {
    const char *name;
    size_t at;
} number;

static const number numbers[] = {{"radius", offsetof(fp3_shape_def, radius)},
                                 {"angle", offsetof(fp3_shape_def, angle)},
                                 {"density", offsetof(fp3_shape_def, density)},
                                 {"friction", offsetof(fp3_shape_def, friction)},
                                 {"restitution", offsetof(fp3_shape_def, restitution)},
                                 {"rolling", offsetof(fp3_shape_def, rolling)},
                                 {"belt", offsetof(fp3_shape_def, belt)}};

static fp3_status find_kind(const fp3_reader *r, const config_setting_t *from, kind *found) {
    *found = KINDS;
    for (int i = 0; i < KINDS; i++)
        if (config_setting_get_member(from, kinds[i])) {
            if (*found != KINDS)
                return fp3_setting_wrong(r->in, from, "shape: found both %s and %s, expected %s",
                                         kinds[*found], kinds[i], expected);
            *found = (kind)i;
        }
    return *found == KINDS ? fp3_setting_wrong(r->in, from, "shape: expected %s", expected)
                           : FP3_OK;
}

/* What only some shapes have. */
static fp3_status check_fit(const fp3_reader *r, const config_setting_t *from, kind is) {
    static const struct {
        const char *name;
        unsigned of;
    } some[] = {{"radius", 1u << BOX | 1u << CAPSULE | 1u << POLYGON | 1u << CHAIN | 1u << HULL},
                {"centre", 1u << CIRCLE | 1u << BOX | 1u << SPHERE | 1u << PLANE},
                {"angle", 1u << BOX},
                {"q", 1u << BOX},
                {"loop", 1u << CHAIN},
                {"spacing", 1u << HEIGHTS}};
    for (size_t i = 0; i < sizeof some / sizeof *some; i++) {
        const config_setting_t *at = config_setting_get_member(from, some[i].name);
        if (at && !(some[i].of >> is & 1))
            return fp3_setting_wrong(r->in, at, "%s: a %s has none%s", some[i].name, kinds[is],
                                     is == CIRCLE ? " but circle = RADIUS" : "");
    }
    return FP3_OK;
}

static fp3_status read_bits(fp3_reader *r, const config_setting_t *from, const char *name,
                            uint32_t *bits) {
    const config_setting_t *at = config_setting_get_member(from, name);
    uint64_t found = *bits;
    const fp3_status status =
        at ? fp3_setting_count(r->in, at, name, 0, UINT32_MAX, &found) : FP3_OK;
    *bits = (uint32_t)found;
    return status;
}

/* All but the form. */
static fp3_status read_surface(fp3_reader *r, const config_setting_t *from, fp3_shape_def *def) {
    static const char *const plane[] = {"circle", "polygon", "chain", "angle", "belt", NULL};
    static const char *const space[] = {"sphere",  "hull", "plane",   "mesh",
                                        "heights", "q",    "surface", NULL};
    fp3_status status = fp3_read_fits(r, from, plane, space);
    for (size_t i = 0; !status && i < sizeof numbers / sizeof *numbers; i++)
        status = fp3_read_value(r, from, numbers[i].name,
                                (double *)(void *)((char *)def + numbers[i].at));
    if (!status)
        status = fp3_read_place(r, from, "centre", def->centre);
    if (!status)
        status = fp3_read_turn(r, from, def->q);
    if (!status)
        status = fp3_read_place(r, from, "surface", def->surface);
    if (!status)
        status = read_bits(r, from, "category", &def->category);
    if (!status)
        status = read_bits(r, from, "mask", &def->mask);
    return status ? status : fp3_read_flag(r, from, "is_sensor", &def->is_sensor);
}

static fp3_status take_corners(const fp3_reader *r, const config_setting_t *at, const char *what,
                               const double *corners, size_t count, fp3_shape_def *def) {
    const int most = r->dimensions == 3 ? FP3_HULL_CORNERS : FP3_CORNERS;
    if (count > (size_t)most)
        return fp3_setting_wrong(r->in, at, "%s: found %zu corners, expected at most %d", what,
                                 count, most);
    def->corners = (uint32_t)count;
    for (size_t k = 0; k < count; k++)
        memcpy(def->corner[k], corners + r->dimensions * k, r->dimensions * sizeof *corners);
    return FP3_OK;
}

static fp3_status read_form(fp3_reader *r, const config_setting_t *at, kind is,
                            fp3_shape_def *def) {
    double *corners = NULL;
    size_t count = 0;
    if (is == CIRCLE)
        return fp3_read_number(r, at, "circle", &def->radius);
    if (is == SPHERE) {
        def->type = FP3_SPHERE;
        return fp3_read_number(r, at, "sphere", &def->radius);
    }
    if (is == PLANE) {
        def->type = FP3_PLANE;
        return fp3_read_point(r, at, "plane", def->normal);
    }
    if (is == BOX) {
        def->type = FP3_BOX;
        return fp3_read_point(r, at, "box", def->half);
    }
    def->type = is == CAPSULE ? FP3_CAPSULE : is == HULL ? FP3_HULL : FP3_POLYGON;
    fp3_status status = fp3_read_corners(r, at, kinds[is], &corners, &count);
    if (!status)
        status = take_corners(r, at, kinds[is], corners, count, def);
    free(corners);
    return status;
}

static fp3_status attach_chain(fp3_reader *r, const config_setting_t *from, uint64_t handle,
                               const fp3_shape_def *surface) {
    const config_setting_t *at = config_setting_get_member(from, "chain");
    double *corners = NULL;
    size_t count = 0;
    int is_loop = 0;
    fp3_status status = fp3_read_flag(r, from, "loop", &is_loop);
    if (!status)
        status = fp3_read_corners(r, at, "chain", &corners, &count);
    if (!status) {
        status =
            fp3_bodies_attach_chain(r->scene->bodies, handle, corners, count, is_loop, surface);
        status = status ? fp3_read_refused(r, from, "chain", status) : FP3_OK;
    }
    free(corners);
    return status;
}

static fp3_status read_shape(fp3_reader *r, const config_setting_t *from, uint64_t handle) {
    static const char *const names[] = {
        "circle",   "box",   "capsule",   "polygon",  "chain",   "loop",        "radius",
        "centre",   "angle", "density",   "friction", "rolling", "restitution", "belt",
        "category", "mask",  "is_sensor", "sphere",   "hull",    "plane",       "q",
        "surface",  "mesh",  "heights",   "spacing",  NULL};
    kind is;
    fp3_shape_def def = fp3_shape_circle(0);
    if (!config_setting_is_group(from))
        return fp3_setting_expected(r->in, from, "shapes",
                                    "a shape, { box = [0.5, 0.5]; friction = 0.4; }, or a list");
    fp3_status status = fp3_setting_keys(r->in, from, "a shape", names);
    if (!status)
        status = find_kind(r, from, &is);
    if (!status)
        status = check_fit(r, from, is);
    if (!status)
        status = read_surface(r, from, &def);
    if (!status && is == CHAIN)
        return attach_chain(r, from, handle, &def);
    if (!status && is == MESH)
        return fp3_read_mesh(r, from, handle, &def);
    if (!status && is == HEIGHTS)
        return fp3_read_heights(r, from, handle, &def);
    if (!status)
        status = read_form(r, config_setting_get_member(from, kinds[is]), is, &def);
    if (status)
        return status;
    status = fp3_bodies_attach(r->scene->bodies, &handle, 1, &def, NULL);
    return status ? fp3_read_refused(r, from, kinds[is], status) : FP3_OK;
}

/* `shapes` are all of a body's; of `one_of` each copy has one, in turn. */
fp3_status fp3_read_shapes(fp3_reader *r, const config_setting_t *entry, uint64_t handle) {
    const config_setting_t *all = config_setting_get_member(entry, "shapes");
    const config_setting_t *some = config_setting_get_member(entry, "one_of");
    fp3_status status = FP3_OK;
    if (all && config_setting_is_group(all))
        status = read_shape(r, all, handle);
    else if (all && !config_setting_is_list(all))
        status = read_shape(r, all, handle); /* it says what is expected */
    for (int i = 0; !status && all && config_setting_is_list(all) && i < config_setting_length(all);
         i++)
        status = read_shape(r, config_setting_get_elem(all, (unsigned)i), handle);
    if (status || !some)
        return status;
    if (!config_setting_is_list(some) || config_setting_length(some) < 1)
        return fp3_setting_expected(r->in, some, "one_of", "a list of shapes, ( { ... }, ... )");
    const double count = config_setting_length(some);
    return read_shape(r, config_setting_get_elem(some, (unsigned)fmod(r->number, count)), handle);
}
