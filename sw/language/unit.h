/* SPDX-License-Identifier: Apache-2.0 */
/* unit.h - whether units of two models are the same. */
#ifndef FP3_ODE_UNIT_H
#define FP3_ODE_UNIT_H

/* As fp3_quantity.dimension has them: "m/s" is "s^-1*m". Where one is "", both fit. -1: out of
 * memory. */
int fp3_units_fit(const char *one, const char *other);

#endif
