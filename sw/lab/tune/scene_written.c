/* SPDX-License-Identifier: Apache-2.0 */
/* scene_written.c - a scene's file again, with the settings of a choice. Comments are lost, numbers
 * stay as they are spelled. */
#include "recast.h"

#include "base/definition.h"
#include "base/host.h"
#include "base/path.h"
#include "base/settings.h"
#include "world/kinds_steps.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    FILE *to;
    const fp3_settings *in;
    const fp3_scene_tuning *t;
    const fp3_scene_tune_row *best;
    const char *scene; /* where it is */
    char *folder;      /* from where files are named, behind all links; NULL: unchanged */
    fp3_status status;
} writer;

static void put_setting(writer *w, const config_setting_t *at, unsigned depth);

static void put_string(writer *w, const char *text) {
    fputc('"', w->to);
    for (; *text; text++) {
        if (strchr("\"\\", *text))
            fputc('\\', w->to);
        fputc(*text, w->to);
    }
    fputc('"', w->to);
}

/* A file that the scene names, as seen from the folder; NULL: out of memory. */
static char *seen_from(const char *folder, const char *path) {
    char *real = fp3_path_resolve(path), *name = NULL;
    const char *to = real ? real : path;
    size_t same = 0, up = 0, i = 0;
    for (; to[i] && to[i] == folder[i]; i++)
        if (to[i] == '/')
            same = i + 1;
    for (const char *c = folder + same; same < strlen(folder) && *c; c++)
        up += *c == '/';
    name = malloc(3 * up + strlen(to + same) + 1);
    if (name) {
        *name = '\0';
        for (size_t k = 0; k < up; k++)
            strcat(name, "../");
        strcat(name, to + same);
    }
    free(real);
    return name;
}

static void put_file(writer *w, const char *name) {
    char *path = w->folder && name[0] != '/' ? fp3_path_beside(w->scene, name) : NULL;
    char *seen = path ? seen_from(w->folder, path) : NULL;
    put_string(w, seen ? seen : name);
    free(path);
    free(seen);
}

static int is_one_of(const char *name, const char *const *names) {
    for (; name && *names; names++)
        if (strcmp(name, *names) == 0)
            return 1;
    return 0;
}

/* Names of files: of a group, and of links. */
static int is_file(const config_setting_t *at) {
    static const char *const files[] = {"program", "params", "points", "file", NULL};
    const char *name = config_setting_name(at);
    return is_one_of(name, files) || /* a table of a file, not a built-in one */
           (name && strcmp(name, "integrator") == 0 && strchr(config_setting_get_string(at), '/'));
}

static void put_scalar(writer *w, const config_setting_t *at) {
    const char *text = config_setting_get_string(at);
    if (text && is_file(at)) {
        put_file(w, text);
    } else if (text) {
        put_string(w, text);
    } else if (config_setting_type(at) == CONFIG_TYPE_BOOL) {
        fputs(config_setting_get_bool(at) ? "true" : "false", w->to);
    } else {
        const fp3_token *number = &w->in->spelled.numbers[config_setting_get_int(at)];
        fprintf(w->to, "%.*s", (int)number->length, number->text);
    }
}

static void put_value(writer *w, const config_setting_t *at, unsigned depth) {
    const int is_group = config_setting_is_group(at), is_list = config_setting_is_list(at);
    const int count = config_setting_length(at);
    if (!is_group && !is_list && !config_setting_is_array(at)) {
        put_scalar(w, at);
        return;
    }
    fputs(is_group ? "{ " : is_list ? "( " : "[", w->to);
    for (int i = 0; i < count; i++) {
        const config_setting_t *of = config_setting_get_elem(at, (unsigned)i);
        if (is_group) {
            put_setting(w, of, depth + 1);
            fputs("; ", w->to);
        } else {
            fputs(i ? ", " : "", w->to);
            put_value(w, of, depth + 1);
        }
    }
    fputs(is_group ? "}" : is_list ? " )" : "]", w->to);
}

static void put_setting(writer *w, const config_setting_t *at, unsigned depth) {
    fprintf(w->to, "%s = ", config_setting_name(at));
    put_value(w, at, depth);
}

/* ---- groups ---- */

static uint64_t scaled(const writer *w, uint64_t steps) {
    return steps / w->best->joined * w->best->parts;
}

/* A number of steps, or those of the first and the last object. */
static void put_steps(writer *w, const config_setting_t *at) {
    const int count = config_setting_length(at);
    fprintf(w->to, "%s = %s", config_setting_name(at), count ? "[" : "");
    for (int i = 0; i < (count ? count : 1); i++) {
        uint64_t steps = 0;
        const config_setting_t *of = count ? config_setting_get_elem(at, (unsigned)i) : at;
        if (fp3_setting_count(w->in, of, "steps", 0, UINT32_MAX, &steps))
            w->status = FP3_E_ARGUMENT;
        fprintf(w->to, "%s%" PRIu64, i ? ", " : "", scaled(w, steps));
    }
    fprintf(w->to, "%s", count ? "]" : "");
}

/* The scene has one h, which the choice has for all. */
static void put_set(writer *w, const config_setting_t *at, unsigned depth) {
    const int count = config_setting_length(at);
    fprintf(w->to, "%s = { ", config_setting_name(at));
    for (int i = 0; i < count; i++) {
        const config_setting_t *of = config_setting_get_elem(at, (unsigned)i);
        if (strcmp(config_setting_name(of), FP3_NAME_STEP) == 0)
            continue;
        put_setting(w, of, depth + 1);
        fputs("; ", w->to);
    }
    fputs("}", w->to);
}

