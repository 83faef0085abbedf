/* SPDX-License-Identifier: Apache-2.0 */
/* use.c - see use.h. */
#include "use.h"

#include "inside.h"

#include <stdlib.h>

void fp3_ranks_add_bus(fp3_bus_use *sum, const fp3_bus_use *more) {
    sum->transfers += more->transfers;
    sum->cycles += more->cycles;
    sum->requests += more->requests;
    sum->repeats += more->repeats;
    sum->bytes += more->bytes;
}

static fp3_rank_use use_of(const fp3_ranked *self) {
    fp3_rank_use use = self->use;
    const fp3_bus_use now = self->own ? fp3_engine_bus(self->own) : (fp3_bus_use){0};
    fp3_ranks_add_bus(&use.bus, &now);
    use.objects = self->share[self->ranks->rank];
    use.guests = self->guest_count;
    return use;
}

void fp3_ranks_count_run(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    uint64_t most = 0;
    for (uint32_t s = 0; self->own && s < fp3_config_schedulers(engine->config); s++) {
        const uint64_t cycles = self->own->counters[s][FP3_COUNTER_CYCLES];
        most = cycles > most ? cycles : most;
    }
    self->use.cycles += most;
    const fp3_rank_use use = use_of(self);
    uint64_t sums[] = {use.bus.transfers, use.bus.requests, use.bus.repeats, use.bus.bytes};
    self->ranks->calls->add(self->ranks->world, sums, sizeof sums / sizeof *sums);
    engine->bus =
        (fp3_bus_use){.transfers = sums[0],
                      .cycles = self->ranks->calls->most(self->ranks->world, use.bus.cycles),
                      .requests = sums[1],
                      .repeats = sums[2],
                      .bytes = sums[3]};
}

fp3_status fp3_ranks_use(fp3_engine *engine, fp3_rank_use **all, unsigned *count) {
    const fp3_ranked *self = engine->self;
    const fp3_rank_use use = use_of(self);
    uint64_t *bytes = calloc(self->ranks->count, sizeof *bytes);
    *count = self->ranks->count;
    *all = calloc(*count, sizeof **all);
    if (!bytes || !*all) {
        free(bytes);
        free(*all);
        *all = NULL;
        return fp3_no_memory(engine->def.error);
    }
    for (unsigned r = 0; r < *count; r++)
        bytes[r] = sizeof use;
    self->ranks->calls->gather(self->ranks->world, &use, bytes, *all);
    free(bytes);
    return FP3_OK;
}
