/* SPDX-License-Identifier: Apache-2.0 */
/* heavy2.h - heavy sets in a plane. */
#ifndef FP3_BODIES_HEAVY2_H
#define FP3_BODIES_HEAVY2_H

#include "heavy.h"

extern const fp3_heavy_laws fp3_heavy_laws2;

#endif
