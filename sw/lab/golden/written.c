/* SPDX-License-Identifier: Apache-2.0 */
/* written.c - see written.h. */
#include "written.h"

#include <stdlib.h>
#include <string.h>

#define REGISTERS 64

struct fp3_written {
    uint64_t room, objects;
    unsigned states;
    int state_of[REGISTERS]; /* by register; -1: it is none's */
    uint32_t *words;         /* by state, object */
    uint64_t *writes;        /* by state, object */
};

const fp3_symbol *fp3_bench_state(const fp3_image *image, unsigned number) {
    const int slept = fp3_image_slept(image);
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        const fp3_symbol *s = &image->symbols[i];
        if (s->symbol_class == FP3_SYMBOL_STATE && (int)s->index != slept && number-- == 0)
            return s;
    }
    return NULL;
}

fp3_status fp3_written_make(const fp3_image *image, uint64_t room, fp3_written **written,
                            fp3_error *error) {
    const fp3_symbol *s;
    fp3_written *w = *written = calloc(1, sizeof *w);
    if (!w)
        return fp3_no_memory(error);
    w->room = room;
    for (int i = 0; i < REGISTERS; i++)
        w->state_of[i] = -1;
    for (; (s = fp3_bench_state(image, w->states)); w->states++)
        w->state_of[s->index] = (int)w->states;
    return FP3_OK;
}

fp3_status fp3_written_size(fp3_written *written, size_t objects, fp3_error *error) {
    const size_t cells = written->states * objects;
    written->objects = objects;
    written->words = malloc((cells * written->room + 1) * sizeof *written->words);
    written->writes = calloc(cells + 1, sizeof *written->writes);
    return written->words && written->writes ? FP3_OK : fp3_no_memory(error);
}

void fp3_written_free(fp3_written **written) {
    if (*written) {
        free((*written)->words);
        free((*written)->writes);
    }
    free(*written);
    *written = NULL;
}

void fp3_written_retire(void *written, const fp3_retirement *retirement) {
    fp3_written *w = written;
    const int state = w->state_of[retirement->reg];
    if (state < 0)
        return;
    const uint64_t cell = (uint64_t)state * w->objects + retirement->object;
    const uint64_t n = w->writes[cell]++;
    if (n < w->room)
        w->words[cell * w->room + n] = retirement->bits;
}

void fp3_written_clear(fp3_written *written) {
    memset(written->writes, 0, written->states * written->objects * sizeof *written->writes);
}

const uint32_t *fp3_written_of(const fp3_written *written, unsigned state, uint64_t object,
                               uint64_t *writes) {
    const uint64_t cell = state * written->objects + object;
    *writes = written->writes[cell];
    return &written->words[cell * written->room];
}

uint64_t fp3_written_room(const fp3_written *written) { return written->room; }
