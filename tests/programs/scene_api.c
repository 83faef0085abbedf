/* Runs a scene: the first state of each group's first object, and what the run cost. */
#include <fp3/scene.h>
#include <stdio.h>

static fp3_status run(const fp3_scene *scene, fp3_error *error) {
    fp3_engine *engine = NULL;
    fp3_stats stats;
    fp3_engine_def def = fp3_scene_engine(scene);
    def.error = error;
    fp3_status status = fp3_engine_open(&def, &engine);
    if (!status)
        status = fp3_scene_load(scene, engine, error);
    if (!status)
        status = fp3_adaptive_run(engine, scene->steps, &stats);
    for (size_t i = 0; !status && i < scene->group_count; i++) {
        const fp3_scene_group *group = &scene->groups[i];
        const char *name = group->program->image->symbols[0].name;
        float value;
        status = fp3_engine_get(engine, group->first, name, &value);
        if (!status)
            printf("%s: %s = %.9g\n", group->path, name, (double)value);
    }
    if (!status)
        printf("%llu cycles\n", (unsigned long long)stats.counter[FP3_COUNTER_CYCLES]);
    fp3_engine_close(&engine);
    return status;
}

int main(int argc, char **argv) {
    fp3_error error;
    fp3_scene *scene = NULL;
    fp3_status status = fp3_scene_open(argc > 1 ? argv[1] : "", NULL, &scene, &error);
    if (!status)
        status = run(scene, &error);
    if (status)
        fprintf(stderr, "%s\n", error.text);
    fp3_scene_close(&scene);
    return fp3_exit_code(status);
}
