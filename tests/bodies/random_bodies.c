/* SPDX-License-Identifier: Apache-2.0 */
/* random_bodies.c - worlds of bodies by chance: shapes, joints, materials, ground, what is added,
 * removed and written while they run, and what must be refused. Each world is checked, step by
 * step:
 *
 * - nothing fails but a step that names a body whose speed is not finite, which is printed: it
 * happens where a body a million times lighter than its neighbours hangs at a long arm; all values
 * are finite;
 * - energy is never above what was put in by more than 2 % and m g 1.5 m of each body: kinetic and
 *   potential energy, where bodies begin apart, as in each fourth world. Where there are joints it
 *   is printed instead, behind the hash: 1, it was above (docs/bodies.md says in how many);
 * - what was saved in the middle goes on, after a restore, with the same bits; with FILE so does
 *   what is opened from a checkpoint there.
 *
 *     random_bodies FIRST COUNT [ENGINE [FILE]]
 *
 * With an engine (other than "-"), the laws are executed by it: the hash of each world, which is
 * printed, must be the same. Exit code 1: a check failed, and the message names the world.
 */
#include <fp3/bodies.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BODIES 24
#define STEPS 60
#define GRAVITY 10.0

static uint64_t seed;
static double chance(void) {
    seed += 0x9e3779b97f4a7c15u;
    uint64_t z = seed;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}
static double between(double low, double high) { return low + (high - low) * chance(); }
/* From low to high, each magnitude as likely. */
static double spread(double low, double high) { return low * pow(high / low, chance()); }
static int one_of(int count) { return (int)(chance() * count); }

typedef struct {
    fp3_bodies *bodies;
    fp3_error error;
    uint64_t handle[BODIES], joint[BODIES];
    int count, joints;
    uint64_t number; /* of the world */
    double put_in;   /* energy */
    int is_apart;    /* bodies begin apart from each other: none is pushed out of another */
    int is_far;      /* one was thrown farther than 1e6 */
    int has_gained;  /* joined bodies have more than was put in */
} world;

static void fail(const world *w, const char *what, double value) {
    fprintf(stderr, "world %" PRIu64 ": %s (%g) %s\n", w->number, what, value, w->error.text);
    exit(1);
}
static void must(const world *w, fp3_status status, const char *what) {
    if (status)
        fail(w, what, status);
}
static void must_not(const world *w, fp3_status status, const char *what) {
    if (status != FP3_E_ARGUMENT)
        fail(w, what, status);
}

static fp3_shape_def some_shape(void) {
    const double size = spread(0.05, 2);
    fp3_shape_def shape = fp3_shape_circle(size);
    switch (one_of(4)) {
    case 0:
        break;
    case 1:
        shape = fp3_shape_box(size, spread(0.05, 2), one_of(2) * 0.1 * size);
        break;
    case 2:
        shape = fp3_shape_capsule(-size, -0.3 * size, size, 0.3 * size, spread(0.02, 0.5));
        break;
    default:
        shape.type = FP3_POLYGON;
        shape.corners = 3 + (uint32_t)one_of(FP3_CORNERS - 2);
        for (uint32_t i = 0; i < shape.corners; i++) {
            const double angle = 6.2831853 * (i + 0.3 * chance()) / shape.corners;
            shape.corner[i][0] = size * cos(angle);
            shape.corner[i][1] = size * sin(angle);
        }
        shape.radius = one_of(2) * 0.05 * size;
    }
    shape.density = spread(1e-2, 1e2);
    shape.friction = one_of(4) ? between(0, 1) : 0;
    shape.restitution = one_of(3) ? 0 : between(0, 1);
    shape.rolling = one_of(4) ? 0 : 0.05 * size;
    shape.is_sensor = one_of(10) == 0;
    return shape;
}

static double value(world *w, const char *name, uint64_t handle) {
    double x = NAN;
    must(w, fp3_bodies_read(w->bodies, name, &handle, 1, &x), name);
    if (!isfinite(x))
        fail(w, name, x);
    return x;
}

/* Of the origin, not of the centre of mass: shapes here have their centres near it; what that is
 * off, `slack` allows. */
