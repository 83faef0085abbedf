/* scene.c - scene files: read, checked, given to an engine. */
#include "scene.h"

#include <inttypes.h>
#include <libconfig.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is read, and where. */
typedef struct {
    fp3_scene *scene;
    const char *path, *config; /* config: the command line's, or NULL */
    double h;
    int h_line; /* 0: the file gives no h */
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

static fp3_status no_memory(const reader *r) {
    return fp3_fail(r->error, FP3_E_SYSTEM, "out of memory");
}

/* A name in the file, from where the file is. */
static char *beside(const char *path, const char *name) {
    const char *slash = strrchr(path, '/');
    const size_t folder = *name == '/' || !slash ? 0 : (size_t)(slash + 1 - path);
    char *made = malloc(folder + strlen(name) + 1);
    if (made) {
        memcpy(made, path, folder);
        strcpy(made + folder, name);
    }
    return made;
}

/* ---- settings ---- */

static const char *type_of(const config_setting_t *setting) {
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_GROUP:
        return "a group";
    case CONFIG_TYPE_INT:
    case CONFIG_TYPE_INT64:
        return "an integer";
    case CONFIG_TYPE_FLOAT:
        return "a number with a fraction";
    case CONFIG_TYPE_STRING:
        return "a text";
    case CONFIG_TYPE_BOOL:
        return "true or false";
    default:
        return "a list";
    }
}

static fp3_status expected(const reader *r, const config_setting_t *setting, const char *what) {
    return fp3_fail(r->error, FP3_E_ARGUMENT, "%s:%d: '%s': found %s, expected %s", r->path,
                    config_setting_source_line(setting), config_setting_name(setting),
                    type_of(setting), what);
}

static fp3_status missing(const reader *r, int line, const char *what) {
    return fp3_fail(r->error, FP3_E_ARGUMENT, "%s:%d: expected %s", r->path, line, what);
}

/* names are separated by blanks. */
static fp3_status check_names(const reader *r, const config_setting_t *group, const char *where,
                              const char *names) {
    for (int i = 0; i < config_setting_length(group); i++) {
        const config_setting_t *setting = config_setting_get_elem(group, (unsigned)i);
        const char *name = config_setting_name(setting);
        const char *found = strstr(names, name);
        while (found && ((found > names && found[-1] != ' ') ||
                         (found[strlen(name)] && found[strlen(name)] != ' ')))
            found = strstr(found + 1, name);
        if (!found)
            return fp3_fail(r->error, FP3_E_ARGUMENT,
                            "%s:%d: found '%s', expected a setting of %s: %s", r->path,
                            config_setting_source_line(setting), name, where, names);
    }
    return FP3_OK;
}

/* *text is unchanged if it is not there. */
static fp3_status read_text(const reader *r, const config_setting_t *group, const char *name,
                            char **text) {
    const config_setting_t *setting = config_setting_get_member(group, name);
    if (!setting)
        return FP3_OK;
    const char *found = config_setting_get_string(setting);
    if (!found)
        return expected(r, setting, "a text in quotes");
    *text = copy(found, strlen(found));
    return *text ? FP3_OK : no_memory(r);
}

static fp3_status read_count(const reader *r, const config_setting_t *group, const char *name,
                             uint64_t least, uint64_t *count) {
    const config_setting_t *setting = config_setting_get_member(group, name);
    if (!setting)
        return FP3_OK;
    const int type = config_setting_type(setting);
    if (type != CONFIG_TYPE_INT && type != CONFIG_TYPE_INT64)
        return expected(r, setting, "an integer");
    const long long value = config_setting_get_int64(setting);
    if (value < (long long)least || value > UINT32_MAX)
        return fp3_fail(r->error, FP3_E_ARGUMENT,
                        "%s:%d: '%s': found %lld, expected a number from %" PRIu64 " to 4294967295",
                        r->path, config_setting_source_line(setting), name, value, least);
    *count = (uint64_t)value;
    return FP3_OK;
}

/* ---- programs ---- */

/* A built-in table by its name, one of a file from where the scene is. */
static fp3_status read_integrator(const reader *r, const config_setting_t *from,
                                  fp3_scene_group *to) {
    char *name = NULL;
    fp3_status status = read_text(r, from, "integrator", &name);
    if (status || !name)
        return status;
    const size_t size = strlen(name);
    const int is_file = strchr(name, '/') || (size > 4 && strcmp(name + size - 4, ".cfg") == 0);
    to->integrator = is_file ? beside(r->path, name) : copy(name, size);
    free(name);
    return to->integrator ? FP3_OK : no_memory(r);
}

