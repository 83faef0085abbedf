/* SPDX-License-Identifier: Apache-2.0 */
/* scene_read.c - the file of a scene: its settings, programs and values; a refusal names the line.
 */
#include "scene_read.h"

#include "adaptive.h"
#include "arranged.h"
#include "base/number.h"
#include "base/path.h"
#include "engine/common/inside.h"
#include "lifetime.h"
#include "machine/config.h"
#include "machine/placement.h"
#include "relations.h"
#include "values.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* What is read, and where. */
typedef struct {
    fp3_scene *scene;
    const char *path, *config; /* config: what replaces the file's, or NULL */
    const fp3_config *machine; /* the one or the other */
    uint64_t draw;             /* added to each seed of `random` */
    double h;
    const config_setting_t *h_at; /* NULL: the file gives no h */
    fp3_settings in;
    fp3_program_def *defs; /* with which each group's program was opened */
    char **integrators;    /* ... whose strings these are */
    fp3_error *error;
} reader;

static char *copy(const char *text, size_t size) {
    char *made = malloc(size + 1);
    if (made) {
        memcpy(made, text, size);
        made[size] = '\0';
    }
    return made;
}

static fp3_status no_memory(const reader *r) { return fp3_no_memory(r->error); }

/* ---- settings ---- */

static fp3_status missing(const reader *r, const config_setting_t *at, const char *what) {
    return fp3_setting_wrong(&r->in, at, "expected %s", what);
}

/* *text is unchanged if it is not there. */
static fp3_status read_text(const reader *r, const config_setting_t *group, const char *name,
                            char **text) {
    const config_setting_t *setting = config_setting_get_member(group, name);
    const char *found = NULL;
    if (!setting)
        return FP3_OK;
    fp3_status status = fp3_setting_text(&r->in, setting, name, &found);
    if (status)
        return status;
    *text = copy(found, strlen(found));
    return *text ? FP3_OK : no_memory(r);
}

static fp3_status read_count(const reader *r, const config_setting_t *group, const char *name,
                             uint64_t least, uint64_t *count) {
    const config_setting_t *setting = config_setting_get_member(group, name);
    return setting ? fp3_setting_count(&r->in, setting, name, least, UINT32_MAX, count) : FP3_OK;
}

/* ---- programs ---- */

/* A built-in table by its name, one of a file from where the scene is. */
static fp3_status read_integrator(const reader *r, const config_setting_t *from, char **to,
                                  char **file) {
    char *name = NULL;
    fp3_status status = read_text(r, from, "integrator", &name);
    if (status || !name)
        return status;
    const size_t size = strlen(name);
    const int is_file = strchr(name, '/') || (size > 4 && strcmp(name + size - 4, ".cfg") == 0);
    *to = is_file ? fp3_path_beside(r->path, name) : copy(name, size);
    free(name);
    if (*to && is_file)
        *file = strdup(*to);
    return *to && (!is_file || *file) ? FP3_OK : no_memory(r);
}

static fp3_status read_flag(const reader *r, const config_setting_t *from, const char *name,
                            int *flag, int *is_given) {
    const config_setting_t *setting = config_setting_get_member(from, name);
    *is_given |= setting != NULL;
    return setting ? fp3_setting_flag(&r->in, setting, name, flag) : FP3_OK;
}

/* A flag for each that is not plain. One that is nothing but passes goes with any other. */
static fp3_status read_arithmetic(const reader *r, const config_setting_t *from,
                                  fp3_compile_def *how, int *is_given) {
    fp3_status status = FP3_OK;
    for (int i = FP3_PLAIN + 1; !status && i < FP3_ARITHMETICS; i++) {
        const fp3_arithmetic_facts *facts = fp3_arithmetic_of((fp3_arithmetic)i);
        int is_on = 0;
        status = read_flag(r, from, facts->name, &is_on, is_given);
        if (status || !is_on)
            continue;
        how->passes |= facts->passes;
        if (!facts->passes && how->arithmetic != FP3_PLAIN)
            return fp3_setting_wrong(&r->in, config_setting_get_member(from, facts->name),
                                     "found both %s and %s, expected one arithmetic",
                                     fp3_arithmetic_of(how->arithmetic)->name, facts->name);
        if (!facts->passes)
            how->arithmetic = (fp3_arithmetic)i;
    }
    return status;
}

