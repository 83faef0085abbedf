/* SPDX-License-Identifier: Apache-2.0 */
/* positions.h - where the objects of all ranks are, where they see those that are near. */
#ifndef FP3_CLUSTER_POSITIONS_H
#define FP3_CLUSTER_POSITIONS_H

#include "inside.h"

#include "places.h"

/* The rule of the first relation `near`; all have its position. And the least skin of all. */
const fp3_near_rule *fp3_positions_rule(const fp3_members *group);
double fp3_positions_skin(const fp3_members *group);
/* All ranks together. fp3_positions_close whatever comes of it. */
fp3_status fp3_positions_read(fp3_engine *engine, const fp3_near_rule *rule, fp3_positions *p);

#endif
