/* scenes.c - a processor lets FP3 move objects that see each other: a cloth of masses that are
 * linked, stars of which each attracts all others, balls that push those that are near.
 *
 * scenes_data.py makes the programs and scenes_data.h; it has what the scenes begin with.
 */
#include "fp3_bare_neighbours.h"
#include "machine.h"
#include "scenes_data.h"

#define POLLS 1000000u
#define MOST 300 /* objects */

typedef struct {
    const char *name;
    const fp3_bare_program *program;
    const fp3_bare_constant *shared; /* constants that the program leaves to the host */
    const uint32_t *start;           /* of each object a whole record */
    const uint32_t *states;          /* registers of an object that are its result */
    uint32_t shared_count, objects, state_count, steps;
    fp3_status (*give)(void); /* the list of the program */
} scene;

static fp3_bare fp3;
static fp3_bare_neighbours around;
static fp3_bare_near touch;

static uint32_t next[MOST], order[MOST], first[MOST + 2];
static int32_t made[MOST][3];

/* ---- three lists ---- */

static fp3_status give_cloth(void) {
    return fp3_bare_links(&around, cloth_list_springs, cloth_links,
                          sizeof cloth_links / sizeof cloth_links[0], cloth_fields);
}

static fp3_status give_stars(void) { return fp3_bare_all(&around, stars_list_others); }

/* Not a value of the variable: it would be in a .data that nothing copies. */
static fp3_status give_balls(void) {
    touch.list = balls_list_touch;
    touch.position[0] = balls_state_x_x;
    touch.position[1] = balls_state_x_y;
    touch.position[2] = balls_state_x_z;
    touch.dimensions = 3;
    touch.reach = BALLS_REACH;
    touch.skin = BALLS_SKIN;
    touch.made = made;
    touch.order = order;
    touch.first = first;
    touch.cells = MOST;
    return fp3_bare_near_add(&around, &touch);
}

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define SCENE(name, NAME)                                                                          \
    {                                                                                              \
#name, &name##_program, name##_shared, name##_start, name##_states, COUNT(name##_shared),  \
            NAME##_OBJECTS, COUNT(name##_states), NAME##_STEPS, give_##name                        \
    }

static const scene scenes[] = {SCENE(cloth, CLOTH), SCENE(stars, STARS), SCENE(balls, BALLS)};

/* ---- a scene ---- */

static fp3_status write_objects(const scene *s) {
    const uint32_t record = s->program->record;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < s->objects; i++) {
        for (uint32_t r = 0; !status && r < 1u << record; r++)
            status = fp3_bare_write(&fp3, 0, i, r, s->start[(i << record) + r]);
        if (!status && fp3.features >> FP3_FEATURES_STATUS_LO & 1)
            status = fp3_bare_write_status(&fp3, 0, i, 0);
    }
    return status;
}

static fp3_status set(const scene *s) {
    fp3_status status = fp3_bare_load(&fp3, 0, s->program);
    for (uint32_t i = 0; !status && i < s->shared_count; i++)
        status = fp3_bare_write_shared(&fp3, 0, s->shared[i].index, s->shared[i].bits);
    if (!status)
        status = fp3_bare_neighbours_open(&around, &fp3, s->objects, next);
    if (!status)
        status = write_objects(s);
    return status ? status : s->give();
}

static fp3_status run(uint32_t steps) {
    fp3_bare_outcome outcome = FP3_BARE_NONE;
    uint32_t flags = 0;
    fp3_status status = FP3_OK;
    if (around.near) {
        status = fp3_bare_near_run(&around, steps, 0, POLLS, &outcome);
    } else {
        status = fp3_bare_start(&fp3, 0, steps, 1, 0);
        if (!status)
            status = fp3_bare_wait(&fp3, 0, POLLS, &outcome);
    }
    if (!status && outcome != FP3_BARE_DONE)
        status = FP3_E_PROGRAM;
    if (!status)
        status = fp3_bare_register(&fp3, 0, FP3_ADDR_FLAGS, &flags);
    return status                                                               ? status
           : flags & (1u << FP3_FLAGS_INVALID_LO | 1u << FP3_FLAGS_OVERFLOW_LO) ? FP3_E_FAILED
                                                                                : FP3_OK;
}

/* FNV-1a, of words, over all states of all objects. */
static fp3_status hash_states(const scene *s, uint32_t *hash) {
    fp3_status status = FP3_OK;
    *hash = 2166136261u;
    for (uint32_t i = 0; !status && i < s->objects; i++)
        for (uint32_t k = 0; !status && k < s->state_count; k++) {
            uint32_t bits = 0;
            status = fp3_bare_read(&fp3, 0, i, s->states[k], &bits);
            *hash = (*hash ^ bits) * 16777619u;
        }
    return status;
}

/* ---- text ---- */

static void print_hex(uint32_t word) {
    char text[9];
    for (int i = 0; i < 8; i++)
        text[i] = "0123456789abcdef"[word >> (28 - 4 * i) & 15];
    text[8] = 0;
    machine_print(text);
}

static int report(const scene *s, const char *what, fp3_status status) {
    machine_print("error: ");
    machine_print(s->name);
    machine_print(what);
    print_hex(status);
    machine_print(", object ");
    print_hex(around.failed);
    machine_print(", at ");
    print_hex(fp3.failed_at);
    machine_print("\n");
    return 1;
}

/* It waits by asking, so nothing raises an interrupt. */
void program_interrupt(void) {}

int program(void) {
    uint32_t hash = 0;
    fp3_status status = fp3_bare_open(&fp3, &machine_bus);
    if (status)
        return report(&scenes[0], ": open: status ", status);
    for (uint32_t i = 0; i < COUNT(scenes); i++) {
        const scene *s = &scenes[i];
        status = set(s);
        if (status)
            return report(s, ": load: status ", status);
        status = run(s->steps);
        if (!status)
            status = hash_states(s, &hash);
        if (status)
            return report(s, ": run: status ", status);
        machine_print(s->name);
        machine_print(" ");
        print_hex(hash);
        machine_print("\n");
    }
    machine_print("done\n");
    return 0;
}
