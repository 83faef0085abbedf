/* SPDX-License-Identifier: Apache-2.0 */
/* text.h - place.h, lanes.h, fused.h, halves.h and turns.h as text. */
#ifndef FP3_TEXT_H
#define FP3_TEXT_H

extern const char fp3_text_place[], fp3_text_lanes[], fp3_text_fused[], fp3_text_halves[],
    fp3_text_turns[];

#endif
