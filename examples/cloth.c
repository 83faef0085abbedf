/* cloth.c - a cloth hangs from two corners. cc cloth.c $(pkg-config --cflags --libs fp3) */
#include <fp3/batch.h>
#include <stdio.h>

enum { W = 24, N = W * W };
static float x[N], y[N], z[N], w[N];
static uint32_t a[2 * N], b[2 * N];

int main(void) {
    fp3_error error = {.text = ""};
    fp3_batch_def def = fp3_batch_default();
    def.model = "cloth.ode", def.integrator = "leapfrog", def.objects = N, def.error = &error;
    fp3_batch *cloth = NULL;
    fp3_links springs = {.a = a, .b = b};
    for (uint32_t i = 0; i < N; i++) { /* flat at first, linked along rows and columns */
        x[i] = 0.05f * (float)(i % W), z[i] = 0.05f * (float)(i / W);
        w[i] = i == 0 || i == W - 1 ? 0 : 1000;
        for (uint32_t way = 1; way <= W; way += W - 1)
            if (way == 1 ? i % W + 1 < W : i + W < N)
                a[springs.count] = i, b[springs.count++] = i + way;
    }
    int failed = fp3_batch_open(&def, &cloth) || fp3_batch_link(cloth, "springs", &springs) ||
                 fp3_batch_write(cloth, "w", 0, N, w) || fp3_batch_write(cloth, "x_x", 0, N, x) ||
                 fp3_batch_write(cloth, "x_z", 0, N, z);
    for (int frame = 0; !failed && frame < 480; frame++) /* a game would draw x, y, z */
        failed =
            fp3_batch_run(cloth, 16) || fp3_batch_read(cloth, (const char *[]){"x_x", "x_y", "x_z"},
                                                       3, 0, N, (float *[]){x, y, z});
    fp3_batch_close(&cloth);
    printf("%g %g %g %s\n", x[N - 1], y[N - 1], z[N - 1], error.text);
    return failed;
}
