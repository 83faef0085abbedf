/* ship.c - a program outside the tree: compiles a model, runs it on the engine that is asked for.
 *
 *     cc ship.c -o ship $(pkg-config --cflags --libs fp3)
 *     ./ship ship.ode isa
 *
 * It is C and C++.
 */
#include <fp3/engine.h>
#include <fp3/program.h>
#include <stdio.h>

int main(int argc, char **argv) {
    fp3_error error;
    fp3_program_def program_def = fp3_program_default();
    fp3_engine_def def = fp3_engine_default();
    fp3_params *params = NULL;
    fp3_program *program = NULL;
    fp3_engine *engine = NULL;
    fp3_status status = FP3_OK;
    float s = 0, v = 0;
    if (argc != 3)
        return 2;
    def.engine = argv[2];
    def.config = program_def.compile.config = "single_full";
    def.error = &error;
    if ((status = fp3_params_make(&params, &error)) ||
        (status = fp3_program_open(argv[1], &program_def, &program, NULL, &error)) ||
        (status = fp3_engine_open(&def, &engine)) ||
        (status = fp3_program_load(program, params, engine, &error)) ||
        (status = fp3_engine_run(engine, 100, NULL)) ||
        (status = fp3_engine_get(engine, 0, "s", &s)) ||
        (status = fp3_engine_get(engine, 0, "v", &v)))
        fprintf(stderr, "%s\n", error.text);
    else
        printf("s %.9g v %.9g\n", (double)s, (double)v);
    fp3_engine_close(&engine);
    fp3_program_close(&program);
    fp3_params_free(&params);
    return fp3_exit_code(status);
}
