/* foreseen.h - how many cycles the hardware will take for a run of objects that see each other,
 * from the program, the lists and isa/timing.toml. Of a test that is one file.
 */
#ifndef FP3_TESTS_FORESEEN_H
#define FP3_TESTS_FORESEEN_H

#include "engine/common/ghosts.h"
#include "engine/common/inside.h"
#include "gen/timing.h"
#include "machine/cycles.h"
#include "machine/neighbours.h"
#include "machine/phased.h"

/* `phase` is taken a cycle after the last sweep has begun, and ends the round a cycle later. */
#define PHASE_ENDS 2

typedef struct {
    uint32_t rows;   /* objects of the fullest lane */
    uint32_t copies; /* from lane to lane before each phase ... */
    uint32_t words;  /* ... of so many published words */
    fp3_engine *engine;
} foreseen_run;

/* The longest of the lists of register reg that the objects in these rows have, in whichever lane.
 */
static uint32_t longest_of(fp3_engine *engine, uint32_t reg, uint32_t first_row, uint32_t rows) {
    const fp3_members *group = &fp3_engine_layout(engine)->groups[0];
    const fp3_list *list = group->lists.lists;
    uint32_t most = 0;
    while (list->reg != reg)
        list++;
    for (uint32_t i = 0; i < group->objects; i++) {
        const uint32_t row =
            fp3_layout_where(fp3_engine_layout(engine), fp3_engine_config(engine), i).row;
        if (row >= first_row && row - first_row < rows && fp3_list_length(list, i) > most)
            most = fp3_list_length(list, i);
    }
    return most;
}

/* Issues of a round: sweeps follow each other, and two that have a context in common are GAP cycles
 * apart. */
typedef struct {
    uint64_t start; /* of the sweep before */
    uint32_t count; /* ... its contexts; 0: there is none */
    uint32_t gap;
} issues;

static void sweep(issues *s, uint32_t count, uint32_t late) {
    const uint32_t fewer = s->count < count ? s->count : count;
    const uint64_t soonest =
        s->start + s->count + (s->count && fewer < s->gap ? s->gap - fewer : 0);
    s->start = soonest > s->start + late ? soonest : s->start + late;
    s->count = count;
}

/* Words begin .. end of the program, for one batch. late: the next issue is not sooner after the
 * start of the one before. */
static void issue_batch(const fp3_phased *program, const foreseen_run *run, issues *s,
                        const fp3_phase_cost *phase, uint32_t first, uint32_t count) {
    uint32_t late = 0, turn = 0, turns = 0, loop = 0;
    for (uint32_t pc = phase->begin; pc < phase->end; pc++) {
        const uint32_t op = program->code[pc].of ? program->code[pc].in.op : 0;
        if (op == FP3_OP_NEXT && ++turn == turns) {
            late += late > 0; /* nothing stands in the loop */
            continue;
        }
        sweep(s, count, late);
        late = 0;
        if (op == FP3_OP_NEXT)
            pc = loop;
        if (op != FP3_OP_EACH)
            continue;
        turns = longest_of(run->engine, program->code[pc].in.d, first, count);
        turn = 0;
        loop = pc;
        late = count + phase->loop;
        if (!turns) { /* words up to `next` are dropped, one in each cycle */
            pc += fp3_turn_cost_of(program, pc);
            late += pc - loop;
        }
    }
}

static uint64_t run_cycles(const fp3_config *config, const fp3_phased *program,
                           const foreseen_run *run, uint32_t steps) {
    const uint32_t most = config->contexts;
    uint64_t cycles = 0;
    fp3_repetition repetition = {0, 0};
    for (uint32_t begin = 0; begin < program->count;) {
        const fp3_phase_cost phase = fp3_phase_cost_of(config, program, begin);
        issues s = {.gap = fp3_cycles_gap(config)};
        for (uint32_t first = 0; first < run->rows; first += most) {
            const uint32_t left = run->rows - first;
            issue_batch(program, run, &s, &phase, first, left < most ? left : most);
        }
        const int is_last = phase.end + 1 >= program->count; /* or an `again` ends the program */
        cycles += fp3_cycles_copies(config, run->copies, run->words) + s.start +
                  (!is_last && s.count < PHASE_ENDS ? PHASE_ENDS : s.count) +
                  fp3_cycles_around_round(config);
        begin = phase.end == program->count
                    ? program->count
                    : fp3_neighbourhood_behind(program->code, phase.end, &repetition);
    }
    return steps * cycles + fp3_cycles_settle(config) + FP3_TIMING_RUN;
}

/* The counter CYCLES of a run of so many steps of the engine's configuration, at least 1, whichever
 * backend the engine has. The program's lists are those that the host has given; lists of those
 * that are near have to be made already. FP3_E_SYSTEM: out of memory. */
static fp3_status foreseen_cycles(fp3_engine *engine, uint32_t steps, uint64_t *cycles) {
    const fp3_members *group = &fp3_engine_layout(engine)->groups[0];
    const fp3_phased program = {group->program.decoded, group->program.count};
    foreseen_run run = {
        .rows = fp3_layout_rows(fp3_engine_layout(engine), fp3_engine_config(engine), 0, 0),
        .engine = engine};
    fp3_ghosts ghosts;
    const fp3_status status = fp3_ghosts_find(engine, &ghosts);
    run.copies = ghosts.count;
    for (uint64_t left = fp3_layout_published(group); left; left &= left - 1)
        run.words++;
    if (!status)
        *cycles = run_cycles(fp3_engine_config(engine), &program, &run, steps);
    fp3_ghosts_free(&ghosts);
    return status;
}

#endif
