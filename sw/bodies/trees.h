/* SPDX-License-Identifier: Apache-2.0 */
/* trees.h - hinges and welds of a heavy tree, all at once.
 *
 * Passes go from joint to joint, and so what a heavy body pulls comes only slowly through light
 * ones. Where bodies that are joined are a tree, with at most one joint to what does not move, and
 * weigh together more than a hundred times the lightest of them, the impulses of all of their
 * hinges and firm welds are found at once, in a time that grows with their number: from the leaves
 * to a root each body takes over what hangs on it, and back each joint gets its impulse. Springs,
 * motors, limits and contacts stay with the passes. In double precision; by no engine, so all
 * engines have the same bits.
 */
#ifndef FP3_BODIES_TREES_H
#define FP3_BODIES_TREES_H

#include "own.h"

/* Behind the rows' lanes and before their words: marks joints of trees, `is_in_tree`. */
fp3_status fp3_trees_find(fp3_bodies *bodies);
/* A substep begins: what points of trees did in the one before is no guess of what they do. */
void fp3_trees_forget(fp3_bodies *bodies);
/* In a substep, where bodies are now. push: what is apart comes together; else speeds alone. */
void fp3_trees_solve(fp3_bodies *bodies, int push);
void fp3_trees_free(fp3_bodies *bodies);

#endif
