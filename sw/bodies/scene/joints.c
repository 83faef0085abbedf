/* SPDX-License-Identifier: Apache-2.0 */
/* joints.c - the joints of a scene, between bodies by their names. */
#include "read.h"

#include "base/nearest.h"
#include "bodies/turn.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const types[] = {
    [FP3_ROD] = "rod",   [FP3_HINGE] = "hinge", [FP3_SLIDER] = "slider", [FP3_WHEEL] = "wheel",
    [FP3_WELD] = "weld", [FP3_GEAR] = "gear",   [FP3_BALL] = "ball"};
#define TYPES (sizeof types / sizeof *types)

typedef struct {
    const char *name;
    size_t at;
} number;

static const number numbers[] = {
    {"ratio", offsetof(fp3_joint_def, ratio)},     {"speed", offsetof(fp3_joint_def, speed)},
    {"most", offsetof(fp3_joint_def, most)},       {"hertz", offsetof(fp3_joint_def, hertz)},
    {"damping", offsetof(fp3_joint_def, damping)}, {"rest", offsetof(fp3_joint_def, rest)},
    {"force", offsetof(fp3_joint_def, force)},     {"torque", offsetof(fp3_joint_def, torque)}};

/* ---- who is joined ---- */

static fp3_status no_body(const fp3_reader *r, const config_setting_t *at, const char *what,
                          const char *text, size_t length) {
    const fp3_token wanted = {.text = text, .length = length, .kind = FP3_TOKEN_NAME};
    const char *near = NULL;
    for (size_t i = 0; i < r->scene->entry_count; i++)
        if (*r->scene->entries[i].name)
            fp3_nearest(wanted, r->scene->entries[i].name, &near);
    return fp3_setting_wrong(r->in, at, "%s: found '%.*s', expected the name of a body%s%s%s", what,
                             (int)length, text, near ? " (did you mean '" : "", near ? near : "",
                             near ? "'?)" : "");
}

/* "door", or of several copies "link[n + 1]". */
static fp3_status find_body(fp3_reader *r, const config_setting_t *at, const char *what,
                            uint64_t *handle) {
    const fp3_bodies_scene *scene = r->scene;
    const fp3_bodies_entry *entry = NULL;
    const char *text = NULL;
    fp3_status status = fp3_setting_text(r->in, at, what, &text);
    if (status)
        return status;
    const size_t length = strcspn(text, "[");
    for (size_t i = 0; !entry && i < scene->entry_count; i++)
        if (length && !strncmp(scene->entries[i].name, text, length) &&
            !scene->entries[i].name[length])
            entry = &scene->entries[i];
    if (!entry)
        return no_body(r, at, what, text, length);
    double which = 0;
    const size_t end = strlen(text);
    if (text[length] && (text[end - 1] != ']' || end - length < 3))
        return fp3_setting_wrong(r->in, at, "%s: found '%s', expected %s[NUMBER]", what, text,
                                 entry->name);
    if (!text[length] && entry->count != 1)
        return fp3_setting_wrong(r->in, at,
                                 "%s: there are %zu bodies '%s', expected %s[NUMBER], from 0 on",
                                 what, entry->count, entry->name, entry->name);
    if (text[length])
        status = fp3_read_formula_part(r, at, what, text + length + 1, end - length - 2, &which);
    if (!status && !(which >= 0 && which < (double)entry->count && floor(which) == which))
        status = fp3_setting_wrong(r->in, at, "%s: found %s[%.9g], and there are %s[0] to %s[%zu]",
                                   what, entry->name, which, entry->name, entry->name,
                                   entry->count ? entry->count - 1 : 0);
    if (!status)
        *handle = scene->handles[entry->first + (size_t)which];
    return status;
}