static void put_choice(writer *w, const fp3_model *model) {
    if (!fp3_kinds_never_move(model))
        fprintf(w->to, "        integrator = \"%s\";\n", w->best->integrator);
    if (w->best->arithmetic != FP3_PLAIN)
        fprintf(w->to, "        %s = true;\n", fp3_arithmetic_of(w->best->arithmetic)->name);
    if (w->t->skin >= 0 && fp3_recast_has_near(model))
        fprintf(w->to, "        skin = %.9g;\n", w->t->skin);
}

static void put_group(writer *w, const config_setting_t *group, const fp3_model *model) {
    static const char *const chosen[] = {"compensated", "double_single", "folded", NULL};
    static const char *const lives[] = {"born", "gone", NULL};
    const int count = config_setting_length(group);
    const int moves = !fp3_kinds_never_move(model);
    fputs("    {\n", w->to);
    for (int i = 0; i < count; i++) {
        const config_setting_t *at = config_setting_get_elem(group, (unsigned)i);
        const char *name = config_setting_name(at);
        if (is_one_of(name, chosen) || (moves && strcmp(name, "integrator") == 0) ||
            (w->t->skin >= 0 && strcmp(name, "skin") == 0))
            continue;
        fputs("        ", w->to);
        if (is_one_of(name, lives))
            put_steps(w, at);
        else if (strcmp(name, "set") == 0)
            put_set(w, at, 2);
        else
            put_setting(w, at, 2);
        fputs(";\n", w->to);
    }
    put_choice(w, model);
    fputs("    }", w->to);
}

/* As few digits as give the same FP32 number. */
static void put_h(writer *w) {
    char text[32];
    for (int digits = 1; digits <= 9; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, w->best->h);
        if (strtof(text, NULL) == (float)w->best->h)
            break;
    }
    fprintf(w->to, "h = %s%s;\n", text, strpbrk(text, ".en") ? "" : ".0");
}

static void put_head(writer *w, const fp3_scene_tune_def *def) {
    static const char *const own[] = {"steps", "h", "groups", "config", NULL};
    const fp3_scene_tuning *t = w->t;
    fprintf(w->to, "# Made by fp3 tune for tolerance %g over %" PRIu64 " of the scene's steps.\n",
            def->tolerance, t->steps);
    if (t->known < t->steps)
        fprintf(w->to, "# Errors are known up to its step %" PRIu64 ".\n", t->known);
    fprintf(w->to, "# %" PRIu32 " held-out scenes (%s) have an error of %.2e at most.\n",
            t->held_out, t->differ, t->error_held_out);
    fprintf(w->to, "config = \"%s\";\n", t->config);
    for (int i = 0; i < config_setting_length(w->in->root); i++) {
        const config_setting_t *at = config_setting_get_elem(w->in->root, (unsigned)i);
        if (is_one_of(config_setting_name(at), own))
            continue;
        put_setting(w, at, 0);
        fputs(";\n", w->to);
    }
    fprintf(w->to, "steps = %" PRIu64 ";\n", scaled(w, t->known));
    put_h(w);
}

static void put_scene(writer *w, const fp3_scene_tune_def *def, const fp3_scene *scene) {
    const config_setting_t *groups = config_setting_get_member(w->in->root, "groups");
    put_head(w, def);
    fputs("\ngroups = (\n", w->to);
    for (size_t i = 0; i < scene->group_count; i++) {
        put_group(w, config_setting_get_elem(groups, (unsigned)i), scene->groups[i].program->model);
        fputs(i + 1 < scene->group_count ? ",\n" : "\n", w->to);
    }
    fputs(");\n", w->to);
}

static fp3_status write_text(writer *w, const fp3_scene_tune_def *def, const fp3_scene *scene,
                             char **text, fp3_error *error) {
    size_t size = 0;
    w->to = open_memstream(text, &size);
    if (!w->to)
        return fp3_no_memory(error);
    put_scene(w, def, scene);
    return fclose(w->to) ? fp3_no_memory(error) : w->status;
}

/* With a slash at its end. */
static char *real_folder(const char *folder) {
    char *real = fp3_path_resolve(folder);
    char *more = real ? realloc(real, strlen(real) + 2) : NULL;
    if (more && more[strlen(more) - 1] != '/')
        strcat(more, "/");
    if (!more)
        free(real);
    return more;
}

fp3_status fp3_scene_tuning_text(const fp3_scene_tune_def *def, const fp3_scene_tuning *tuning,
                                 const char *folder, char **text, fp3_error *error) {
    FP3_HOST;
    *text = NULL;
    if (fp3_definition_check(def, sizeof *def, "fp3_scene_tune_def", error))
        return FP3_E_ARGUMENT;
    if (tuning->best >= tuning->row_count)
        return fp3_fail(error, FP3_E_ARGUMENT, "nothing meets the tolerance: there is no scene");
    fp3_settings in;
    fp3_scene *scene = NULL;
    writer w = {.in = &in,
                .t = tuning,
                .best = &tuning->rows[tuning->best],
                .scene = def->path,
                .folder = folder ? real_folder(folder) : NULL};
    fp3_status status = fp3_settings_load(def->path, FP3_E_ARGUMENT, &in, error);
    if (!status && folder && !w.folder)
        status = fp3_path_fail(error, folder, "cannot name the scene's files from there");
    if (!status)
        status = fp3_scene_open(def->path, def->config, &scene, error);
    if (!status)
        status = write_text(&w, def, scene, text, error);
    if (status) {
        free(*text);
        *text = NULL;
    }
    fp3_scene_close(&scene);
    fp3_settings_close(&in);
    free(w.folder);
    return status;
}
