/* record.c - see record.h. */
#include "record.h"

#include <stdlib.h>
#include <string.h>

#define REGISTERS 64

struct fp3_record {
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

fp3_status fp3_record_make(const fp3_image *image, uint64_t room, fp3_record **record,
                           fp3_error *error) {
    const fp3_symbol *s;
    fp3_record *r = *record = calloc(1, sizeof *r);
    if (!r)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    r->room = room;
    for (int i = 0; i < REGISTERS; i++)
        r->state_of[i] = -1;
    for (; (s = fp3_bench_state(image, r->states)); r->states++)
        r->state_of[s->index] = (int)r->states;
    return FP3_OK;
}

fp3_status fp3_record_size(fp3_record *record, size_t objects, fp3_error *error) {
    const size_t cells = record->states * objects;
    record->objects = objects;
    record->words = malloc((cells * record->room + 1) * sizeof *record->words);
    record->writes = calloc(cells + 1, sizeof *record->writes);
    return record->words && record->writes ? FP3_OK
                                           : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
}

void fp3_record_free(fp3_record **record) {
    if (*record) {
        free((*record)->words);
        free((*record)->writes);
    }
    free(*record);
    *record = NULL;
}

void fp3_record_retire(void *record, const fp3_retirement *retirement) {
    fp3_record *r = record;
    const int state = r->state_of[retirement->reg];
    if (state < 0)
        return;
    const uint64_t cell = (uint64_t)state * r->objects + retirement->object;
    const uint64_t n = r->writes[cell]++;
    if (n < r->room)
        r->words[cell * r->room + n] = retirement->bits;
}

void fp3_record_clear(fp3_record *record) {
    memset(record->writes, 0, record->states * record->objects * sizeof *record->writes);
}

const uint32_t *fp3_record_of(const fp3_record *record, unsigned state, uint64_t object,
                              uint64_t *writes) {
    const uint64_t cell = state * record->objects + object;
    *writes = record->writes[cell];
    return &record->words[cell * record->room];
}

uint64_t fp3_record_room(const fp3_record *record) { return record->room; }
