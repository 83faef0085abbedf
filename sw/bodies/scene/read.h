/* SPDX-License-Identifier: Apache-2.0 */
/* read.h - numbers of a scene of bodies, which may be formulas, and copies of an entry. */
#ifndef FP3_BODIES_SCENE_READ_H
#define FP3_BODIES_SCENE_READ_H

#include "scene.h"

#include "base/settings.h"
#include "world/table.h"

#include <fp3/model.h>

#define FP3_COUNTERS 3 /* i, j and k */

/* A formula and the text that it was read from. */
typedef struct {
    const char *text;
    fp3_formula *formula;
} fp3_read_formula;

typedef struct {
    const fp3_settings *in;
    fp3_bodies_scene *scene;
    uint64_t seed;
    unsigned dimensions; /* 2: a plane; 3: space */
    /* What names in formulas stand for. */
    double counter[FP3_COUNTERS], number, corner;
    unsigned counters;       /* that the entry has */
    double cell[2];          /* column and row of a height */
    int has_corner;          /* a list of corners is read */
    int has_cell;            /* ... a formula of heights */
    const fp3_table *points; /* of the entry, or NULL */
    size_t row;
    uint64_t random;
    fp3_read_formula *formulas; /* of the entry */
    size_t formula_count;
    uint32_t formula_room;
} fp3_reader;

/* What is the setting's name in a message. */
fp3_status fp3_read_number(fp3_reader *r, const config_setting_t *at, const char *what,
                           double *value);
/* A list of 2 to 4 numbers. */
fp3_status fp3_read_numbers(fp3_reader *r, const config_setting_t *at, const char *what,
                            unsigned count, double *numbers);
/* x and y, in space z, too. */
fp3_status fp3_read_point(fp3_reader *r, const config_setting_t *at, const char *what,
                          double *point);
/* Of settings that may be missing: *value is unchanged then. */
fp3_status fp3_read_value(fp3_reader *r, const config_setting_t *group, const char *name,
                          double *value);
fp3_status fp3_read_place(fp3_reader *r, const config_setting_t *group, const char *name,
                          double *place);
fp3_status fp3_read_turn(fp3_reader *r, const config_setting_t *group, double q[4]);
fp3_status fp3_read_flag(fp3_reader *r, const config_setting_t *group, const char *name, int *flag);

/* Whether no setting is there that only the other kind of world has; the lists end with NULL. */
fp3_status fp3_read_fits(const fp3_reader *r, const config_setting_t *group,
                         const char *const *plane, const char *const *space);

/* Points in a list, ( [0, 0], [1, 0] ), or { count = 12; at = [...]; } with the name `corner`, or
 * "FILE". The caller frees *corners (2 or 3 numbers of each), after a failure too. */
fp3_status fp3_read_corners(fp3_reader *r, const config_setting_t *at, const char *what,
                            double **corners, size_t *count);

/* A file beside the scene, which is one that the run has read; *path is the scene's. And what is
 * wrong with it, behind the line of the setting that names it. */
fp3_status fp3_read_path(fp3_reader *r, const char *name, const char **path);
fp3_status fp3_read_failed(const fp3_reader *r, const config_setting_t *at, fp3_status status,
                           const fp3_error *why);

/* The formula of a text within another one; it is kept with the entry's. */
fp3_status fp3_read_formula_part(fp3_reader *r, const config_setting_t *at, const char *what,
                                 const char *text, size_t length, double *value);

/* Calls `one` for each copy that an entry makes: by its `count` (up to three numbers, inner ones of
 * the counters outside them) and its file of `points`, or once. entry: its number, from which
 * `random` begins. */
typedef fp3_status fp3_copy_fn(fp3_reader *r, const config_setting_t *entry, void *user);
fp3_status fp3_read_copies(fp3_reader *r, const config_setting_t *entry, size_t number,
                           fp3_copy_fn *one, void *user);
void fp3_reader_close(fp3_reader *r);

/* What the world has refused, with the line of the setting that its message names, or of the group;
 * what is refused is `what`. */
fp3_status fp3_read_refused(const fp3_reader *r, const config_setting_t *group, const char *what,
                            fp3_status status);

/* parts.c, joints.c */
fp3_status fp3_read_bodies(fp3_reader *r, const config_setting_t *list);
fp3_status fp3_read_joints(fp3_reader *r, const config_setting_t *list);
/* All shapes that a body's entry gives it. */
fp3_status fp3_read_shapes(fp3_reader *r, const config_setting_t *entry, uint64_t handle);
/* ground.c: of a shape that has `mesh`, or `heights`. */
fp3_status fp3_read_mesh(fp3_reader *r, const config_setting_t *from, uint64_t handle,
                         const fp3_shape_def *surface);
fp3_status fp3_read_heights(fp3_reader *r, const config_setting_t *from, uint64_t handle,
                            const fp3_shape_def *surface);

#endif