static double energy(world *w, double *slack) {
    double sum = 0;
    *slack = 1e-3;
    for (int i = 0; i < w->count; i++) {
        const uint64_t h = w->handle[i];
        const double m = value(w, "mass", h), vx = value(w, "v_x", h), vy = value(w, "v_y", h);
        const double turn = value(w, "inertia", h), spin = value(w, "w", h);
        sum +=
            m * (vx * vx + vy * vy) / 2 + turn * spin * spin / 2 + m * GRAVITY * value(w, "x_y", h);
        w->is_far |= fabs(value(w, "x_x", h)) + fabs(value(w, "x_y", h)) > 1e6;
        *slack += m * GRAVITY * 1.5; /* the centre's distance, and overlaps that are pushed apart */
    }
    return sum;
}

static void add(world *w) {
    fp3_body_def body = fp3_body_default();
    fp3_shape_def shape = some_shape();
    body.x[0] = between(-6, 6);
    body.x[1] = between(1, 12);
    if (w->is_apart) { /* no shape reaches farther than 3.2 */
        body.x[0] = 6.5 * (w->count % 2) - 3.25;
        body.x[1] = 5 + 6.5 * (w->count / 2);
    }
    body.angle = between(-4, 4);
    body.v[0] = between(-5, 5);
    body.v[1] = between(-5, 5);
    body.w = between(-5, 5);
    body.may_not_turn = one_of(12) == 0;
    body.is_fast = one_of(8) == 0;
    must(w, fp3_bodies_add(w->bodies, &body, 1, &w->handle[w->count]), "add");
    must(w, fp3_bodies_attach(w->bodies, &w->handle[w->count], 1, &shape, NULL), "attach");
    if (one_of(6) == 0) {
        fp3_shape_def more = some_shape();
        more.centre[0] = 0.3;
        must(w, fp3_bodies_attach(w->bodies, &w->handle[w->count], 1, &more, NULL), "attach");
    }
    w->count++;
}

static void join(world *w) {
    if (w->count < 2)
        return;
    const int a = one_of(w->count), b = one_of(w->count);
    fp3_joint_def joint = fp3_joint_default((fp3_joint_type)one_of(6), w->handle[a], w->handle[b]);
    if (a == b) {
        must_not(w, fp3_bodies_join(w->bodies, &joint, 1, &w->joint[0]),
                 "a body was joined with itself");
        return;
    }
    /* Where they are: so nothing has to be pulled together. */
    const double dx = value(w, "x_x", w->handle[a]) - value(w, "x_x", w->handle[b]);
    const double dy = value(w, "x_y", w->handle[a]) - value(w, "x_y", w->handle[b]);
    const double angle = value(w, "angle", w->handle[b]);
    joint.anchor_b[0] = cos(angle) * dx + sin(angle) * dy;
    joint.anchor_b[1] = cos(angle) * dy - sin(angle) * dx;
    joint.axis[0] = between(-1, 1);
    joint.axis[1] = 1.5;
    if (joint.type == FP3_ROD)
        joint.anchor_b[0] += 1;
    if (one_of(4) == 0)
        joint.force = 1e3;
    if (w->is_far) /* anchors have an end */
        fp3_bodies_join(w->bodies, &joint, 1, &w->joint[0]);
    else
        must(w, fp3_bodies_join(w->bodies, &joint, 1, &w->joint[w->joints++]), "join");
}

