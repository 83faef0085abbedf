/* bridge.c - a game: a car drives over a bridge, jumps, knocks boxes down, and reaches a goal.
 *     cc bridge.c $(pkg-config --cflags --libs fp3) -o bridge */
#include <fp3/bodies.h>
#include <inttypes.h>
#include <stdio.h>

enum { FRAMES = 540, GOAL = 70, BOXES = 12, PLANKS = 10 };
enum { OTHER = 1, CAR = 2 };                       /* categories: the car, and all else */
enum { BRAKE = 120, BRAKE_END = 150, TOLD = 160 }; /* when the player brakes; when the game hears */

typedef struct {
    int points, goal, is_fallen[BOXES];
    double jump;
} score;

typedef struct {
    fp3_error error;
    fp3_bodies *world;
    uint64_t ground, goal, car, wheels[2], planks[PLANKS], boxes[BOXES], motors[2];
    score score;
} game;

/* A body, and its shape if there is one. */
static int put(game *g, fp3_body_type type, double x, double y, const fp3_shape_def *shape,
               uint64_t *handle) {
    fp3_body_def def = fp3_body_default();
    def.type = type, def.x[0] = x, def.x[1] = y;
    return fp3_bodies_add(g->world, &def, 1, handle) ||
           (shape && fp3_bodies_attach(g->world, handle, 1, shape, NULL));
}

static int hinge(game *g, uint64_t a, double ax, double ay, uint64_t b, double bx) {
    fp3_joint_def def = fp3_joint_default(FP3_HINGE, a, b);
    uint64_t joint;
    def.anchor_a[0] = ax, def.anchor_a[1] = ay, def.anchor_b[0] = bx;
    return fp3_bodies_join(g->world, &def, 1, &joint);
}

/* The ground with a ramp, a bridge of ten planks, a pile of boxes, and the goal. */
static int build(game *g) {
    static const double GROUND[][2] = {{90, 0},  {36, 0},  {36, 1}, {30, 0}, {20, 0},
                                       {20, -6}, {10, -6}, {10, 0}, {-10, 0}};
    fp3_shape_def rock = fp3_shape_circle(0), post = fp3_shape_box(0.1, 2, 0);
    fp3_shape_def plank = fp3_shape_box(0.5, 0.1, 0), box = fp3_shape_box(0.49, 0.5, 0);
    rock.friction = 0.9, post.is_sensor = 1, box.density = 0.1;
    int failed = put(g, FP3_STATIC, 0, 0, NULL, &g->ground) ||
                 put(g, FP3_STATIC, GOAL, 2, &post, &g->goal) ||
                 fp3_bodies_attach_chain(g->world, g->ground, GROUND[0],
                                         sizeof GROUND / sizeof GROUND[0], 0, &rock);
    for (int i = 0; !failed && i < PLANKS; i++)
        failed = put(g, FP3_DYNAMIC, 10.5 + i, -0.1, &plank, &g->planks[i]);
    failed = failed || hinge(g, g->ground, 10, -0.1, g->planks[0], -0.5);
    for (int i = 0; !failed && i + 1 < PLANKS; i++)
        failed = hinge(g, g->planks[i], 0.5, 0, g->planks[i + 1], -0.5);
    failed = failed || hinge(g, g->ground, 20, -0.1, g->planks[PLANKS - 1], 0.5);
    for (int i = 0; !failed && i < BOXES; i++)
        failed = put(g, FP3_DYNAMIC, 54 + i % 3, 0.5 + i / 3, &box, &g->boxes[i]);
    return failed;
}

/* A body and two wheels, each on a spring and with a motor. */
static int build_car(game *g) {
    fp3_shape_def chassis = fp3_shape_box(1.2, 0.3, 0), tyre = fp3_shape_circle(0.4);
    chassis.density = 3, chassis.category = CAR, tyre.friction = 0.9, tyre.category = CAR;
    int failed = put(g, FP3_DYNAMIC, 0, 1, &chassis, &g->car);
    for (int i = 0; !failed && i < 2; i++)
        failed = put(g, FP3_DYNAMIC, i ? 0.8 : -0.8, 0.6, &tyre, &g->wheels[i]);
    for (int i = 0; !failed && i < 2; i++) {
        fp3_joint_def def = fp3_joint_default(FP3_WHEEL, g->car, g->wheels[i]);
        def.anchor_a[0] = i ? 0.8 : -0.8, def.anchor_a[1] = -0.4;
        def.axis[0] = 0, def.axis[1] = 1;
        def.hertz = 4, def.damping = 0.7, def.most = 4;
        failed = fp3_bodies_join(g->world, &def, 1, &g->motors[i]);
    }
    return failed;
}

