/* SPDX-License-Identifier: Apache-2.0 */
/* checks.h - what calls of fp3/engine.h check first, and what they ask about an object. */
#ifndef FP3_CHECKS_H
#define FP3_CHECKS_H

#include "backend.h"

/* Whether first .. first + count - 1 are below has; what names them in the message. */
fp3_status fp3_engine_check_range(fp3_engine *engine, const char *what, size_t first, size_t count,
                                  size_t has);
fp3_status fp3_engine_check_objects(fp3_engine *engine, size_t first, size_t count);
fp3_status fp3_engine_check_loaded(fp3_engine *engine);

/* FP3_E_ARGUMENT: some list of neighbours has not been given. */
fp3_status fp3_engine_check_neighbours(fp3_engine *engine);

#endif
