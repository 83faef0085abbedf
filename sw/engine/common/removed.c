/* SPDX-License-Identifier: Apache-2.0 */
/* removed.c - see removed.h. */
#include "removed.h"

#include "machine/format.h"

#define LOOK 512 /* objects that are asked together */

void fp3_removed_note(fp3_engine *engine, size_t first, size_t count, const uint32_t *words) {
    const int is_float = fp3_format_is_float(engine->config);
    uint8_t *removed = engine->lives.removed;
    for (size_t i = 0; removed && i < count; i++) {
        const int is =
            is_float ? words[i] << 1 != 0 : fp3_format_value(engine->config, words[i]) != 0;
        if ((removed[first + i] & FP3_REMOVED_NOW) == is)
            continue;
        removed[first + i] ^= FP3_REMOVED_NOW;
        engine->lives.change = 0; /* others live */
        engine->sleepers.is_listed = 0;
    }
}

void fp3_removed_run(fp3_engine *engine) {
    uint8_t *removed = engine->lives.removed;
    for (size_t i = 0; removed && i < engine->objects; i++)
        removed[i] = removed[i] & FP3_REMOVED_NOW ? FP3_REMOVED_NOW | FP3_REMOVED_BEFORE : 0;
}

fp3_status fp3_removed_look(fp3_engine *engine) {
    uint32_t words[LOOK];
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; engine->lives.removed && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        for (uint32_t n = 0, now; !status && group->removed >= 0 && n < group->rows; n += now) {
            now = group->rows - n < LOOK ? group->rows - n : LOOK;
            status = engine->backend->read(
                engine,
                (fp3_cells){FP3_CELLS_REGISTER, (uint32_t)group->removed, group->first + n, now},
                words);
            if (!status)
                fp3_removed_note(engine, group->first + n, now, words);
        }
    }
    engine->lives.is_looked = !status;
    return status;
}
