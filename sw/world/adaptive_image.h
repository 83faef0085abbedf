/* SPDX-License-Identifier: Apache-2.0 */
/* adaptive_image.h - what values of a program of adaptive steps may be that is no model. */
#ifndef FP3_SCENE_ADAPTIVE_IMAGE_H
#define FP3_SCENE_ADAPTIVE_IMAGE_H

#include <fp3/image.h>
#include <fp3/program.h>

/* Of an object; share as of fp3_values_at. *is_spread: another share gives other values.
 * FP3_E_ARGUMENT: an end before the start, an invalid step or tolerance. Programs with fixed steps
 * are not checked. */
fp3_status fp3_adaptive_image_check(const fp3_image *image, const fp3_params *params, double share,
                                    int *is_spread, fp3_error *error);

#endif
