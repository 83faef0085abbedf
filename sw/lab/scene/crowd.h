/* SPDX-License-Identifier: Apache-2.0 */
/* crowd.h - the objects of a scene in double: their values, who lives, and whom each one sees.
 *
 *     fp3_crowd crowd;
 *     fp3_status status = fp3_crowd_open(scene, &crowd, error);
 *     if (!status)
 *         status = fp3_sight_open(&crowd, error);
 *     ...
 *     fp3_crowd_close(&crowd);
 *
 * It shares no code with the compiler and the engines: only the language and the scene are read.
 */
#ifndef FP3_LAB_CROWD_H
#define FP3_LAB_CROWD_H

#include <fp3/scene.h>

/* What a word of a kind is in the other group. */
typedef struct {
    uint32_t group; /* FP3_NONE: the param is the object's own */
    uint32_t index; /* of its states, or params */
    int is_state;
} fp3_crowd_word;

/* Whom the objects of a group see by one relation: object i the entries begin[i] .. begin[i + 1]-1,
 * by their numbers or in the order of the links. Those of near objects are candidates, who may be
 * farther away than the reach, and less than that is asked of each pair. */
typedef struct {
    uint32_t group; /* of those that are seen */
    size_t *begin;  /* NULL: of `all` */
    uint32_t *who;
    size_t room;          /* entries that there is memory for */
    uint32_t field_count; /* `fields` has a column of begin[objects] numbers for each */
    double *fields, *next;
    /* Of near objects: where both groups were when the list was made, axis by axis. */
    double reach, skin;
    double *own, *theirs;
} fp3_crowd_sight;

typedef struct {
    const fp3_scene_group *of;
    const fp3_model *model;
    const fp3_integrator *integrator;
    size_t objects;
    double h;
    double *params, *states; /* columns, one after the other */
    double *offset;          /* of each object: its time when the scene begins */
    uint64_t *born, *gone;   /* steps of the scene */
    char *is_alive, *is_stopped;
    fp3_crowd_word *words;   /* of each param */
    fp3_crowd_sight *sights; /* of each relation */
} fp3_crowd_group;

typedef struct {
    fp3_crowd_group *groups;
    uint32_t group_count;
    size_t states; /* numbers of all states of all objects */
} fp3_crowd;

/* FP3_E_PROGRAM: the scene has what this cannot compute, which the message names with the reason.
 * Other errors as of fp3_scene_load. Nobody sees anybody yet. The caller closes, after a failure
 * too. */
fp3_status fp3_crowd_open(const fp3_scene *scene, fp3_crowd *crowd, fp3_error *error);
/* Leaves {0}, which may be closed as well. */
void fp3_crowd_close(fp3_crowd *crowd);

/* Who lives and does not stand still. */
static inline int fp3_crowd_moves(const fp3_crowd_group *group, size_t object) {
    return group->is_alive[object] && !group->is_stopped[object];
}

/* Who lives in the step after this one, of which the scene makes `parts` for each of its own. */
void fp3_crowd_live(fp3_crowd *crowd, uint64_t step, uint64_t parts);

/* A column of those that a relation of the group sees. */
const double *fp3_crowd_theirs(const fp3_crowd *crowd, double *const *states,
                               const fp3_crowd_group *group, const fp3_relation *r, int is_param,
                               uint32_t index);

#endif
