/* SPDX-License-Identifier: Apache-2.0 */
/* sensitivity.h - how far a truth moves when one number of its object moves by one unit in the last
 * place.
 *
 * A param is no better known than that, so no arithmetic and no step makes a result better than
 * this.
 */
#ifndef FP3_TUNE_SENSITIVITY_H
#define FP3_TUNE_SENSITIVITY_H

#include "sample.h"

/* Of the sample's first object: the param or start that moves it most, at some times of the span,
 * and how far, as an error of fp3_sample_error. The last place is that of the configuration. "" and
 * 0: none moves it, or what has moved has no truth. */
fp3_status fp3_sensitivity_find(const fp3_sample *sample, const char *config,
                                char name[FP3_NAME_SIZE], double *moves, fp3_error *error);

#endif
