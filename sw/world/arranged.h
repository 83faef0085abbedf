/* SPDX-License-Identifier: Apache-2.0 */
/* arranged.h - objects of a group that a structure or a file places and links: `grid`, `random`,
 * `points`, `links`, `only`. */
#ifndef FP3_SCENE_ARRANGED_H
#define FP3_SCENE_ARRANGED_H

#include "base/settings.h"
#include "fill.h"
#include "grid.h"
#include "table.h"

#include <fp3/scene.h>

typedef struct {
    const config_setting_t *grid_at, *random_at, *points_at; /* NULL: it is not there */
    fp3_grid grid;
    fp3_fill fill;
    fp3_table points;
} fp3_arranged;

/* objects: the number of objects that the settings imply, or 0. The caller closes *arranged, after
 * a failure too. */
fp3_status fp3_arranged_read(const fp3_settings *s, const config_setting_t *from,
                             fp3_arranged *arranged, uint64_t *objects);
void fp3_arranged_close(fp3_arranged *arranged);

/* Places the objects, links them, and gives some of them other values. The group has its program,
 * its number of objects and all other values. draw: added to the seed of `random`. */
fp3_status fp3_arranged_apply(const fp3_settings *s, const config_setting_t *from, uint64_t draw,
                              fp3_arranged *arranged, fp3_scene_group *group);

#endif
