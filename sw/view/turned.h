/* SPDX-License-Identifier: Apache-2.0 */
/* turned.h - cosine and sine, within 1e-15 and the same on every machine. */
#ifndef FP3_VIEW_TURNED_H
#define FP3_VIEW_TURNED_H

/* Of an angle in degrees. */
void fp3_view_turned(double degrees, double cosine_sine[2]);

#endif
