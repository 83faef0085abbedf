/* SPDX-License-Identifier: Apache-2.0 */
/* links.h - links between objects and reaches of lists, from settings and files to the values of a
 * program. */
#ifndef FP3_SCENE_LINKS_H
#define FP3_SCENE_LINKS_H

#include "base/settings.h"
#include "grid.h"

#include <fp3/scene.h>

/* The setting `links` of a group whose number of objects is known. grid: NULL: it has none. */
fp3_status fp3_links_read(const fp3_settings *s, const config_setting_t *from, const fp3_grid *grid,
                          fp3_scene_group *group);

/* The setting `skin`: of lists of those near. */
fp3_status fp3_skin_read(const fp3_settings *s, const config_setting_t *from,
                         const fp3_scene_group *group);

/* Notes that a file was read for the group. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_links_note(fp3_scene_group *group, const char *path, fp3_error *error);

#endif