/* How a group's program becomes an image. */
static fp3_status make_image(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    const char *config = r->config ? r->config : r->scene->config;
    const config_setting_t *compensated = config_setting_get_member(from, "compensated");
    fp3_program_def def = {.config = config};
    fp3_status status = read_integrator(r, from, to);
    if (!status && compensated && config_setting_type(compensated) != CONFIG_TYPE_BOOL)
        status = expected(r, compensated, "true or false");
    if (!status && !fp3_program_is_model(to->program) && (to->integrator || compensated))
        status = fp3_fail(r->error, FP3_E_ARGUMENT,
                          "%s:%d: integrator, compensated: only a model (*.ode) is compiled",
                          r->path, to->line);
    if (!status && fp3_program_is_model(to->program) && !config)
        status = missing(r, to->line, "a configuration to compile for, config = \"...\" above");
    def.integrator = to->integrator;
    def.is_compensated = compensated && config_setting_get_bool(compensated);
    return status ? status : fp3_program_load(to->program, &def, &to->source, r->error);
}

static fp3_status read_program(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    const config_setting_t *setting = config_setting_get_member(from, "program");
    if (!setting)
        return missing(r, to->line, "a program in this group");
    const char *name = config_setting_get_string(setting);
    if (!name)
        return expected(r, setting, "a text in quotes");
    to->program = beside(r->path, name);
    if (!to->program)
        return no_memory(r);
    if (!fp3_program_is_known(to->program))
        return fp3_fail(r->error, FP3_E_ARGUMENT,
                        "%s:%d: found program '%s', expected a name that ends in .ode, .s or .fp3",
                        r->path, config_setting_source_line(setting), name);
    return make_image(r, from, to);
}

/* ---- values ---- */

static fp3_status read_params_file(const reader *r, const config_setting_t *from,
                                   fp3_scene_group *to) {
    char *name = NULL;
    fp3_status status = read_text(r, from, "params", &name);
    if (status || !name)
        return status;
    char *path = beside(r->path, name);
    status = path ? fp3_params_load(&to->params, path, r->error) : no_memory(r);
    free(path);
    free(name);
    return status;
}

typedef fp3_status read_fn(fp3_params *params, const config_setting_t *from, const char *path,
                           fp3_error *error);

static fp3_status read_values(const reader *r, const config_setting_t *from, const char *name,
                              read_fn *read, fp3_scene_group *to) {
    const config_setting_t *setting = config_setting_get_member(from, name);
    if (!setting)
        return FP3_OK;
    if (!config_setting_is_group(setting))
        return expected(r, setting, "a group of values, { name = value; ... }");
    return read(&to->params, setting, r->path, r->error);
}

static int has_h(const fp3_scene_group *group) {
    return group->source.model || fp3_image_find(group->source.image, "h", FP3_CLASSES_HOST);
}

/* Each replaces what came before. The scene's h is for those programs that have an h. */
static fp3_status read_params(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    fp3_status status = read_params_file(r, from, to);
    if (!status && r->h_line && has_h(to))
        status = fp3_params_put(&to->params, "h", r->h, r->error);
    if (!status)
        status = read_values(r, from, "set", fp3_params_read, to);
    return status ? status : read_values(r, from, "spread", fp3_params_spread, to);
}

/* ---- the file ---- */

static fp3_status read_group(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    uint64_t objects = 0;
    to->line = config_setting_source_line(from);
    if (!config_setting_is_group(from))
        return missing(r, to->line, "a group, { program = ...; objects = ...; ... }");
    fp3_status status =
        check_names(r, from, "a group", "program integrator compensated objects params set spread");
    if (!status)
        status = read_count(r, from, "objects", 1, &objects);
    if (!status && !objects)
        status = missing(r, to->line, "the number of objects of this group");
    if (!status)
        status = read_program(r, from, to);
    to->first = r->scene->objects;
    to->objects = objects;
    r->scene->objects += objects;
    return status ? status : read_params(r, from, to);
}

static fp3_status read_groups(const reader *r, const config_setting_t *root) {
    fp3_scene *scene = r->scene;
    const config_setting_t *list = config_setting_get_member(root, "groups");
    if (!list)
        return missing(r, 1, "groups = ( { ... }, ... )");
    if (!config_setting_is_list(list))
        return expected(r, list, "a list of groups, ( { ... }, ... )");
    if (config_setting_length(list) == 0)
        return missing(r, config_setting_source_line(list), "a group in groups");
    const size_t count = (size_t)config_setting_length(list);
    scene->groups = calloc(count, sizeof *scene->groups);
    if (!scene->groups)
        return no_memory(r);
    scene->count = count;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < count; i++)
        status = read_group(r, config_setting_get_elem(list, (unsigned)i), &scene->groups[i]);
    return status;
}

