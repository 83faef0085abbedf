/* ships.c - a processor lets FP3 fly ships, waits for the interrupt, and prints where they are.
 *
 * The program is programs/ship.s; ship.h is made of it by `fp3 dis --header`.
 */
#include "fp3_bare.h"
#include "machine.h"
#include "ship.h"

#ifndef SHIPS
#define SHIPS 1
#endif
#ifndef STEPS
#define STEPS 1000
#endif
#ifndef PATIENCE
#define PATIENCE 1000000u /* cycles */
#endif

/* The ships begin with these speeds [m/s]. A processor without an FPU takes constants: nothing is
 * computed here. */
static const float speeds[] = {0, 1, 2, 3, 4, 5, 6, 7};
_Static_assert(SHIPS <= sizeof speeds / sizeof speeds[0], "more ships than speeds");

static fp3_bare fp3;
static volatile int is_ended;
static volatile fp3_status handled; /* how the handler of the interrupt fared */

void program_interrupt(void) {
    fp3_bare_outcome outcome = FP3_BARE_NONE;
    handled = fp3_bare_handle(&fp3, FP3_ALL, &outcome);
    is_ended = handled || outcome != FP3_BARE_RUNNING;
}

static int has_ended(void) { return is_ended; }

/* ---- text ---- */

static void print_hex(uint32_t word) {
    char text[9];
    for (int i = 0; i < 8; i++)
        text[i] = "0123456789abcdef"[word >> (28 - 4 * i) & 15];
    text[8] = 0;
    machine_print(text);
}

static const char *const meanings[] = {
    [FP3_OK] = "well",
    [FP3_E_ARGUMENT] = "there is no such thing, or a program runs",
    [FP3_E_PROGRAM] = "the program does not fit, or did not end",
    [FP3_E_LIMIT] = "no end within the time given",
    [FP3_E_SYSTEM] = "the bus answered with an error",
    [FP3_E_MISMATCH] = "there is no FP3 at this address, or it has another instruction set",
    [FP3_E_FAILED] = "a result is no number"};

static int report(const char *what, fp3_status status) {
    machine_print("error: ");
    machine_print(what);
    machine_print(": ");
    machine_print(meanings[status]);
    if (status == FP3_E_SYSTEM) {
        machine_print(", at ");
        print_hex(fp3.failed_at);
    }
    machine_print("\n");
    return 1;
}

/* ---- a flight ---- */

static fp3_status set(uint32_t ship) {
    const struct {
        uint32_t reg;
        float value;
    } start[] = {{ship_state_v, speeds[ship]},
                 {ship_state_s, 0},
                 {ship_param_T, 2.9e5f},
                 {ship_param_C, 4.1e4f},
                 {ship_param_rm, 1 / 8.7e5f}};
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < sizeof start / sizeof start[0]; i++)
        status = fp3_bare_write(&fp3, FP3_ALL, ship, start[i].reg, fp3_bare_bits(start[i].value));
    if (!status && fp3.features >> FP3_FEATURES_STATUS_LO & 1)
        status = fp3_bare_write_status(&fp3, FP3_ALL, ship, 0);
    return status;
}

static fp3_status load(void) {
    fp3_status status = fp3_bare_load(&fp3, FP3_ALL, &ship_program);
    if (!status)
        status = fp3_bare_write_shared(&fp3, FP3_ALL, ship_shared_h, fp3_bare_bits(0.0078125f));
    for (uint32_t i = 0; !status && i < SHIPS; i++)
        status = set(i);
    return status ? status : fp3_bare_list(&fp3, FP3_ALL, SHIPS);
}

static fp3_status start(void) {
    is_ended = 0;
    handled = FP3_OK;
    const fp3_status status = fp3_bare_interrupt(&fp3, FP3_ALL, FP3_BARE_ON_END);
    return status ? status : fp3_bare_start(&fp3, FP3_ALL, STEPS, 0, 0);
}

/* After the interrupt there is an outcome; without one, the outcome tells what is wrong. */
static int finish(void) {
    const int has_come = machine_wait(has_ended, PATIENCE);
    if (handled)
        return report("interrupt", handled);
    fp3_bare_outcome outcome = FP3_BARE_NONE;
    const fp3_status status = fp3_bare_poll(&fp3, FP3_ALL, &outcome);
    if (status && status != FP3_E_LIMIT)
        return report("status", status);
    if (outcome == FP3_BARE_RUNNING)
        return report("run", FP3_E_LIMIT);
    if (outcome != FP3_BARE_DONE)
        return report("run", FP3_E_PROGRAM);
    if (!has_come) {
        machine_print("error: the run has ended, but no interrupt came\n");
        return 1;
    }
    return 0;
}

static int print_ship(uint32_t ship) {
    uint32_t v = 0, s = 0;
    fp3_status status = fp3_bare_read(&fp3, FP3_ALL, ship, ship_state_v, &v);
    if (!status)
        status = fp3_bare_read(&fp3, FP3_ALL, ship, ship_state_s, &s);
    if (status)
        return report("read", status);
    machine_print("v ");
    print_hex(v);
    machine_print(" s ");
    print_hex(s);
    machine_print("\n");
    return 0;
}

static int print_all(void) {
    const uint32_t bad = 1u << FP3_FLAGS_INVALID_LO | 1u << FP3_FLAGS_OVERFLOW_LO;
    uint32_t flags = 0;
    for (uint32_t i = 0; i < SHIPS; i++)
        if (print_ship(i))
            return 1;
    const fp3_status status = fp3_bare_register(&fp3, FP3_ALL, FP3_ADDR_FLAGS, &flags);
    return status ? report("flags", status) : flags & bad ? report("flags", FP3_E_FAILED) : 0;
}

int program(void) {
    fp3_status status = fp3_bare_open(&fp3, &machine_bus);
    if (status)
        return report("open", status);
    status = load();
    if (status)
        return report("load", status);
    status = start();
    if (status)
        return report("start", status);
    if (finish() || print_all())
        return 1;
    machine_print("done\n");
    return 0;
}