static void refuse(world *w) {
    fp3_body_def body = fp3_body_default();
    fp3_shape_def shape = fp3_shape_circle(0.5);
    uint64_t none = 12345678901234u, handle;
    const double bad[] = {NAN, INFINITY, -INFINITY, 1e300};
    body.x[one_of(2)] = bad[one_of(4)];
    must_not(w, fp3_bodies_add(w->bodies, &body, 1, &handle), "a place that is not finite");
    must_not(w, fp3_bodies_attach(w->bodies, &none, 1, &shape, NULL), "a body that is not there");
    if (!w->count)
        return;
    shape.radius = one_of(2) ? bad[one_of(4)] : -1;
    must_not(w, fp3_bodies_attach(w->bodies, w->handle, 1, &shape, NULL), "a radius");
    must_not(w, fp3_bodies_write(w->bodies, "v_x", w->handle, 1, &bad[one_of(4)]), "a speed");
    fp3_hit hit;
    double point[2] = {0, 0}, way[2] = {1, 1};
    const double wrong = bad[one_of(4)];
    (one_of(2) ? point : way)[one_of(2)] = wrong;
    must_not(w, fp3_bodies_ray(w->bodies, point, way, 1, 1, &hit), "a ray");
    shape = fp3_shape_circle(0.5);
    must_not(w, fp3_bodies_cast(w->bodies, &shape, point, NULL, way, 1, &hit), "a cast");
    must_not(w, fp3_bodies_nearest(w->bodies, (double[]){wrong, 0}, 1, 1, &hit), "a point");
    must_not(w, fp3_bodies_write(w->bodies, "mass", w->handle, 1, &wrong), "a mass");
    if (w->count > 1) {
        fp3_joint_def joint = fp3_joint_default(FP3_HINGE, w->handle[0], w->handle[1]);
        double *const words[] = {&joint.anchor_a[0], &joint.axis[1], &joint.low,
                                 &joint.most,        &joint.hertz,   &joint.torque};
        *words[one_of(6)] = wrong;
        must_not(w, fp3_bodies_join(w->bodies, &joint, 1, &handle), "a joint");
    }
    must_not(w, fp3_bodies_remove(w->bodies, (uint64_t[]){w->handle[0], w->handle[0]}, 2),
             "removed twice");
}

static void ground(world *w) {
    fp3_body_def body = fp3_body_default();
    uint64_t handle;
    body.type = FP3_STATIC;
    must(w, fp3_bodies_add(w->bodies, &body, 1, &handle), "ground");
    const double corners[] = {-9, 14, -9, 0.5, -3, 0, 2, 0.3, 9, 0.1, 9, 14};
    fp3_shape_def surface = fp3_shape_circle(0);
    surface.friction = between(0, 1);
    surface.restitution = one_of(2) * chance();
    double turned[12];
    for (int i = 0; i < 6;
         i++) { /* the ground is to the left of the way: from right to left along a floor */
        turned[2 * i] = corners[2 * (5 - i)];
        turned[2 * i + 1] = corners[2 * (5 - i) + 1];
    }
    must(w, fp3_bodies_attach_chain(w->bodies, handle, turned, 6, 0, &surface), "chain");
}

static void check_contacts(world *w) {
    const fp3_contact *list;
    size_t count;
    must(w, fp3_bodies_contacts(w->bodies, &list, &count), "contacts");
    for (size_t i = 0; i < count; i++) {
        const double length = hypot(list[i].normal[0], list[i].normal[1]);
        if (!(fabs(length - 1) < 1e-5) || !(list[i].impulse >= 0))
            fail(w, "a contact has no normal, or pulls", length);
    }
}

/* 0: a body has failed, and the world ends. */
static int step(world *w, int check_energy) { /* 2: note, because of joints */
    double slack;
    const fp3_status status = fp3_bodies_step(w->bodies, 1);
    if (status == FP3_E_FAILED && check_energy != 1 && strncmp(w->error.text, "body ", 5) == 0) {
        energy(w, &slack);
        return 0;
    }
    must(w, status, "step");
    const double now = energy(w, &slack);
    const int is_above = check_energy && !(now < w->put_in + slack + 0.02 * fabs(w->put_in));
    w->has_gained |= is_above;
    if (is_above && check_energy == 1)
        fail(w, "energy was made", now - w->put_in);
    check_contacts(w);
    return 1;
}

static uint64_t end(world *w, fp3_bodies_state **state) {
    fp3_bodies_state_free(state);
    fp3_bodies_close(&w->bodies);
    return 0;
}

/* The rest of the steps, by what is opened from a checkpoint. */
static void go_on(const world *w, const char *file, int steps, uint64_t hash) {
    world v = *w;
    fp3_bodies_def def = fp3_bodies_default();
    def.error = &v.error;
    must(&v, fp3_bodies_restart(&def, file, &v.bodies), "restart");
    for (int i = 0; i < steps; i++)
        if (!step(&v, 0))
            fail(&v, "fails after a restart alone", i);
    if (fp3_bodies_hash(v.bodies) != hash)
        fail(&v, "other bits after a restart", 0);
    if (fp3_bodies_count(v.bodies) != (size_t)v.count + 1)
        fail(&v, "bodies are lost or left over after a restart",
             (double)fp3_bodies_count(v.bodies));
    add(&v);
    fp3_bodies_close(&v.bodies);
}