/* What a model is compiled with; nothing else is. */
static fp3_status read_def(const reader *r, const config_setting_t *from, fp3_scene_group *to,
                           char **integrator, fp3_program_def *def) {
    int is_given = 0;
    fp3_compile_def *how = &def->compile;
    fp3_status status = read_integrator(r, from, integrator, &to->integrator_file);
    if (!status)
        status = read_arithmetic(r, from, how, &is_given);
    if (!status && !fp3_program_is_model(to->path) && (*integrator || is_given))
        status = fp3_setting_wrong(
            &r->in, from,
            "integrator, compensated, double_single, folded: only a model (*.ode) is compiled");
    if (!status)
        status = fp3_scene_adaptive_read(&r->in, from, def);
    if (!status && def->is_adaptive && !fp3_program_is_model(to->path))
        status = fp3_setting_wrong(&r->in, config_setting_get_member(from, "tolerance"),
                                   "tolerance: only a model (*.ode) is compiled");
    def->integrator = *integrator;
    how->config = r->machine->name;
    how->is_for_host = 1;
    /* One group may see another, whose objects then make the same steps. */
    static const fp3_coupling together = {.is_common = 1};
    if (def->is_adaptive && r->scene->group_count > 1 && !r->machine->sleep)
        how->coupling = &together;
    return status;
}

static fp3_status open_program(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    const size_t number = (size_t)(to - r->scene->groups);
    fp3_program_def *def = &r->defs[number];
    fp3_error why = {.text = ""};
    *def = fp3_program_default();
    fp3_status status = read_def(r, from, to, &r->integrators[number], def);
    if (!status) {
        status = fp3_program_open(to->path, def, &to->program, NULL, &why);
        if (status)
            fp3_fail_at(r->error, status, r->path, (unsigned)to->line, 0, "%s", why.text);
    }
    return status;
}

/* By which models of other groups call this one. */
static fp3_status read_name(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    const fp3_model *model = to->program->model;
    fp3_status status = read_text(r, from, "name", &to->name);
    if (status || to->name || !model)
        return status;
    to->name = copy(model->name, strlen(model->name));
    return to->name ? FP3_OK : no_memory(r);
}

static fp3_status read_program(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    const config_setting_t *setting = config_setting_get_member(from, "program");
    const char *name = NULL;
    if (!setting)
        return missing(r, from, "a program in this group");
    fp3_status status = fp3_setting_text(&r->in, setting, "program", &name);
    if (status)
        return status;
    to->path = fp3_path_beside(r->path, name);
    if (!to->path)
        return no_memory(r);
    if (!fp3_program_is_named(to->path))
        return fp3_setting_wrong(
            &r->in, setting, "found program '%s', expected a name that ends in .ode, .s or .fp3",
            name);
    return open_program(r, from, to);
}

/* ---- values ---- */

static fp3_status read_params_file(const reader *r, const config_setting_t *from,
                                   fp3_scene_group *to) {
    char *name = NULL;
    fp3_status status = read_text(r, from, "params", &name);
    if (status || !name)
        return status;
    to->params_file = fp3_path_beside(r->path, name);
    fp3_error why = {.text = ""};
    status = to->params_file ? fp3_params_load(to->params, to->params_file, &why) : no_memory(r);
    if (status && why.text[0])
        fp3_fail_at(r->error, status, r->path,
                    fp3_setting_line(config_setting_get_member(from, "params")), 0, "%s", why.text);
    free(name);
    return status;
}

typedef fp3_status read_fn(fp3_params *params, const fp3_settings *s, const config_setting_t *from);

static fp3_status read_values(const reader *r, const config_setting_t *from, const char *name,
                              read_fn *read, fp3_scene_group *to) {
    const config_setting_t *setting = config_setting_get_member(from, name);
    if (!setting)
        return FP3_OK;
    if (!config_setting_is_group(setting))
        return fp3_setting_expected(&r->in, setting, name,
                                    "a group of values, { name = value; ... }");
    return read(to->params, &r->in, setting);
}

static int has_h(const fp3_scene_group *group) {
    const fp3_model *model = group->program->model;
    return (model && !fp3_model_chooses_steps(model)) || fp3_params_has(group->params, "h") ||
           fp3_image_find(group->program->image, "h", FP3_CLASSES_HOST);
}

