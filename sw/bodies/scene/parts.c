/* SPDX-License-Identifier: Apache-2.0 */
/* parts.c - the bodies of a scene. */
#include "read.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *name;
    size_t at;
} number;

static const number numbers[] = {{"angle", offsetof(fp3_body_def, angle)},
                                 {"w", offsetof(fp3_body_def, w)},
                                 {"damping", offsetof(fp3_body_def, damping)},
                                 {"spin_damping", offsetof(fp3_body_def, spin_damping)},
                                 {"gravity", offsetof(fp3_body_def, gravity)}};

static const number flags[] = {{"may_not_turn", offsetof(fp3_body_def, may_not_turn)},
                               {"may_not_sleep", offsetof(fp3_body_def, may_not_sleep)},
                               {"is_fast", offsetof(fp3_body_def, is_fast)}};

static fp3_status read_type(const fp3_reader *r, const config_setting_t *from,
                            fp3_body_type *type) {
    static const char *const types[] = {
        [FP3_DYNAMIC] = "dynamic", [FP3_KINEMATIC] = "kinematic", [FP3_STATIC] = "static"};
    const config_setting_t *at = config_setting_get_member(from, "type");
    const char *name = NULL;
    fp3_status status = at ? fp3_setting_text(r->in, at, "type", &name) : FP3_OK;
    if (status || !name)
        return status;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strcmp(name, types[i])) {
            *type = (fp3_body_type)i;
            return FP3_OK;
        }
    return fp3_setting_wrong(
        r->in, at, "type: found '%s', expected \"dynamic\", \"kinematic\" or \"static\"", name);
}

static fp3_status read_def(fp3_reader *r, const config_setting_t *from, fp3_body_def *def) {
    static const char *const plane[] = {"angle", "w", NULL}, *const space[] = {"q", "spin", NULL};
    fp3_status status = fp3_read_fits(r, from, plane, space);
    if (!status)
        status = read_type(r, from, &def->type);
    if (!status)
        status = fp3_read_turn(r, from, def->q);
    if (!status)
        status = fp3_read_place(r, from, "spin", def->spin);
    if (!status)
        status = fp3_read_place(r, from, "x", def->x);
    if (!status)
        status = fp3_read_place(r, from, "v", def->v);
    for (size_t i = 0; !status && i < sizeof numbers / sizeof *numbers; i++)
        status = fp3_read_value(r, from, numbers[i].name,
                                (double *)(void *)((char *)def + numbers[i].at));
    for (size_t i = 0; !status && i < sizeof flags / sizeof *flags; i++)
        status = fp3_read_flag(r, from, flags[i].name, (int *)(void *)((char *)def + flags[i].at));
    return status;
}

/* An fp3_copy_fn. */
static fp3_status add(fp3_reader *r, const config_setting_t *from, void *user) {
    fp3_bodies_entry *entry = user;
    fp3_bodies_scene *scene = r->scene;
    fp3_body_def def = fp3_body_default();
    char name[FP3_NAME_SIZE + 24];
    fp3_status status = fp3_bodies_grow((void **)&scene->handles, &scene->room,
                                        sizeof *scene->handles, scene->count + 1, r->in->error);
    if (!status && scene->count == FP3_BODIES_SCENE_MOST)
        status = fp3_setting_wrong(r->in, from, "expected at most %d bodies in all",
                                   FP3_BODIES_SCENE_MOST);
    if (!status)
        status = read_def(r, from, &def);
    if (status)
        return status;
    entry->count++;
    fp3_bodies_scene_name(scene, scene->count, name);
    status = fp3_bodies_add(scene->bodies, &def, 1, &scene->handles[scene->count]);
    if (status)
        return fp3_read_refused(r, from, name, status);
    return fp3_read_shapes(r, from, scene->handles[scene->count++]);
}

static fp3_status read_name(const fp3_reader *r, const config_setting_t *from,
                            fp3_bodies_entry *entry) {
    const config_setting_t *at = config_setting_get_member(from, "name");
    const fp3_bodies_scene *scene = r->scene;
    const char *name = NULL;
    fp3_status status = at ? fp3_setting_text(r->in, at, "name", &name) : FP3_OK;
    if (status || !name)
        return status;
    if (!fp3_name_valid(name))
        return fp3_setting_wrong(r->in, at,
                                 "name: found '%s', expected up to %d letters, digits and _", name,
                                 FP3_NAME_SIZE - 1);
    for (size_t i = 0; i < scene->entry_count; i++)
        if (!strcmp(scene->entries[i].name, name))
            return fp3_setting_wrong(r->in, at,
                                     "name: found '%s' again, expected a name that no other bodies "
                                     "have",
                                     name);
    snprintf(entry->name, sizeof entry->name, "%s", name);
    return FP3_OK;
}

static fp3_status read_entry(fp3_reader *r, const config_setting_t *from) {
    static const char *const names[] = {"name",
                                        "q",
                                        "spin",
                                        "type",
                                        "count",
                                        "points",
                                        "x",
                                        "angle",
                                        "v",
                                        "w",
                                        "damping",
                                        "spin_damping",
                                        "gravity",
                                        "may_not_turn",
                                        "may_not_sleep",
                                        "is_fast",
                                        "shapes",
                                        "one_of",
                                        NULL};
    fp3_bodies_scene *scene = r->scene;
    fp3_bodies_entry *entry;
    if (!config_setting_is_group(from))
        return fp3_setting_expected(r->in, from, "bodies",
                                    "a body, { x = [0, 1]; shapes = { ... }; }");
    fp3_status status = fp3_setting_keys(r->in, from, "a body", names);
    if (!status)
        status = fp3_bodies_grow((void **)&scene->entries, &scene->entry_room,
                                 sizeof *scene->entries, scene->entry_count + 1, r->in->error);
    if (status)
        return status;
    entry = &scene->entries[scene->entry_count];
    *entry = (fp3_bodies_entry){.first = scene->count};
    status = read_name(r, from, entry);
    if (status)
        return status;
    scene->entry_count++;
    return fp3_read_copies(r, from, scene->entry_count, add, entry);
}

fp3_status fp3_read_bodies(fp3_reader *r, const config_setting_t *list) {
    fp3_status status = FP3_OK;
    if (!config_setting_is_list(list))
        return fp3_setting_expected(r->in, list, "bodies", "a list of bodies, ( { ... }, ... )");
    for (int i = 0; !status && i < config_setting_length(list); i++)
        status = read_entry(r, config_setting_get_elem(list, (unsigned)i));
    if (!status && !r->scene->count)
        status = fp3_setting_wrong(r->in, list, "bodies: found no body, expected one");
    return status;
}
