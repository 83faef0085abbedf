/* SPDX-License-Identifier: Apache-2.0 */
/* scene_asked.h - what fp3/scene_tune.h is asked, and what it refuses. */
#ifndef FP3_TUNE_SCENE_ASKED_H
#define FP3_TUNE_SCENE_ASKED_H

#include <fp3/scene_tune.h>

/* The definition with a number for what it leaves open. FP3_E_ARGUMENT: a number is out of range.
 */
fp3_status fp3_scene_tune_settle(const fp3_scene_tune_def *asked, fp3_scene_tune_def *def,
                                 fp3_error *error);
/* FP3_E_ARGUMENT: its objects do not see each other, or its groups have steps of different lengths.
 */
fp3_status fp3_scene_tune_check(const fp3_scene *scene, fp3_error *error);

#endif
