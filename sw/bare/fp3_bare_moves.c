/* SPDX-License-Identifier: Apache-2.0 */
/* fp3_bare_moves.c - see fp3_bare_moves.h. */
#include "fp3_bare_moves.h"

#define BIT(field) (1u << FP3_##field##_LO)
#define HAS(word, field) (((word)&BIT(field)) != 0)
#define MOST_WORDS 0xffffffu

/* The registers are the same ones for all schedulers: asked for at the first. */
static fp3_status get(fp3_bare *fp3, uint32_t address, uint32_t *word) {
    const int is_refused = fp3->bus.read(fp3->bus.user, address, word);
    if (is_refused)
        fp3->failed_at = address;
    return is_refused ? FP3_E_SYSTEM : FP3_OK;
}

static fp3_status put(fp3_bare *fp3, uint32_t address, uint32_t word) {
    const int is_refused = fp3->bus.write(fp3->bus.user, address, word);
    if (is_refused)
        fp3->failed_at = address;
    return is_refused ? FP3_E_SYSTEM : FP3_OK;
}

static int is_idle(const fp3_bare *fp3, uint32_t scheduler) {
    for (uint32_t i = 0; i < fp3->schedulers; i++)
        if (fp3->running[i] && (scheduler == FP3_ALL || scheduler == i))
            return 0;
    return scheduler == FP3_ALL || scheduler < fp3->schedulers;
}

/* As fp3_bare.c: all ones, in as many bits as there are, are all schedulers. */
static uint32_t place_of(const fp3_bare *fp3, uint32_t scheduler, uint32_t address) {
    uint32_t all = fp3->schedulers > 1;
    while (all && all < fp3->schedulers)
        all = 2 * all + 1;
    return FP3_ADDRESS_OF(fp3->space_bit,
                          scheduler == FP3_ALL   ? all
                          : fp3->schedulers == 1 ? 0
                                                 : scheduler,
                          address);
}

fp3_status fp3_bare_move_start(fp3_bare *fp3, const fp3_bare_move *move) {
    if (!HAS(fp3->features_more, FEATURES_MORE_MASTER) || !is_idle(fp3, move->scheduler) ||
        move->memory % 4 || move->address % 4 || move->words > MOST_WORDS ||
        move->address >> (fp3->space_bit + FP3_ADDRESS_SPACE_BITS))
        return FP3_E_ARGUMENT;
    const uint32_t way = move->direction == FP3_BARE_TO_MEMORY ? BIT(TRANSFER_CONTROL_STORE)
                                                               : BIT(TRANSFER_CONTROL_LOAD);
    fp3_status status = put(fp3, FP3_ADDR_TRANSFER_MEMORY, move->memory);
    if (!status)
        status = put(fp3, FP3_ADDR_TRANSFER_PLACE, place_of(fp3, move->scheduler, move->address));
    if (!status)
        status = put(fp3, FP3_ADDR_TRANSFER_WORDS, move->words);
    return status ? status
                  : put(fp3, FP3_ADDR_TRANSFER_CONTROL,
                        way | (move->stays ? BIT(TRANSFER_CONTROL_STAY) : 0));
}

fp3_status fp3_bare_move_rows(fp3_bare *fp3, fp3_bare_direction direction, uint32_t scheduler,
                              uint32_t lane, uint32_t row, uint32_t rows, uint32_t memory) {
    if (scheduler >= fp3->schedulers || lane >= fp3->lanes || !fp3->record[scheduler] || fp3->half)
        return FP3_E_ARGUMENT;
    const uint32_t record = fp3->record[scheduler], most = fp3->store >> record;
    if (row > most || rows > most - row)
        return FP3_E_ARGUMENT;
    const fp3_bare_move move = {
        direction,
        memory,
        scheduler,
        FP3_ADDRESS_IN(fp3->space_bit, FP3_SPACE_OBJECTS, lane * fp3->store + (row << record)),
        rows << record,
        0};
    return fp3_bare_move_start(fp3, &move);
}

fp3_status fp3_bare_move_list(fp3_bare *fp3, uint32_t memory) {
    if (!HAS(fp3->features_more, FEATURES_MORE_MASTER) || !is_idle(fp3, FP3_ALL) || memory % 4)
        return FP3_E_ARGUMENT;
    const fp3_status status = put(fp3, FP3_ADDR_TRANSFER_MEMORY, memory);
    return status ? status : put(fp3, FP3_ADDR_TRANSFER_CONTROL, BIT(TRANSFER_CONTROL_LIST));
}

fp3_status fp3_bare_move_poll(fp3_bare *fp3, fp3_bare_moved *how) {
    uint32_t word = 0;
    if (!HAS(fp3->features_more, FEATURES_MORE_MASTER))
        return FP3_E_ARGUMENT;
    fp3_status status = get(fp3, FP3_ADDR_TRANSFER_STATUS, &word);
    if (status)
        return status;
    *how = HAS(word, TRANSFER_STATUS_RUNNING)        ? FP3_BARE_MOVING
           : HAS(word, TRANSFER_STATUS_MEMORY_ERROR) ? FP3_BARE_MEMORY_ERROR
           : HAS(word, TRANSFER_STATUS_REFUSED)      ? FP3_BARE_REFUSED
                                                     : FP3_BARE_MOVED;
    if (*how != FP3_BARE_MEMORY_ERROR && *how != FP3_BARE_REFUSED)
        return FP3_OK;
    status = get(fp3, FP3_ADDR_TRANSFER_ERROR, &word);
    if (!status)
        fp3->failed_at = word;
    return FP3_E_SYSTEM;
}

fp3_status fp3_bare_move_wait(fp3_bare *fp3, uint32_t polls, fp3_bare_moved *how) {
    *how = FP3_BARE_MOVING;
    for (; polls > 0; polls--) {
        const fp3_status status = fp3_bare_move_poll(fp3, how);
        if (status || *how != FP3_BARE_MOVING)
            return status;
    }
    return FP3_E_LIMIT;
}
