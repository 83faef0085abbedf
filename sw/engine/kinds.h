/* SPDX-License-Identifier: Apache-2.0 */
/* kinds.h - groups whose objects see each other: an engine for each group, which make a step
 * together.
 *
 * An engine of one group has its own objects, and behind them guests: all objects of each group
 * that it sees. When a phase begins, guests get the words that their objects hold then. So nothing
 * in an engine knows of other programs. Where objects are born and gone, an engine has those alone
 * that live, and when others do, each group gets another one.
 */
#ifndef FP3_KINDS_H
#define FP3_KINDS_H

#include "engine/common/backend.h"

typedef struct fp3_kinds fp3_kinds;

/* Loads one program into an engine of all its objects. */
typedef fp3_status fp3_kinds_load_fn(fp3_engine *own, const fp3_image *image);

/* For the groups of a layout that see each other; usual: the backend of each. FP3_E_PROGRAM:
 * something does not go with it, or as `load`; FP3_E_ARGUMENT: there is no such foreign word.
 * *group is the one that a failure is about, or layout->count where it is about all. *kinds is NULL
 * after a failure. */
fp3_status fp3_kinds_make(fp3_engine *engine, const fp3_backend *usual, fp3_kinds_load_fn *load,
                          fp3_layout *layout, uint32_t *group, fp3_kinds **kinds);
void fp3_kinds_free(fp3_kinds **kinds);

/* The backend of an engine whose objects are divided among these; the engine's self. It lives as
 * long. */
const fp3_backend *fp3_kinds_backend(const fp3_kinds *kinds);
/* The backend of each group, where the engine has kinds; else its own. */
const fp3_backend *fp3_kinds_usual(const fp3_engine *engine);

#endif
