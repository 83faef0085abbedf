/* cells.h - one register of one object. */
#ifndef FP3_CELLS_H
#define FP3_CELLS_H

#include "backend.h"

/* Without a check. It may be the sleep register: the host's copy of it, and what the next run begins
 * with, follow. */
fp3_status fp3_engine_write_cell(fp3_engine *engine, size_t object, uint32_t reg, uint32_t bits);

#endif
