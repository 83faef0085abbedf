/* SPDX-License-Identifier: Apache-2.0 */
/* radii.h - what single objects add to the reach of `near`: params, which no step changes. */
#ifndef FP3_ENGINE_RADII_H
#define FP3_ENGINE_RADII_H

#include "inside.h"

/* What may be added to a reach. */
int fp3_is_radius(double x);
/* Which registers of the rule they are in. FP3_E_ARGUMENT: the program has no such params. */
fp3_status fp3_radii_find(const fp3_engine *engine, size_t group, const char *name,
                          const fp3_near *near, fp3_near_rule *rule);
/* Before a run. FP3_E_ARGUMENT: an object has something else, or several processes make the run. */
fp3_status fp3_radii_check(fp3_engine *engine);

#endif
