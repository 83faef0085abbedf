/* SPDX-License-Identifier: Apache-2.0 */
/* text.c - see text.h. The assembler includes what C11 cannot; the Makefile knows that this depends
 * on the texts. */
#include "text.h"

#ifdef __wasm__ /* a section of its own for each, with its size */
#define BEGIN(name)                                                                                \
    ".section .rodata." name ",\"\",@\n"                                                           \
    ".type fp3_law_text_" name ", @object\n"
#define END(name) ".size fp3_law_text_" name ", . - fp3_law_text_" name "\n"
#define BACK
#else
#define BEGIN(name) ".section .rodata\n"
#define END(name)
#define BACK ".previous\n"
#endif

/* Each on its own: a text may have 4,095 letters. */
#define TEXT(name)                                                                                 \
    __asm__(BEGIN(name) ".global fp3_law_text_" name "\n"                                          \
                        ".hidden fp3_law_text_" name "\n"                                          \
                        "fp3_law_text_" name ": .incbin \"programs/bodies/" name ".ode\"\n"        \
                        ".byte 0\n" END(name) BACK)
TEXT("contact2");
TEXT("gap2");
TEXT("warm2");
TEXT("twist2");
TEXT("slide2");
TEXT("rod2");
TEXT("pin2");
TEXT("gap3");
TEXT("roll3");
TEXT("meet3");
TEXT("push3");
TEXT("rub3");
TEXT("give3");
TEXT("turn3");
TEXT("pin3");
TEXT("spin3");
TEXT("line3");
TEXT("twist3");