static fp3_status read_h(reader *r, const config_setting_t *root) {
    const config_setting_t *setting = config_setting_get_member(root, "h");
    if (!setting)
        return FP3_OK;
    if (!config_setting_is_number(setting))
        return expected(r, setting, "a number");
    r->h_line = config_setting_source_line(setting);
    r->h = config_setting_type(setting) == CONFIG_TYPE_FLOAT
               ? config_setting_get_float(setting)
               : (double)config_setting_get_int64(setting);
    return FP3_OK;
}

static fp3_status check_h(const reader *r) {
    for (size_t i = 0; i < r->scene->count; i++)
        if (has_h(&r->scene->groups[i]))
            return FP3_OK;
    return r->h_line == 0 ? FP3_OK
                          : fp3_fail(r->error, FP3_E_ARGUMENT, "%s:%d: no program has an 'h'",
                                     r->path, r->h_line);
}

static fp3_status read_scene(reader *r, const config_setting_t *root) {
    fp3_scene *scene = r->scene;
    fp3_status status = check_names(r, root, "a scene", "config engine steps visit h groups");
    if (!status)
        status = read_text(r, root, "config", &scene->config);
    if (!status)
        status = read_text(r, root, "engine", &scene->engine);
    if (!status)
        status = read_count(r, root, "steps", 0, &scene->steps);
    if (!status)
        status = read_count(r, root, "visit", 1, &scene->visit);
    if (!status)
        status = read_h(r, root);
    if (!status)
        status = read_groups(r, root);
    if (!status)
        status = check_h(r);
    if (!status && scene->objects > UINT32_MAX)
        status = fp3_fail(r->error, FP3_E_ARGUMENT, "%s: %zu objects: 4294967295 at most", r->path,
                          scene->objects);
    return status;
}

static fp3_status read_file(reader *r) {
    fp3_status status;
    config_t config;
    config_init(&config);
    if (config_read_file(&config, r->path))
        status = read_scene(r, config_root_setting(&config));
    else if (config_error_type(&config) == CONFIG_ERR_FILE_IO)
        status = fp3_fail(r->error, FP3_E_ARGUMENT, "%s: cannot be read", r->path);
    else
        status = fp3_fail(r->error, FP3_E_ARGUMENT, "%s:%d: %s", r->path,
                          config_error_line(&config), config_error_text(&config));
    config_destroy(&config);
    return status;
}

fp3_status fp3_scene_load(const char *path, const char *config, fp3_scene **scene,
                          fp3_error *error) {
    *scene = calloc(1, sizeof **scene);
    reader r = {.scene = *scene, .path = path, .config = config, .error = error};
    if (!*scene)
        return no_memory(&r);
    (*scene)->steps = 1;
    (*scene)->path = copy(path, strlen(path));
    fp3_status status = (*scene)->path ? read_file(&r) : no_memory(&r);
    if (status)
        fp3_scene_free(scene);
    return status;
}

void fp3_scene_free(fp3_scene **scene) {
    fp3_scene *s = *scene;
    if (!s)
        return;
    for (size_t i = 0; i < s->count; i++) {
        free(s->groups[i].program);
        free(s->groups[i].integrator);
        fp3_program_close(&s->groups[i].source);
        fp3_params_free(&s->groups[i].params);
    }
    free(s->groups);
    free(s->path);
    free(s->config);
    free(s->engine);
    free(s);
    *scene = NULL;
}

/* ---- to an engine ---- */

static fp3_status load_groups(const fp3_scene *scene, fp3_engine *engine, fp3_error *error) {
    fp3_group *groups = calloc(scene->count, sizeof *groups);
    if (!groups)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (size_t i = 0; i < scene->count; i++)
        groups[i] = (fp3_group){scene->groups[i].source.image, scene->groups[i].objects};
    fp3_status status = fp3_engine_load_groups(engine, groups, scene->count);
    free(groups);
    return status;
}

fp3_status fp3_scene_apply(fp3_scene *scene, fp3_engine *engine, fp3_error *error) {
    fp3_status status = load_groups(scene, engine, error);
    for (size_t i = 0; !status && i < scene->count; i++) {
        fp3_scene_group *group = &scene->groups[i];
        const fp3_params_target to = {engine, group->source.image, i, group->first, group->objects};
        fp3_error why = {""};
        status = fp3_program_apply(&group->source, &group->params, &to, &why);
        if (status && why.text[0]) /* else the engine has said it */
            fp3_fail(error, status, "%s:%d: %s", scene->path, group->line, why.text);
    }
    return status;
}
