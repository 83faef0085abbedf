/* SPDX-License-Identifier: Apache-2.0 */
/* text.c - see text.h. The assembler includes what C11 cannot; the Makefile knows that this depends
 * on it. */
#include "text.h"

#define TEXT(name, file)                                                                           \
    ".global fp3_view_text_" name "\n"                                                             \
    ".hidden fp3_view_text_" name "\n"                                                             \
    "fp3_view_text_" name ": .incbin \"sw/view/page/" file "\"\n"                                  \
    ".byte 0\n"

__asm__(".section .rodata\n" TEXT("head", "head.html") TEXT("style", "style.css")
            TEXT("body", "body.html") TEXT("data", "data.js") TEXT("camera", "camera.js")
                TEXT("shaders", "shaders.js") TEXT("bodies", "bodies.js") TEXT("scene", "scene.js")
                    TEXT("plot", "plot.js") TEXT("app", "app.js") ".previous\n");
