/* SPDX-License-Identifier: Apache-2.0 */
/* image.h - a schedule as the image that the hardware takes. */
#ifndef FP3_COMPILER_IMAGE_H
#define FP3_COMPILER_IMAGE_H

#include <fp3/image.h>

#include "names.h"

/* The image that the assembler makes of the text of emit.h. The caller frees it. */
fp3_status fp3_compiler_image(const fp3_step *step, const conversion *c,
                              const fp3_schedule *schedule, const fp3_names *names,
                              fp3_image **image, fp3_error *error);

#endif
