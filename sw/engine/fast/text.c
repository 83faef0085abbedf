/* SPDX-License-Identifier: Apache-2.0 */
/* text.c - see text.h. The assembler includes what C11 cannot; the Makefile knows that this depends
 * on it. */
#include "text.h"

__asm__(".section .rodata\n"
        ".global fp3_text_place, fp3_text_lanes, fp3_text_fused, fp3_text_halves, fp3_text_turns\n"
        ".hidden fp3_text_place, fp3_text_lanes, fp3_text_fused, fp3_text_halves, fp3_text_turns\n"
        "fp3_text_place: .incbin \"sw/engine/fast/place.h\"\n"
        ".byte 0\n"
        "fp3_text_lanes: .incbin \"sw/engine/fast/lanes.h\"\n"
        ".byte 0\n"
        "fp3_text_fused: .incbin \"sw/engine/fast/fused.h\"\n"
        ".byte 0\n"
        "fp3_text_halves: .incbin \"sw/engine/fast/halves.h\"\n"
        ".byte 0\n"
        "fp3_text_turns: .incbin \"sw/engine/fast/turns.h\"\n"
        ".byte 0\n"
        ".previous\n");
