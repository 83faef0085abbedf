/* SPDX-License-Identifier: Apache-2.0 */
/* positions.c - see positions.h. */
#include "positions.h"

#include <stdlib.h>

const fp3_near_rule *fp3_positions_rule(const fp3_members *group) {
    uint32_t i = 0;
    while (!group->lists.lists[i].is_near)
        i++;
    return &group->lists.lists[i].near;
}

double fp3_positions_skin(const fp3_members *group) {
    double least = INFINITY;
    for (uint32_t i = 0; i < group->lists.shape.list_count; i++)
        if (group->lists.lists[i].is_near)
            least = fmin(least, group->lists.lists[i].near.skin);
    return least;
}

fp3_status fp3_positions_read(fp3_engine *engine, const fp3_near_rule *rule, fp3_positions *p) {
    fp3_status status = FP3_OK;
    *p = (fp3_positions){.dimensions = rule->dimensions, .rule = rule};
    for (uint32_t k = 0; !status && k < rule->dimensions; k++) {
        const fp3_cells cells = {FP3_CELLS_REGISTER, rule->regs[k], 0, engine->objects};
        p->word[k] = malloc(engine->objects * sizeof *p->word[k]);
        status =
            p->word[k] ? fp3_ranks_read(engine, cells, p->word[k]) : fp3_ranks_no_memory(engine);
    }
    return status;
}
