/* SPDX-License-Identifier: Apache-2.0 */
/* lifetime.h - when the objects of a scene are born and gone: from the file, to the engine. */
#ifndef FP3_SCENE_LIFETIME_H
#define FP3_SCENE_LIFETIME_H

#include "base/settings.h"

#include <fp3/scene.h>

/* `born` and `gone` of a group: a step, or [FIRST, LAST]. Defaults: 0 and FP3_FOREVER. The group's
 * objects are counted already. Refused: an object that is not gone after its birth. */
fp3_status fp3_lifetime_read(const fp3_settings *s, const config_setting_t *from,
                             fp3_scene_group *to);

/* Whether some object does not live always. */
int fp3_lifetime_is_any(const fp3_scene_group *group);

/* To the engine that the group is loaded into; the engine says what it refuses. */
fp3_status fp3_lifetime_apply(const fp3_scene_group *group, fp3_engine *engine);

#endif