/* Later values replace earlier ones. The scene's h is for programs that have an h, or values
 * computed from h. */
static fp3_status read_params(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    fp3_status status = fp3_params_make(&to->params, r->error);
    if (!status)
        status = fp3_values_place(to->params, r->path, (unsigned)to->line, r->error);
    if (!status)
        status = read_params_file(r, from, to);
    if (!status && r->h_at && has_h(to))
        status = fp3_params_put(to->params, "h", r->h, r->error);
    if (!status)
        status = read_values(r, from, "set", fp3_values_read, to);
    return status ? status : read_values(r, from, "spread", fp3_values_spread, to);
}

/* ---- the file ---- */

static fp3_status read_objects(const reader *r, const config_setting_t *from,
                               fp3_arranged *arranged, fp3_scene_group *to) {
    uint64_t objects = 0;
    fp3_status status = fp3_arranged_read(&r->in, from, arranged, &objects);
    if (!status)
        status = read_count(r, from, "objects", 1, &objects);
    if (status)
        return status;
    if (!objects)
        return missing(r, from, "the number of objects of this group");
    const config_setting_t *at = config_setting_get_member(from, "objects");
    const uint64_t room = fp3_engine_room(r->scene->engine, r->machine->name);
    if (objects > room - r->scene->objects)
        return fp3_setting_wrong(&r->in,
                                 at                  ? at
                                 : arranged->grid_at ? arranged->grid_at
                                                     : arranged->points_at,
                                 "objects: found %" PRIu64 ", expected at most %" PRIu64
                                 "%s: configuration '%s' has room for %" PRIu64 " object%s",
                                 objects, room - r->scene->objects,
                                 r->scene->objects ? " more" : "", r->machine->name, room,
                                 room == 1 ? "" : "s");
    to->first = r->scene->objects;
    to->objects = objects;
    r->scene->objects += objects;
    return FP3_OK;
}

/* Before the engine, which knows no line. */
static fp3_status check_lives(const reader *r, const config_setting_t *from,
                              const fp3_scene_group *group) {
    const config_setting_t *born = config_setting_get_member(from, "born");
    if (!fp3_lifetime_is_any(group) || !r->machine->interleave || r->machine->sleep ||
        (group->program && group->program->sees_others) ||
        r->scene->group_count > fp3_config_schedulers(r->machine)) /* they see each other */
        return FP3_OK;
    return fp3_setting_wrong(&r->in, born ? born : config_setting_get_member(from, "gone"),
                             "born, gone: configuration '%s' has no sleep: all its objects make "
                             "all steps",
                             r->machine->name);
}

static fp3_status read_group(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    static const char *const names[] = {
        "program", "integrator", "compensated", "double_single", "folded", "tolerance",
        "until",   "absolute",   "maxstep",     "objects",       "params", "set",
        "spread",  "born",       "gone",        "grid",          "random", "points",
        "links",   "only",       "skin",        "name",          NULL};
    fp3_arranged arranged = {.grid_at = NULL};
    to->line = (int)fp3_setting_line(from);
    if (!config_setting_is_group(from))
        return missing(r, from, "a group, { program = ...; objects = ...; ... }");
    fp3_status status = fp3_setting_keys(&r->in, from, "a group", names);
    if (!status)
        status = read_objects(r, from, &arranged, to);
    if (!status)
        status = fp3_lifetime_read(&r->in, from, to);
    if (!status)
        status = read_program(r, from, to);
    if (!status)
        status = read_name(r, from, to);
    if (!status)
        status = read_params(r, from, to);
    if (!status)
        status = fp3_arranged_apply(&r->in, from, r->draw, &arranged, to);
    fp3_arranged_close(&arranged);
    return status;
}

/* Before any program is opened: many groups take long. */
static fp3_status check_count(const reader *r, const config_setting_t *list) {
    const int count = config_setting_length(list);
    if (count == 0)
        return missing(r, list, "a group in groups");
    const uint32_t schedulers = fp3_config_schedulers(r->machine);
    if ((uint32_t)count <= schedulers || (r->machine->neighbours && count <= FP3_JOINED_MAX))
        return FP3_OK;
    return fp3_setting_wrong(&r->in, list,
                             "found %d groups, each with a program of its own: configuration '%s' "
                             "has %" PRIu32 " scheduler%s",
                             count, r->machine->name, schedulers, schedulers == 1 ? "" : "s");
}

