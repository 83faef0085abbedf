/* SPDX-License-Identifier: Apache-2.0 */
/* adapt.h - adaptive steps that objects of several models make together. */
#ifndef FP3_ADAPT_H
#define FP3_ADAPT_H

#include <fp3/compile.h>

/* Each of these adapted models gets the states and params that one of them needs to look for an
 * event, and a `maxstep` that one of them has. The first step and the longest one are then the
 * shortest of all, and an event may be as late as any model allows. All of them choose their steps,
 * or none. FP3_E_PROGRAM: as fp3_model_adapt. */
fp3_status fp3_models_adapt_alike(fp3_model *const *list, size_t count, fp3_error *error);

#endif
