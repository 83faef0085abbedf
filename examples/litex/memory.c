/* memory.c - a processor lets FP3 move objects that are in memory, more than its store holds: all
 * steps are one list of transfers, made by FP3 alone.
 *
 * memory_data.py makes memory_data.h and what memory has to be at the start.
 */
#include "fp3_bare_moves.h"
#include "machine.h"
#include "memory_data.h"

#ifndef TICK
#define TICK 100000u /* cycles from one look at the list to the next, while no interrupt comes */
#endif
#define TICKS 1000u
#define POLLS 1000000u

static fp3_bare fp3;
static fp3_bare_moved how;
static volatile int is_ended;
static volatile fp3_status handled; /* how the handler of the interrupt fared */

/* The list raises it at its end. */
void program_interrupt(void) {
    handled = fp3_bare_interrupt(&fp3, FP3_ALL, 0);
    is_ended = 1;
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

static void print_hash(const char *when, uint64_t hash) {
    machine_print(SCENE_NAME);
    machine_print(when);
    print_hex((uint32_t)(hash >> 32));
    print_hex((uint32_t)hash);
    machine_print("\n");
}

static void print_cycles(const char *what, uint32_t cycles) {
    char text[11], *digit = text + 10;
    *digit = 0;
    do
        *--digit = (char)('0' + cycles % 10);
    while (cycles /= 10);
    machine_print(what);
    machine_print(digit);
    machine_print(" cycles\n");
}

static const char *const sides[] = {[FP3_BARE_MOVING] = "the bus of the processor",
                                    [FP3_BARE_MOVED] = "the bus of the processor",
                                    [FP3_BARE_MEMORY_ERROR] = "memory",
                                    [FP3_BARE_REFUSED] = "FP3"};

static int report(const char *what, fp3_status status) {
    machine_print("error: ");
    machine_print(what);
    machine_print(": status ");
    print_hex(status);
    if (status == FP3_E_SYSTEM) {
        machine_print(", ");
        machine_print(sides[how]);
        machine_print(" answered with an error, at ");
        print_hex(fp3.failed_at);
    }
    machine_print("\n");
    return 1;
}

/* ---- memory ---- */

/* FNV-1a of all words that steps store, register by register, as build/bench/alone has it. */
static uint64_t hash_states(int is_after) {
    uint64_t hash = 14695981039346656037u;
    machine_forget();
    for (uint32_t r = 0; r < sizeof scene_runs / sizeof scene_runs[0]; r++) {
        const uint32_t count = scene_runs[r].count;
        const volatile uint32_t *words =
            machine_memory(is_after ? scene_runs[r].after : scene_runs[r].before);
        for (uint32_t k = 0; k < count; k++)
            for (uint32_t i = 0; i < SCENE_OBJECTS; i++)
                hash = (hash ^ words[scene_places[i] * count + k]) * 1099511628211u;
    }
    return hash;
}

/* ---- a list ---- */

/* Until the interrupt comes, or the list has ended without it. */
static fp3_status run_list(uint32_t list) {
    is_ended = 0;
    handled = FP3_OK;
    how = FP3_BARE_MOVING;
    fp3_status status = fp3_bare_move_list(&fp3, list);
    for (uint32_t i = 0; !status && how == FP3_BARE_MOVING && i < TICKS; i++) {
        machine_wait(has_ended, TICK);
        status = handled;
        if (!status)
            status = fp3_bare_move_poll(&fp3, &how);
    }
    return status || how != FP3_BARE_MOVING ? status : FP3_E_LIMIT;
}

static int run_scene(void) {
    uint32_t flags = 0;
    fp3_status status = fp3_bare_interrupt(&fp3, FP3_ALL, 0);
    print_hash(" begins ", hash_states(0));
    const uint64_t begin = machine_cycles();
    if (!status)
        status = run_list(SCENE_LIST);
    const uint64_t end = machine_cycles();
    if (status)
        return report("list", status);
    if (!is_ended) {
        machine_print("error: the list has ended, but no interrupt came\n");
        return 1;
    }
    status = fp3_bare_register(&fp3, FP3_ALL, FP3_ADDR_FLAGS, &flags);
    if (!status && flags & (1u << FP3_FLAGS_INVALID_LO | 1u << FP3_FLAGS_OVERFLOW_LO))
        status = FP3_E_FAILED;
    if (status)
        return report("flags", status);
    print_hash(" ends ", hash_states(1));
    print_cycles("list ", (uint32_t)(end - begin));
    return 0;
}

/* ---- what memory gives ---- */

static fp3_bare_move move_of(fp3_bare_direction direction, uint32_t memory, uint32_t words) {
    const uint32_t place = FP3_ADDRESS_IN(fp3.space_bit, FP3_SPACE_OBJECTS, 0);
    const fp3_bare_move move = {direction, memory, 0, place, words, 0};
    return move;
}

static int measure(const char *what, fp3_bare_direction direction, uint32_t memory) {
    const fp3_bare_move move = move_of(direction, memory, SCENE_MEASURED);
    const uint64_t begin = machine_cycles();
    fp3_status status = fp3_bare_move_start(&fp3, &move);
    if (!status)
        status = fp3_bare_move_wait(&fp3, POLLS, &how);
    if (status)
        return report(what, status);
    print_cycles(what, (uint32_t)(machine_cycles() - begin));
    return 0;
}

/* ---- what memory refuses ---- */

static int print_refused(const char *what, fp3_status status) {
    if (status != FP3_E_SYSTEM || how != FP3_BARE_MEMORY_ERROR) {
        machine_print("error: memory took an address that it has not\n");
        return 1;
    }
    machine_print(what);
    print_hex(fp3.failed_at);
    machine_print("\n");
    return 0;
}

/* A list whose second transfer begins behind the end of memory, and a store that goes beyond it. */
static int go_outside(void) {
    const fp3_bare_move inside = move_of(FP3_BARE_TO_PROCESSOR, SCENE_AT, 300);
    const uint32_t list[] = {
        SCENE_AT,  inside.address,
        300,       1u << FP3_TRANSFER_CONTROL_LOAD_LO,
        SCENE_END, inside.address,
        300,       1u << FP3_TRANSFER_CONTROL_LOAD_LO | 1u << FP3_TRANSFER_CONTROL_LAST_LO};
    volatile uint32_t *words = machine_memory(SCENE_FREE);
    for (uint32_t i = 0; i < sizeof list / sizeof list[0]; i++)
        words[i] = list[i];
    if (print_refused("list outside ", run_list(SCENE_FREE)))
        return 1;
    const fp3_bare_move beyond = move_of(FP3_BARE_TO_MEMORY, SCENE_END - 64, 300);
    const fp3_status status = fp3_bare_move_start(&fp3, &beyond);
    return status ? report("store", status)
                  : print_refused("store outside ", fp3_bare_move_wait(&fp3, POLLS, &how));
}

int program(void) {
    const fp3_status status = fp3_bare_open(&fp3, &machine_bus);
    if (status)
        return report("open", status);
    if (run_scene() || go_outside() || measure("load ", FP3_BARE_TO_PROCESSOR, SCENE_AT) ||
        measure("store ", FP3_BARE_TO_MEMORY, SCENE_FREE))
        return 1;
    machine_print("done\n");
    return 0;
}
