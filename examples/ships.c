/* ships.c - ships that begin with 0, 1, 2 ... m/s make some steps. */
#include "fp3_bare.h"
#include "ship.h"

#define POLLS 1000000

/* What all ships share, and what each of them starts with. */
static fp3_status set(fp3_bare *fp3, uint32_t ships) {
    const float start[][2] = {{ship_param_T, 2.9e5f},
                              {ship_param_C, 4.1e4f},
                              {ship_param_rm, 1 / 8.7e5f},
                              {ship_state_s, 0}};
    fp3_status status = fp3_bare_load(fp3, FP3_ALL, &ship_program);
    if (!status)
        status = fp3_bare_write_shared(fp3, FP3_ALL, ship_shared_h, fp3_bare_bits(0.0078125f));
    for (uint32_t i = 0; !status && i < ships; i++) {
        status = fp3_bare_write(fp3, FP3_ALL, i, ship_state_v, fp3_bare_bits((float)i));
        for (int k = 0; !status && k < 4; k++)
            status =
                fp3_bare_write(fp3, FP3_ALL, i, (uint32_t)start[k][0], fp3_bare_bits(start[k][1]));
        if (!status && fp3->features >> FP3_FEATURES_STATUS_LO & 1)
            status = fp3_bare_write_status(fp3, FP3_ALL, i, 0);
    }
    return status ? status : fp3_bare_list(fp3, FP3_ALL, ships);
}

/* A system with interrupts sleeps instead of polling. Its handler calls fp3_bare_handle, which
 * gives the outcome: the run has ended when that is not FP3_BARE_RUNNING. */
static fp3_status run(fp3_bare *fp3, uint32_t steps) {
    fp3_bare_outcome outcome = FP3_BARE_NONE;
    fp3_status status = fp3_bare_interrupt(fp3, FP3_ALL, FP3_BARE_ON_END);
    if (!status)
        status = fp3_bare_start(fp3, FP3_ALL, steps, 0, 0);
    if (!status)
        status = fp3_bare_wait(fp3, FP3_ALL, POLLS, &outcome);
    if (status == FP3_E_LIMIT && !fp3_bare_stop(fp3, FP3_ALL))
        fp3_bare_wait(fp3, FP3_ALL, POLLS, &outcome);
    if (!status && outcome != FP3_BARE_DONE)
        status = FP3_E_PROGRAM;
    return status;
}

/* v and s have room for all ships. FP3_E_FAILED: the flag invalid or overflow is set. */
fp3_status fly(fp3_bare *fp3, const fp3_bare_bus *bus, uint32_t ships, uint32_t steps, uint32_t *v,
               uint32_t *s) {
    const uint32_t bad = 1u << FP3_FLAGS_INVALID_LO | 1u << FP3_FLAGS_OVERFLOW_LO;
    uint32_t flags = 0;
    fp3_status status = fp3_bare_open(fp3, bus);
    if (!status)
        status = set(fp3, ships);
    if (!status)
        status = run(fp3, steps);
    for (uint32_t i = 0; !status && i < ships; i++) {
        status = fp3_bare_read(fp3, FP3_ALL, i, ship_state_v, &v[i]);
        if (!status)
            status = fp3_bare_read(fp3, FP3_ALL, i, ship_state_s, &s[i]);
    }
    if (!status)
        status = fp3_bare_register(fp3, FP3_ALL, FP3_ADDR_FLAGS, &flags);
    return status ? status : flags & bad ? FP3_E_FAILED : FP3_OK;
}
