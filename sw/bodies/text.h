/* SPDX-License-Identifier: Apache-2.0 */
/* text.h - the texts of programs/bodies/ in the library. */
#ifndef FP3_BODIES_TEXT_H
#define FP3_BODIES_TEXT_H

extern const char fp3_law_text_contact2[], fp3_law_text_gap2[], fp3_law_text_warm2[],
    fp3_law_text_twist2[], fp3_law_text_slide2[], fp3_law_text_rod2[], fp3_law_text_pin2[],
    fp3_law_text_meet3[], fp3_law_text_give3[], fp3_law_text_push3[], fp3_law_text_gap3[],
    fp3_law_text_rub3[], fp3_law_text_roll3[], fp3_law_text_turn3[], fp3_law_text_pin3[],
    fp3_law_text_spin3[], fp3_law_text_line3[], fp3_law_text_twist3[];

#endif
