/* SPDX-License-Identifier: Apache-2.0 */
/* foreseen.c - see foreseen.h. */
#include "foreseen.h"

#include "engine/common/backend.h"

#include "engine/common/ghosts.h"
#include "machine/phased.h"

static uint32_t longest(const void *user, uint32_t reg, uint32_t first_row, uint32_t rows) {
    const fp3_engine *engine = user;
    const fp3_members *group = &engine->layout.groups[0];
    const fp3_list *list = group->lists.lists;
    uint32_t most = 0;
    while (list->reg != reg)
        list++;
    for (uint32_t i = 0; i < group->objects; i++) {
        const uint32_t row = fp3_layout_where(&engine->layout, engine->config, i).row;
        if (row >= first_row && row - first_row < rows && fp3_list_length(list, i) > most)
            most = fp3_list_length(list, i);
    }
    return most;
}

fp3_status fp3_foreseen_cycles(const fp3_engine *engine, uint32_t steps, uint64_t *cycles) {
    const fp3_members *group = &engine->layout.groups[0];
    const fp3_phased program = {group->program.decoded, group->program.count};
    fp3_phased_run run = {.rows = fp3_layout_rows(&engine->layout, engine->config, 0, 0),
                          .longest = longest,
                          .user = engine};
    fp3_ghosts ghosts;
    const fp3_status status = fp3_ghosts_find(engine, &ghosts);
    run.copies = ghosts.count;
    for (uint64_t left = fp3_layout_published(group); left; left &= left - 1)
        run.words++;
    if (!status)
        *cycles = fp3_cycles_phased(engine->config, &program, &run, steps);
    fp3_ghosts_free(&ghosts);
    return status;
}