/* The type is the name of the setting that names both bodies. */
static fp3_status find_bodies(fp3_reader *r, const config_setting_t *from, fp3_joint_def *def) {
    const config_setting_t *found = NULL;
    for (size_t i = 0; i < TYPES; i++) {
        const config_setting_t *at = config_setting_get_member(from, types[i]);
        if (at && found)
            return fp3_setting_wrong(r->in, at, "joint: found both %s and %s, expected one type",
                                     types[def->type], types[i]);
        if (at) {
            def->type = (fp3_joint_type)i;
            found = at;
        }
    }
    if (!found)
        return fp3_setting_wrong(r->in, from,
                                 "joint: expected rod, hinge, slider, wheel, weld, ball or "
                                 "gear with two bodies, as hinge = [\"a\", \"b\"]");
    if (!fp3_setting_is_list(found) || config_setting_length(found) != 2)
        return fp3_setting_expected(r->in, found, types[def->type],
                                    "the names of two bodies, [\"a\", \"b\"]");
    fp3_status status = find_body(r, config_setting_get_elem(found, 0), types[def->type], &def->a);
    return status ? status
                  : find_body(r, config_setting_get_elem(found, 1), types[def->type], &def->b);
}

/* ---- where ---- */

/* A way of the world in the axes of a body in space, which is turned by a quaternion of length 1.
 */
static void turn_back(const double q[4], const double way[3], double made[3]) {
    double t[3];
    for (int k = 0; k < 3; k++) {
        const int m = (k + 1) % 3, n = (k + 2) % 3;
        t[k] = 2 * (q[1 + m] * way[n] - q[1 + n] * way[m]);
    }
    for (int k = 0; k < 3; k++) {
        const int m = (k + 1) % 3, n = (k + 2) % 3;
        made[k] = way[k] - q[0] * t[k] + (q[1 + m] * t[n] - q[1 + n] * t[m]);
    }
}

static fp3_status anchor(const fp3_reader *r, uint64_t handle, const double at[3], double made[3]) {
    double x[3] = {0}, way[3] = {0}, angle, turn[2], q[4];
    fp3_status status = fp3_bodies_read(r->scene->bodies, "x", &handle, 1, x);
    if (!status)
        status = r->dimensions == 3
                     ? fp3_bodies_read(r->scene->bodies, "q", &handle, 1, q)
                     : fp3_bodies_read(r->scene->bodies, "angle", &handle, 1, &angle);
    for (unsigned k = 0; k < r->dimensions; k++)
        way[k] = at[k] - x[k];
    if (status)
        return status;
    if (r->dimensions == 3) {
        turn_back(q, way, made);
        return FP3_OK;
    }
    fp3_turn2_of(angle, turn);
    made[0] = turn[0] * way[0] + turn[1] * way[1];
    made[1] = turn[0] * way[1] - turn[1] * way[0];
    return FP3_OK;
}

static fp3_status read_anchors(fp3_reader *r, const config_setting_t *from, fp3_joint_def *def) {
    const config_setting_t *at = config_setting_get_member(from, "at");
    double point[3] = {0};
    if (!at) {
        fp3_status status = fp3_read_place(r, from, "anchor_a", def->anchor_a);
        return status ? status : fp3_read_place(r, from, "anchor_b", def->anchor_b);
    }
    for (int i = 0; i < 2; i++) {
        const char *name = i ? "anchor_b" : "anchor_a";
        const config_setting_t *other = config_setting_get_member(from, name);
        if (other)
            return fp3_setting_wrong(r->in, other, "%s: at says where the joint is", name);
    }
    if (def->type == FP3_ROD || def->type == FP3_GEAR)
        return fp3_setting_wrong(r->in, at, "at: a %s is not at a point%s", types[def->type],
                                 def->type == FP3_ROD ? ", expected anchor_a and anchor_b" : "");
    fp3_status status = fp3_read_point(r, at, "at", point);
    if (!status)
        status = anchor(r, def->a, point, def->anchor_a);
    return status ? status : anchor(r, def->b, point, def->anchor_b);
}

/* ---- all ---- */

