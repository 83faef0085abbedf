/* SPDX-License-Identifier: Apache-2.0 */
/* fold.h - an operation as the cheapest node that has its bits. */
#ifndef FP3_FOLD_H
#define FP3_FOLD_H

#include "dag.h"

/* The node of op a, b, c, after what g->passes allow. b or c is FP3_NONE where op has none. */
uint32_t fp3_fold(dag *g, uint32_t op, uint32_t a, uint32_t b, uint32_t c);

#endif
