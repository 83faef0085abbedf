/* SPDX-License-Identifier: Apache-2.0 */
/* count.h - programs that count their steps in an FP32 number, and where that ends. */
#ifndef FP3_ENGINE_COUNT_H
#define FP3_ENGINE_COUNT_H

#include "backend.h"

/* So many steps were made. */
void fp3_engine_count(fp3_engine *engine, uint32_t steps);

#endif
