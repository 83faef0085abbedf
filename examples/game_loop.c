/* game_loop.c - every frame: forces in, a step, positions out. Built with
 *     cc game_loop.c $(pkg-config --cflags --libs fp3) -o game_loop */
#include <fp3/batch.h>
#include <stdio.h>

enum { N = 10000, FRAMES = 600 };
static float fx[N], fy[N], x[N], y[N];

int main(void) {
    fp3_error error = {.text = ""};
    fp3_batch_def def = fp3_batch_default();
    def.model = "drone.ode", def.objects = N, def.error = &error;
    fp3_batch *drones = NULL;
    fp3_status failed = fp3_batch_open(&def, &drones);
    for (int frame = 0; !failed && frame < FRAMES; frame++) {
        for (int i = 0; i < N; i++) /* a spring pulls each to its own place */
            fx[i] = (float)i - x[i], fy[i] = 100 - y[i];
        failed = fp3_batch_write(drones, "F_x", 0, N, fx) ||
                 fp3_batch_write(drones, "F_y", 0, N, fy) || fp3_batch_run(drones, 1) ||
                 fp3_batch_read(drones, (const char *[]){"x_x", "x_y"}, 2, 0, N, (float *[]){x, y});
    }
    fp3_batch_close(&drones);
    printf("%g %g %s\n", x[1], y[1], error.text);
    return failed;
}
