/* bodies.c - a box falls on the ground. cc bodies.c $(pkg-config --cflags --libs fp3) */
#include <fp3/bodies.h>
#include <stdio.h>

int main(void) {
    fp3_error error = {.text = ""};
    fp3_bodies_def def = fp3_bodies_default();
    fp3_body_def ground = fp3_body_default(), box = fp3_body_default();
    fp3_shape_def slab = fp3_shape_box(50, 1, 0), cube = fp3_shape_box(0.5, 0.5, 0);
    fp3_bodies *world = NULL;
    uint64_t ids[2];
    double x[2] = {0}, angle = 0;
    def.error = &error, ground.type = FP3_STATIC;
    ground.x[1] = -1, box.x[1] = 4, box.angle = 0.3;
    int failed = fp3_bodies_open(&def, &world) || fp3_bodies_add(world, &ground, 1, &ids[0]) ||
                 fp3_bodies_add(world, &box, 1, &ids[1]) ||
                 fp3_bodies_attach(world, &ids[0], 1, &slab, NULL) ||
                 fp3_bodies_attach(world, &ids[1], 1, &cube, NULL);
    for (int frame = 0; !failed && frame < 120; frame++) /* a game would draw x and angle */
        failed = fp3_bodies_step(world, 1) || fp3_bodies_read(world, "x", &ids[1], 1, x) ||
                 fp3_bodies_read(world, "angle", &ids[1], 1, &angle);
    fp3_bodies_close(&world);
    printf("%.3f %.3f %.3f %s\n", x[0], x[1], angle, error.text);
    return failed;
}