static uint64_t run(uint64_t number, const char *engine, const char *file, int *has_gained) {
    world w = {.number = number};
    double slack;
    seed = number * 0x632be59bd9b4e019u + 1;
    fp3_bodies_def def = fp3_bodies_default();
    def.error = &w.error;
    def.gravity[1] = -GRAVITY;
    def.engine = engine && strcmp(engine, "built-in") != 0 ? engine : NULL;
    def.substeps = 1 + (uint32_t)one_of(8);
    must(&w, fp3_bodies_open(&def, &w.bodies), "open");
    ground(&w);
    const int first = 1 + one_of(BODIES / 2);
    w.is_apart = first == 1 || number % 4 == 3;
    while (w.count < first)
        add(&w);
    /* Bodies that begin in one another are pushed apart, which gives energy: only worlds where
     * none does are checked. */
    for (int i = 0; first > 1 && i < one_of(4); i++)
        join(&w);
    const int check_energy = !w.is_apart ? 0 : w.joints ? 2 : 1;
    w.put_in = energy(&w, &slack);
    fp3_bodies_state *state = NULL;
    const int steps = engine ? STEPS / 4 : STEPS;
    for (int i = 0; i < steps; i++) {
        if (i == steps / 2)
            must(&w, fp3_bodies_save(w.bodies, &state), "save");
        if (file && i == steps / 2)
            must(&w, fp3_bodies_checkpoint(w.bodies, file), "checkpoint");
        if (!step(&w, check_energy))
            return end(&w, &state);
    }
    *has_gained = w.has_gained;
    const uint64_t hash = fp3_bodies_hash(w.bodies);
    if (file)
        go_on(&w, file, steps - steps / 2, hash);
    /* What comes between, and what goes, is undone. */
    const int count = w.count, joints = w.joints;
    add(&w);
    join(&w);
    step(&w, 0);
    const uint64_t first_handle = w.handle[0];
    must(&w, fp3_bodies_remove(w.bodies, &w.handle[0], 1), "remove");
    must(&w, fp3_bodies_restore(w.bodies, state), "restore");
    w.handle[0] = first_handle;
    w.count = count;
    w.joints = joints;
    for (int i = steps / 2; i < steps; i++)
        if (!step(&w, 0))
            fail(&w, "fails after a restore alone", i);
    if (fp3_bodies_hash(w.bodies) != hash)
        fail(&w, "other bits after a restore", 0);
    add(&w); /* behind a restore */
    if (fp3_bodies_count(w.bodies) != (size_t)w.count + 1)
        fail(&w, "bodies are lost or left over after a restore",
             (double)fp3_bodies_count(w.bodies));
    value(&w, "x_x", w.handle[w.count - 1]);
    for (int i = 0; i < steps && !engine; i++) {
        refuse(&w);
        if (w.count < BODIES && one_of(4) == 0)
            add(&w);
        if (w.count && one_of(6) == 0) {
            const int which = one_of(w.count);
            must(&w, fp3_bodies_remove(w.bodies, &w.handle[which], 1), "remove");
            must_not(&w, fp3_bodies_remove(w.bodies, &w.handle[which], 1), "removed again");
            w.handle[which] = w.handle[--w.count];
        }
        if (w.count && one_of(6) == 0)
            must(&w,
                 fp3_bodies_write(w.bodies, "v_y", &w.handle[one_of(w.count)], 1,
                                  &(double){between(-9, 9)}),
                 "write");
        if (!step(&w, 0))
            break;
    }
    end(&w, &state);
    return hash;
}

int main(int argc, char **argv) {
    if (argc < 3)
        return 2;
    const uint64_t first = strtoull(argv[1], NULL, 10), count = strtoull(argv[2], NULL, 10);
    const char *engine = argc > 3 && strcmp(argv[3], "-") ? argv[3] : NULL;
    for (uint64_t i = first; i < first + count; i++) {
        int has_gained = 0;
        const uint64_t hash = run(i, engine, argc > 4 ? argv[4] : NULL, &has_gained);
        printf("%" PRIu64 " %016" PRIx64 " %d\n", i, hash, has_gained);
    }
    return 0;
}