/* A direction that nothing of the joint follows; the world cannot see that it was said. */
static fp3_status check_ways(const fp3_reader *r, const config_setting_t *from,
                             fp3_joint_type type) {
    const int is_space = r->dimensions == 3;
    const int has_axis = type == FP3_SLIDER || type == FP3_WHEEL ||
                         (is_space && (type == FP3_HINGE || type == FP3_BALL));
    const config_setting_t *axis = config_setting_get_member(from, "axis"),
                           *axle = config_setting_get_member(from, "axle");
    if (axis && !has_axis)
        return fp3_setting_wrong(r->in, axis, "axis: a %s has none, expected it of %s", types[type],
                                 is_space ? "hinge, slider, wheel or ball" : "slider or wheel");
    if (axle && type != FP3_WHEEL)
        return fp3_setting_wrong(r->in, axle, "axle: a %s has none, expected it of wheel",
                                 types[type]);
    return FP3_OK;
}

static fp3_status read_def(fp3_reader *r, const config_setting_t *from, fp3_joint_def *def) {
    const config_setting_t *limits = config_setting_get_member(from, "limits");
    double ends[2] = {0};
    static const char *const plane[] = {"gear", "ratio", NULL}, *const space[] = {"ball", "axle",
                                                                                  NULL};
    fp3_status status = fp3_read_fits(r, from, plane, space);
    if (!status)
        status = find_bodies(r, from, def);
    if (!status)
        status = check_ways(r, from, def->type);
    if (!status)
        status = read_anchors(r, from, def);
    if (!status)
        status = fp3_read_place(r, from, "axis", def->axis);
    if (!status)
        status = fp3_read_place(r, from, "axle", def->axle);
    for (size_t i = 0; !status && i < sizeof numbers / sizeof *numbers; i++)
        status = fp3_read_value(r, from, numbers[i].name,
                                (double *)(void *)((char *)def + numbers[i].at));
    if (!status && limits)
        status = fp3_read_numbers(r, limits, "limits", 2, ends);
    def->has_limits = limits != NULL;
    def->low = ends[0];
    def->high = ends[1];
    return status ? status : fp3_read_flag(r, from, "may_collide", &def->may_collide);
}

/* An fp3_copy_fn. */
static fp3_status join(fp3_reader *r, const config_setting_t *from, void *user) {
    fp3_bodies_scene *scene = r->scene;
    fp3_joint_def def = fp3_joint_default(FP3_ROD, 0, 0);
    char name[60];
    (void)user;
    fp3_status status =
        fp3_bodies_grow((void **)&scene->joints, &scene->joint_room, sizeof *scene->joints,
                        scene->joint_count + 1, r->in->error);
    if (!status && scene->joint_count == FP3_BODIES_SCENE_MOST)
        status = fp3_setting_wrong(r->in, from, "expected at most %d joints in all",
                                   FP3_BODIES_SCENE_MOST);
    if (!status)
        status = read_def(r, from, &def);
    if (status)
        return status;
    snprintf(name, sizeof name, r->number > 0 ? "%s, copy %.0f" : "%s", types[def.type], r->number);
    status = fp3_bodies_join(scene->bodies, &def, 1, &scene->joints[scene->joint_count]);
    if (status)
        return fp3_read_refused(r, from, name, status);
    scene->joint_count++;
    return FP3_OK;
}

fp3_status fp3_read_joints(fp3_reader *r, const config_setting_t *list) {
    static const char *const names[] = {
        "rod",      "hinge", "slider", "wheel",  "weld",        "gear",  "count", "anchor_a",
        "anchor_b", "at",    "axis",   "limits", "ratio",       "speed", "most",  "hertz",
        "damping",  "rest",  "force",  "torque", "may_collide", "ball",  "axle",  NULL};
    fp3_status status = FP3_OK;
    if (!config_setting_is_list(list))
        return fp3_setting_expected(r->in, list, "joints", "a list of joints, ( { ... }, ... )");
    for (int i = 0; !status && i < config_setting_length(list); i++) {
        const config_setting_t *from = config_setting_get_elem(list, (unsigned)i);
        if (!config_setting_is_group(from))
            return fp3_setting_expected(r->in, from, "joints",
                                        "a joint, { hinge = [\"a\", \"b\"]; at = [0, 1]; }");
        status = fp3_setting_keys(r->in, from, "a joint", names);
        if (!status)
            status = fp3_read_copies(r, from, r->scene->entry_count + 1 + (size_t)i, join, NULL);
    }
    return status;
}