/* Programs of groups that see each other are compiled again, to make their phases together. */
static fp3_status join(const reader *r, const config_setting_t *list) {
    const fp3_scene *scene = r->scene;
    fp3_joined *joined = calloc(scene->group_count, sizeof *joined);
    fp3_error why = {.text = ""};
    if (!joined)
        return no_memory(r);
    for (size_t i = 0; i < scene->group_count; i++)
        joined[i] = (fp3_joined){
            .name = scene->groups[i].name, .program = scene->groups[i].program, .def = &r->defs[i]};
    const fp3_status status = fp3_programs_join(joined, scene->group_count, &why);
    free(joined);
    return status
               ? fp3_fail_at(r->error, status, r->path, fp3_setting_line(list), 0, "%s", why.text)
               : FP3_OK;
}

/* More groups than schedulers are for groups that see each other. */
static fp3_status check_joined(const reader *r, const config_setting_t *list) {
    const uint32_t schedulers = fp3_config_schedulers(r->machine);
    int is_joined = 0;
    for (size_t i = 0; i < r->scene->group_count; i++) {
        const fp3_compiled *compiled = r->scene->groups[i].program->compiled;
        is_joined |= compiled && compiled->looks;
    }
    if (is_joined || r->scene->group_count <= schedulers)
        return FP3_OK;
    return fp3_setting_wrong(&r->in, list,
                             "found %zu groups that do not see each other (no sum of a model goes "
                             "over objects of a `kind`): configuration '%s' has %" PRIu32
                             " scheduler%s, each for one program",
                             r->scene->group_count, r->machine->name, schedulers,
                             schedulers == 1 ? "" : "s");
}

static fp3_status read_groups(reader *r) {
    fp3_scene *scene = r->scene;
    const config_setting_t *list = config_setting_get_member(r->in.root, "groups");
    if (!list)
        return missing(r, r->in.root, "groups = ( { ... }, ... )");
    if (!config_setting_is_list(list))
        return fp3_setting_expected(&r->in, list, "groups", "a list of groups, ( { ... }, ... )");
    fp3_status status = check_count(r, list);
    if (status)
        return status;
    const size_t count = (size_t)config_setting_length(list);
    scene->groups = calloc(count, sizeof *scene->groups);
    r->defs = calloc(count, sizeof *r->defs);
    r->integrators = calloc(count, sizeof *r->integrators);
    if (!scene->groups || !r->defs || !r->integrators)
        return no_memory(r);
    scene->group_count = count;
    scene->line = (int)fp3_setting_line(list);
    for (size_t i = 0; !status && i < count; i++)
        status = read_group(r, config_setting_get_elem(list, (unsigned)i), &scene->groups[i]);
    if (!status)
        status = join(r, list);
    if (!status)
        status = check_joined(r, list);
    for (size_t i = 0; !status && i < count; i++)
        status = check_lives(r, config_setting_get_elem(list, (unsigned)i), &scene->groups[i]);
    return status ? status : fp3_scene_adaptive_check(&r->in, list, scene);
}

static fp3_status read_h(reader *r) {
    float single;
    r->h_at = config_setting_get_member(r->in.root, "h");
    if (!r->h_at)
        return FP3_OK;
    fp3_status status = fp3_setting_number(&r->in, r->h_at, "h", &r->h);
    const char *expected = status ? NULL : fp3_number_step(r->h, &single);
    return expected ? fp3_setting_expected(&r->in, r->h_at, "h", expected) : status;
}

static fp3_status check_h(const reader *r) {
    for (size_t i = 0; i < r->scene->group_count; i++)
        if (has_h(&r->scene->groups[i]))
            return FP3_OK;
    return r->h_at ? fp3_setting_wrong(&r->in, r->h_at, "no program has an 'h'") : FP3_OK;
}

/* Whether objects of a group's model see others. A model that cannot be read is refused later, when
 * it is compiled. */
