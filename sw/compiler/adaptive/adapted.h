/* SPDX-License-Identifier: Apache-2.0 */
/* adapted.h - what values of adaptive steps may be. */
#ifndef FP3_ADAPTED_H
#define FP3_ADAPTED_H

#include "compiler/step/options.h"

/* Columns of count objects. FP3_E_ARGUMENT: a tolerance that is not above 0 or too small for FP32,
 * a start behind the end, an invalid step; of any model, an event at the start time of an object.
 */
fp3_status fp3_adapted_check(const fp3_model *model, const fp3_options *options,
                             const double *params, const double *initial, size_t count,
                             fp3_error *error);

#endif
