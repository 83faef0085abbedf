/* sparks.c - balls are thrown, knock, and are gone. cc sparks.c $(pkg-config --cflags --libs fp3)
 */
#include <fp3/batch.h>
#include <stdio.h>

enum { MOST = 64, FRAMES = 200 };
static uint64_t thrown[MOST]; /* handles, the oldest first to go */

/* How loud the knocks of this frame are: the force of each contact that began. */
static fp3_status listen(fp3_batch *balls, size_t *knocks, float *loudest) {
    fp3_contacts now;
    fp3_status status = fp3_batch_contacts(balls, "touch", 0, &now);
    for (size_t i = 0; !status && i < now.began; i++, ++*knocks) {
        uint32_t a, b;
        float push = 0;
        fp3_batch_numbers(balls, &now.began_a[i], 1, &a);
        fp3_batch_numbers(balls, &now.began_b[i], 1, &b);
        status = fp3_batch_remembered(balls, "touch", "push", &a, &b, 1, &push);
        *loudest = push > *loudest ? push : *loudest;
    }
    return status;
}

int main(void) {
    fp3_error error = {.text = ""};
    fp3_batch_def def = fp3_batch_default();
    def.model = "sparks.ode", def.integrator = "semi_implicit_euler";
    def.objects = MOST, def.is_empty = 1, def.error = &error;
    fp3_batch *balls = NULL;
    fp3_status status = fp3_batch_open(&def, &balls);
    size_t knocks = 0;
    float loudest = 0;
    for (int frame = 0; !status && frame < FRAMES; frame++) {
        uint64_t *ball = &thrown[frame % MOST];
        const float v_x = (float)(frame * 7 % 11) - 5;
        if (frame >= MOST) /* no room: the oldest goes */
            status = fp3_batch_remove(balls, ball, 1);
        if (!status && !(status = fp3_batch_add(balls, 1, ball)))
            status = fp3_batch_write_of(balls, "v_x", ball, 1, &v_x);
        if (!status && !(status = fp3_batch_run(balls, 4)))
            status = listen(balls, &knocks, &loudest);
    }
    const double mouse[] = {0, 0.1}, right[] = {1, 0};
    const fp3_rays ray = {.count = 1, .origins = mouse, .directions = right, .radius_of = "R"};
    uint32_t nearest = FP3_NOBODY, hit = FP3_NOBODY;
    double away = 0, ahead = 0;
    if (!status && !(status = fp3_batch_nearest(balls, "touch", mouse, 1, &nearest, &away)))
        status = fp3_batch_ray(balls, "touch", &ray, &hit, &ahead);
    printf("%zu knocks, the loudest %.1f N; ball %u is %.2f m away, ball %u %.2f m ahead%s\n",
           knocks, (double)loudest, nearest, away, hit, ahead, status ? error.text : "");
    fp3_batch_close(&balls);
    return (int)status;
}
