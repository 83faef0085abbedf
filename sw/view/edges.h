/* SPDX-License-Identifier: Apache-2.0 */
/* edges.h - which edges the triangles of shapes have. */
#ifndef FP3_VIEW_EDGES_H
#define FP3_VIEW_EDGES_H

#include "recorded.h"

/* Sets the edges of all shapes, and which rims triangles have. An edge between two triangles of one
 * plane is none; one that is not between two triangles, or at which the surface bends by more than
 * 30 degrees, is sharp. A shape without triangles has the edge from its first corner to its last;
 * a hull whose triangles were not recorded, a ball at each corner. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_view_edges_find(fp3_view_recording *r, fp3_error *error);

#endif
