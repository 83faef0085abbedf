/* SPDX-License-Identifier: Apache-2.0 */
/* unit.h - units of measurement as texts, for who has no model of them. */
#ifndef FP3_TEXT_UNIT_H
#define FP3_TEXT_UNIT_H

/* Whether it is the name of a length: "m", "km", "AU". */
int fp3_unit_is_length(const char *unit);

#endif