/* Two bodies have begun to touch: a box that falls to the ground gives points, and the goal ends
 * the race. */
static void touch(game *g, const fp3_contact *contact) {
    const uint64_t a = contact->body_a, b = contact->body_b;
    for (int i = 3; i < BOXES; i++) /* the first three stand on the ground */
        if (((a == g->ground && b == g->boxes[i]) || (b == g->ground && a == g->boxes[i])) &&
            !g->score.is_fallen[i])
            g->score.points += 10, g->score.is_fallen[i] = 1;
    if (((a == g->car && b == g->goal) || (b == g->car && a == g->goal)) && !g->score.goal)
        g->score.goal = (int)(fp3_bodies_time(g->world) * 60 + 0.5);
}

/* The player's key goes in, a step is made, and the score comes out. */
static int frame(game *g, int brakes) {
    static const double DOWN[2] = {0, -20};
    const fp3_contact *began = NULL;
    size_t count = 0;
    double x[2];
    fp3_hit below;
    if (fp3_bodies_read(g->world, "x", &g->car, 1, x) ||
        fp3_bodies_ray(g->world, x, DOWN, 1, OTHER, &below)) /* OTHER: it begins within the car */
        return 1;
    if (below.distance > g->score.jump)
        g->score.jump = below.distance;
    const int flies = below.distance > 1.3; /* then wheels that push would turn the car over */
    const double speed = brakes || flies || g->score.goal ? 0 : -40;
    if (fp3_bodies_joint_write(g->world, "speed", g->motors, 2, (const double[]){speed, speed}) ||
        fp3_bodies_step(g->world, 1) ||
        fp3_bodies_changes(g->world, FP3_CONTACT_BEGAN, &began, &count))
        return 1;
    for (size_t i = 0; i < count; i++)
        touch(g, &began[i]);
    return 0;
}

static int brakes(int at) { return at >= BRAKE && at < BRAKE_END; }

/* A game whose key is known at once, or late: then it plays on as if nobody braked, and once more
 * when it is told. */
static int play(game *g, int is_late) {
    fp3_bodies_state *saved = NULL;
    score score_then = {0};
    double guess = 0, x = 0;
    int failed = 0;
    for (int at = 0; !failed && at < FRAMES; at++) {
        if (is_late && at == BRAKE) {
            failed = fp3_bodies_save(g->world, &saved);
            score_then = g->score;
        }
        if (!failed && is_late && at == TOLD) {
            failed = fp3_bodies_read(g->world, "x_x", &g->car, 1, &guess) ||
                     fp3_bodies_restore(g->world, saved);
            g->score = score_then;
            for (int again = BRAKE; !failed && again < TOLD; again++)
                failed = frame(g, brakes(again));
            failed = failed || fp3_bodies_read(g->world, "x_x", &g->car, 1, &x);
            printf("frame %d: the car is at %.3f by guess, at %.3f as played\n", TOLD, guess, x);
        }
        failed = failed || frame(g, brakes(at) && !is_late);
    }
    fp3_bodies_state_free(&saved);
    return failed;
}

int main(void) {
    static const char *const NAMES[] = {"here", "there"};
    static game games[2];
    int failed = 0;
    for (int i = 0; !failed && i < 2; i++) {
        game *g = &games[i];
        fp3_bodies_def def = fp3_bodies_default();
        def.gravity[1] = -10, def.error = &g->error;
        failed = fp3_bodies_open(&def, &g->world) || build(g) || build_car(g) || play(g, i);
    }
    for (int i = 0; i < 2; i++) {
        const game *g = &games[i];
        if (failed)
            fprintf(stderr, "%s\n", g->error.text);
        else
            printf("%s: %d points, %.3f m high, goal in frame %d, hash %016" PRIx64 "\n", NAMES[i],
                   g->score.points, g->score.jump, g->score.goal, fp3_bodies_hash(g->world));
        fp3_bodies_close(&games[i].world);
    }
    return failed;
}
