/* SPDX-License-Identifier: Apache-2.0 */
/* turns.h - cycles of hardware for steps of a scene whose objects see each other, from its programs
 * and the lists that a run has had.
 *
 * On one lane they are exact for the lists at the looks, and their mean over these: of links, which
 * stay as they are, the cycles of each step. With more lanes, what is copied between them is left
 * out.
 */
#ifndef FP3_TUNE_TURNS_H
#define FP3_TUNE_TURNS_H

#include <fp3/scene.h>

typedef struct fp3_turns fp3_turns;

#define FP3_TURNS_LOOKS 8 /* at most */

/* The caller frees *turns, which is NULL on failure. The scene must outlive it. */
fp3_status fp3_turns_open(const fp3_scene *scene, fp3_turns **turns, fp3_error *error);
/* Sets *turns to NULL, which it may be already. */
void fp3_turns_free(fp3_turns **turns);

/* Looks at the lists of an engine that has the scene. */
fp3_status fp3_turns_look(fp3_turns *turns, fp3_engine *engine, fp3_error *error);
/* Cycles of a step of all objects; programs: in place of those of the scene's groups. */
double fp3_turns_cycles(const fp3_turns *turns, const fp3_program *programs);

#endif
