/* foreseen.h - how many cycles the hardware will take for a run of objects that see each other,
 * from the program, the lists and isa/timing.toml. Of a test that is one file.
 */
#ifndef FP3_TESTS_FORESEEN_H
#define FP3_TESTS_FORESEEN_H

#include "engine/board/shared_list.h"
#include "engine/common/ghosts.h"
#include "engine/common/inside.h"
#include "gen/timing.h"
#include "machine/cycles.h"
#include "machine/neighbours.h"
#include "machine/phased.h"

/* The longest of the lists of register reg that the objects in these rows have, in whichever lane.
 */
static uint32_t longest_of(const void *user, uint32_t reg, uint32_t first_row, uint32_t rows) {
    fp3_engine *engine = (fp3_engine *)(uintptr_t)user;
    const fp3_members *group = &fp3_engine_layout(engine)->groups[0];
    const fp3_list *list = group->lists.lists;
    uint32_t most = 0;
    while (list->reg != reg)
        list++;
    for (uint32_t i = 0; i < group->objects; i++) {
        const uint32_t row =
            fp3_layout_where(fp3_engine_layout(engine), fp3_engine_config(engine), i).row;
        const uint32_t turns = fp3_list_turns(fp3_engine_config(engine), list, i);
        if (row >= first_row && row - first_row < rows && turns > most)
            most = turns;
    }
    return most;
}

/* The counter CYCLES of a run of so many steps of the engine's configuration, at least 1, whichever
 * backend the engine has. The program's lists are those that the host has given; lists of those
 * that are near have to be made already. FP3_E_SYSTEM: out of memory. */
static fp3_status foreseen_cycles(fp3_engine *engine, uint32_t steps, uint64_t *cycles) {
    const fp3_members *group = &fp3_engine_layout(engine)->groups[0];
    const fp3_phased program = {group->program.decoded, group->program.count};
    fp3_ghosts ghosts;
    const fp3_status status = fp3_ghosts_find(engine, &ghosts);
    fp3_phased_run run = {
        .rows = fp3_layout_rows(fp3_engine_layout(engine), fp3_engine_config(engine), 0, 0),
        .copies = ghosts.count,
        .longest = longest_of,
        .user = engine};
    for (uint64_t left = fp3_layout_published(group); left; left &= left - 1)
        run.words++;
    if (!status)
        *cycles = steps * fp3_phased_cycles(fp3_engine_config(engine), &program, &run) +
                  fp3_cycles_settle(fp3_engine_config(engine)) + FP3_TIMING_RUN;
    fp3_ghosts_free(&ghosts);
    return status;
}

#endif
