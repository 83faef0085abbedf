/* castle.c - a catapult tries its aims, takes the best, and shoots at a tower.
 *     cc castle.c $(pkg-config --cflags --libs fp3) -lm -o castle */
#include <fp3/bodies.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

enum { RING = 12, LAYERS = 8, BRICKS = RING * LAYERS, FRAMES = 240 };
static const double PI = 3.141592653589793;

typedef struct {
    fp3_error error;
    fp3_bodies *world;
    uint64_t bricks[BRICKS];
} castle;

/* The ground, and a round tower: in each layer bricks stand over the gaps of the layer below. */
static int build(castle *c) {
    fp3_body_def ground = fp3_body_default(), bricks[BRICKS];
    fp3_shape_def plane = fp3_shape_circle(0), box = fp3_shape_box3(0.25, 0.25, 0.45, 0);
    uint64_t handle;
    ground.type = FP3_STATIC;
    plane.type = FP3_PLANE, plane.normal[0] = 0, plane.normal[1] = 1, plane.normal[2] = 0;
    plane.friction = 0.8;
    for (int i = 0; i < BRICKS; i++) {
        const double turn = 2 * PI / RING * (i % RING + i / RING / 2.0);
        bricks[i] = fp3_body_default();
        bricks[i].x[0] = 2 * cos(turn), bricks[i].x[2] = 2 * sin(turn);
        bricks[i].x[1] = 0.25 + 0.5 * (i / RING);
        bricks[i].q[0] = cos(turn / 2), bricks[i].q[2] = -sin(turn / 2);
    }
    return fp3_bodies_add(c->world, &ground, 1, &handle) ||
           fp3_bodies_attach(c->world, &handle, 1, &plane, NULL) ||
           fp3_bodies_add(c->world, bricks, BRICKS, c->bricks) ||
           fp3_bodies_attach(c->world, c->bricks, BRICKS, &box, NULL);
}

/* A ball of 4 t flies to the tower, and 4 seconds pass; *fallen: how many bricks have come down by
 * a layer. */
static int shoot(castle *c, double up, int *fallen) {
    fp3_body_def def = fp3_body_default();
    fp3_shape_def sphere = fp3_shape_sphere(0.5);
    double x[BRICKS][3];
    uint64_t ball;
    def.x[0] = -12, def.x[1] = 1, def.x[2] = 0.5, def.v[0] = 28, def.v[1] = up;
    def.is_fast = 1, sphere.density = 8;
    if (fp3_bodies_add(c->world, &def, 1, &ball) ||
        fp3_bodies_attach(c->world, &ball, 1, &sphere, NULL) || fp3_bodies_step(c->world, FRAMES) ||
        fp3_bodies_read(c->world, "x", c->bricks, BRICKS, x[0]))
        return 1;
    *fallen = 0;
    for (int i = 0; i < BRICKS; i++)
        *fallen += x[i][1] < 0.25 + 0.5 * (i / RING) - 0.5;
    return 0;
}

/* Each aim is tried, and the world goes back. */
static int find_aim(castle *c, int *best) {
    fp3_bodies_state *saved = NULL;
    int most = -1, failed = fp3_bodies_save(c->world, &saved);
    for (int up = 0, fallen; !failed && up <= 6; up += 2) {
        failed = shoot(c, up, &fallen) || fp3_bodies_restore(c->world, saved);
        if (!failed)
            printf("aim %d: %d bricks fall\n", up, fallen);
        if (!failed && fallen > most)
            *best = up, most = fallen;
    }
    fp3_bodies_state_free(&saved);
    return failed;
}

int main(void) {
    static const double FROM[3] = {-12, 1, 0.5}, WAY[3] = {24, 0, 0};
    castle c = {.error = {.text = ""}};
    fp3_bodies_def def = fp3_bodies_default();
    fp3_hit hit;
    int aim = 0, fallen = 0;
    def.error = &c.error, def.dimensions = 3, def.gravity[1] = -10;
    int failed = fp3_bodies_open(&def, &c.world) || build(&c) ||
                 fp3_bodies_ray(c.world, FROM, WAY, 1, UINT32_MAX, &hit);
    if (!failed) {
        printf("the tower is %.3f m away\n", hit.distance);
        failed = find_aim(&c, &aim) || shoot(&c, aim, &fallen);
    }
    if (failed)
        fprintf(stderr, "%s\n", c.error.text);
    else
        printf("shot with %d: %d of %d bricks fell, hash %016" PRIx64 "\n", aim, fallen, BRICKS,
               fp3_bodies_hash(c.world));
    fp3_bodies_close(&c.world);
    return failed;
}