static int does_see_others(const reader *r, const config_setting_t *group) {
    const config_setting_t *at = group && config_setting_is_group(group)
                                     ? config_setting_get_member(group, "program")
                                     : NULL;
    const char *name = at ? config_setting_get_string(at) : NULL;
    char *path = name && fp3_program_is_model(name) ? fp3_path_beside(r->path, name) : NULL;
    char *report = NULL;
    fp3_model *model = NULL;
    fp3_error why;
    const int is = path && (fp3_model_load(path, &model, &report, &why) || model->relation_count);
    fp3_model_free(&model);
    free(report);
    free(path);
    return is;
}

static int sees_others(const reader *r) {
    const config_setting_t *list = config_setting_get_member(r->in.root, "groups");
    int is = 0;
    for (unsigned i = 0; list && !is && i < (unsigned)config_setting_length(list); i++)
        is = does_see_others(r, config_setting_get_elem(list, i));
    return is;
}

/* What replaces the file's is the caller's own mistake, if it is one: it has no line. */
static fp3_status read_config(reader *r) {
    fp3_scene *scene = r->scene;
    const config_setting_t *setting = config_setting_get_member(r->in.root, "config");
    fp3_error why;
    fp3_status status = read_text(r, r->in.root, "config", &scene->config);
    if (!status && r->config) {
        free(scene->config);
        scene->config = copy(r->config, strlen(r->config));
        status = scene->config ? FP3_OK : no_memory(r);
    }
    if (status)
        return status;
    if (!scene->config && sees_others(r)) {
        scene->config = strdup(FP3_WORLD);
        if (!scene->config)
            return no_memory(r);
    }
    if (!scene->config)
        return missing(r, r->in.root, "config = \"...\"");
    status = fp3_config_choose(scene->config, &r->machine, &why);
    if (status && r->config)
        return fp3_fail(r->error, status, "%s", why.text);
    return status ? fp3_setting_wrong(&r->in, setting, "config: %s", why.text) : FP3_OK;
}

static fp3_status read_engine(const reader *r) {
    fp3_error why;
    fp3_status status = read_text(r, r->in.root, "engine", &r->scene->engine);
    if (!status && !r->scene->engine) {
        r->scene->engine = strdup(fp3_engine_usual(r->machine->neighbours != 0));
        return r->scene->engine ? FP3_OK : no_memory(r);
    }
    if (!status && !fp3_engine_traits_of(r->scene->engine, &why))
        status = fp3_setting_wrong(&r->in, config_setting_get_member(r->in.root, "engine"),
                                   "engine: %s", why.text);
    return status;
}

static fp3_status read_scene(reader *r) {
    static const char *const names[] = {"config", "engine", "steps",  "visit",
                                        "seed",   "h",      "groups", NULL};
    const config_setting_t *root = r->in.root;
    uint64_t visit = 0, seed = 0;
    const config_setting_t *bodies = config_setting_get_member(root, "bodies");
    if (bodies)
        return fp3_setting_wrong(&r->in, bodies,
                                 "bodies: expected groups; fp3 run alone takes a scene of bodies, "
                                 "from a file");
    fp3_status status = fp3_setting_keys(&r->in, root, "a scene", names);
    if (!status)
        status = read_config(r);
    if (!status)
        status = read_engine(r);
    if (!status)
        status = read_count(r, root, "steps", 0, &r->scene->steps);
    if (!status)
        status = read_count(r, root, "visit", 1, &visit);
    if (!status)
        status = read_count(r, root, "seed", 0, &seed);
    r->scene->visit = (uint32_t)visit;
    r->scene->seed = (uint32_t)seed;
    if (!status)
        status = read_h(r);
    if (!status)
        status = read_groups(r);
    if (!status)
        status = check_h(r);
    if (!status && !config_setting_get_member(root, "steps") &&
        fp3_scene_adaptive_count(r->scene) == r->scene->group_count)
        r->scene->steps = FP3_ADAPTIVE_ATTEMPTS;
    return status;
}

fp3_status fp3_scene_read(fp3_scene *scene, const char *config, uint64_t draw, fp3_error *error) {
    reader r = {
        .scene = scene, .path = scene->path, .config = config, .draw = draw, .error = error};
    fp3_status status = fp3_settings_load(r.path, FP3_E_ARGUMENT, &r.in, error);
    if (!status)
        status = read_scene(&r);
    for (size_t i = 0; r.integrators && i < scene->group_count; i++)
        free(r.integrators[i]);
    free(r.integrators);
    free(r.defs);
    fp3_settings_close(&r.in);
    return status;
}
