/* scene_read.c - the file of a scene: its settings, programs and values, each refused in its line. */
#include "scene_read.h"

#include "values.h"

#include <inttypes.h>
#include <libconfig.h>
#include <stdlib.h>
#include <string.h>

/* What is read, and where. */
typedef struct {
    fp3_scene *scene;
    const char *path, *config; /* config: what replaces the file's, or NULL */
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
static fp3_status read_integrator(const reader *r, const config_setting_t *from, char **to) {
    char *name = NULL;
    fp3_status status = read_text(r, from, "integrator", &name);
    if (status || !name)
        return status;
    const size_t size = strlen(name);
    const int is_file = strchr(name, '/') || (size > 4 && strcmp(name + size - 4, ".cfg") == 0);
    *to = is_file ? beside(r->path, name) : copy(name, size);
    free(name);
    return *to ? FP3_OK : no_memory(r);
}

static fp3_status read_is_compensated(const reader *r, const config_setting_t *from,
                                      int *is_compensated) {
    const config_setting_t *setting = config_setting_get_member(from, "compensated");
    if (!setting)
        return FP3_OK;
    if (config_setting_type(setting) != CONFIG_TYPE_BOOL)
        return expected(r, setting, "true or false");
    *is_compensated = config_setting_get_bool(setting);
    return FP3_OK;
}

/* What a model is compiled with; nothing else is. */
static fp3_status read_def(const reader *r, const config_setting_t *from, const fp3_scene_group *to,
                           char **integrator, fp3_program_def *def) {
    const char *config = r->config ? r->config : r->scene->config;
    const int is_model = fp3_program_is_model(to->path);
    fp3_status status = read_integrator(r, from, integrator);
    if (!status)
        status = read_is_compensated(r, from, &def->compile.is_compensated);
    if (!status && !is_model && (*integrator || config_setting_get_member(from, "compensated")))
        status = fp3_fail(r->error, FP3_E_ARGUMENT,
                          "%s:%d: integrator, compensated: only a model (*.ode) is compiled",
                          r->path, to->line);
    if (!status && is_model && !config)
        status = missing(r, to->line, "a configuration to compile for, config = \"...\" above");
    def->integrator = *integrator ? *integrator : def->integrator;
    def->compile.config = config;
    return status;
}

static fp3_status open_program(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    char *integrator = NULL;
    fp3_program_def def = fp3_program_default();
    fp3_status status = read_def(r, from, to, &integrator, &def);
    if (!status)
        status = fp3_program_open(to->path, &def, &to->program, NULL, r->error);
    free(integrator);
    return status;
}

static int has_known_end(const char *path) {
    static const char *const ends[] = {".ode", ".s", ".fp3"};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof ends / sizeof *ends; i++)
        if (strcmp(dot, ends[i]) == 0)
            return 1;
    return 0;
}

static fp3_status read_program(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    const config_setting_t *setting = config_setting_get_member(from, "program");
    if (!setting)
        return missing(r, to->line, "a program in this group");
    const char *name = config_setting_get_string(setting);
    if (!name)
        return expected(r, setting, "a text in quotes");
    to->path = beside(r->path, name);
    if (!to->path)
        return no_memory(r);
    if (!has_known_end(to->path))
        return fp3_fail(r->error, FP3_E_ARGUMENT,
                        "%s:%d: found program '%s', expected a name that ends in .ode, .s or .fp3",
                        r->path, config_setting_source_line(setting), name);
    return open_program(r, from, to);
}

/* ---- values ---- */

static fp3_status read_params_file(const reader *r, const config_setting_t *from,
                                   fp3_scene_group *to) {
    char *name = NULL;
    fp3_status status = read_text(r, from, "params", &name);
    if (status || !name)
        return status;
    char *path = beside(r->path, name);
    status = path ? fp3_params_load(to->params, path, r->error) : no_memory(r);
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
    return read(to->params, setting, r->path, r->error);
}

static int has_h(const fp3_scene_group *group) {
    return group->program->model || fp3_image_find(group->program->image, "h", FP3_CLASSES_HOST);
}

/* Each replaces what came before. The scene's h is for those programs that have an h. */
static fp3_status read_params(const reader *r, const config_setting_t *from, fp3_scene_group *to) {
    fp3_status status = fp3_params_make(&to->params, r->error);
    if (!status)
        status = read_params_file(r, from, to);
    if (!status && r->h_line && has_h(to))
        status = fp3_params_put(to->params, "h", r->h, r->error);
    if (!status)
        status = read_values(r, from, "set", fp3_values_read, to);
    return status ? status : read_values(r, from, "spread", fp3_values_spread, to);
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
    scene->group_count = count;
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
    for (size_t i = 0; i < r->scene->group_count; i++)
        if (has_h(&r->scene->groups[i]))
            return FP3_OK;
    return r->h_line == 0 ? FP3_OK
                          : fp3_fail(r->error, FP3_E_ARGUMENT, "%s:%d: no program has an 'h'",
                                     r->path, r->h_line);
}

static fp3_status choose_config(const reader *r) {
    char **config = &r->scene->config;
    if (r->config) {
        free(*config);
        *config = copy(r->config, strlen(r->config));
        return *config ? FP3_OK : no_memory(r);
    }
    return *config ? FP3_OK
                   : fp3_fail(r->error, FP3_E_ARGUMENT, "%s: expected config = \"...\"", r->path);
}

static fp3_status read_scene(reader *r, const config_setting_t *root) {
    fp3_scene *scene = r->scene;
    uint64_t visit = 0;
    fp3_status status = check_names(r, root, "a scene", "config engine steps visit h groups");
    if (!status)
        status = read_text(r, root, "config", &scene->config);
    if (!status)
        status = read_text(r, root, "engine", &scene->engine);
    if (!status)
        status = read_count(r, root, "steps", 0, &scene->steps);
    if (!status)
        status = read_count(r, root, "visit", 1, &visit);
    scene->visit = (uint32_t)visit;
    if (!status)
        status = read_h(r, root);
    if (!status)
        status = read_groups(r, root);
    if (!status)
        status = check_h(r);
    if (!status && scene->objects > UINT32_MAX)
        status = fp3_fail(r->error, FP3_E_ARGUMENT, "%s: %zu objects: 4294967295 at most", r->path,
                          scene->objects);
    return status ? status : choose_config(r);
}

fp3_status fp3_scene_read(fp3_scene *scene, const char *config, fp3_error *error) {
    reader of = {.scene = scene, .path = scene->path, .config = config, .error = error}, *r = &of;
    fp3_status status;
    config_t file;
    config_init(&file);
    if (config_read_file(&file, r->path))
        status = read_scene(r, config_root_setting(&file));
    else if (config_error_type(&file) == CONFIG_ERR_FILE_IO)
        status = fp3_fail(r->error, FP3_E_ARGUMENT, "%s: cannot be read", r->path);
    else
        status = fp3_fail(r->error, FP3_E_ARGUMENT, "%s:%d: %s", r->path, config_error_line(&file),
                          config_error_text(&file));
    config_destroy(&file);
    return status;
}
