/* at_first.c - what objects hold on a board after a load, before anybody has written them: engine.h
 * promises 0.
 *
 *     at_first PORT IMAGE     prints of object 0 the states x and y, the constant k, and how many
 * objects have failed after a step from there; then how many requests the line carries for two
 * columns of three objects, and for reading one word, and whether its bytes are no fewer than
 *                             docs/board.md says: 20 and 8 for each of three writes, 12 and 264 for
 * the read
 */
#include <fp3/engine.h>
#include <fp3/image.h>
#include <stdio.h>

int main(int count, char **arguments) {
    fp3_error error = {0};
    fp3_engine_def def = fp3_engine_default();
    fp3_engine *engine = NULL;
    fp3_image *image = NULL;
    fp3_failure failure;
    const float column[3] = {1, 2, 3};
    uint64_t requests = 0, bytes = 0;
    float x, y, k, z;
    if (count != 3)
        return 2;
    def.engine = "board";
    def.config = "many";
    def.port = arguments[1];
    def.objects = 3;
    def.error = &error;
    fp3_status status = fp3_image_load(arguments[2], &image, &error);
    if (!status)
        status = fp3_engine_open(&def, &engine);
    if (!status)
        status = fp3_engine_load(engine, image);
    if (!status)
        status = fp3_engine_get(engine, 0, "x", &x);
    if (!status)
        status = fp3_engine_get(engine, 0, "y", &y);
    if (!status)
        status = fp3_engine_get(engine, 0, "k", &k);
    if (!status)
        status = fp3_engine_run(engine, 1, NULL);
    if (!status)
        status = fp3_engine_failure(engine, 0, 3, &failure);
    requests = status ? 0 : fp3_engine_bus(engine).requests;
    bytes = status ? 0 : fp3_engine_bus(engine).bytes;
    for (uint32_t reg = 0; !status && reg < 2; reg++)
        status = fp3_engine_write(engine, 0, 3, reg, column);
    if (!status)
        status = fp3_engine_read(engine, 2, 1, 0, &z);
    if (status)
        fprintf(stderr, "at_first: %s\n", error.text);
    else
        printf("%g %g %g %zu, %g in %d, %s\n", (double)x, (double)y, (double)k, failure.failed,
               (double)z, (int)(fp3_engine_bus(engine).requests - requests),
               fp3_engine_bus(engine).bytes - bytes >= 3 * 28 + 276 ? "all bytes" : "too few");
    fp3_engine_close(&engine);
    fp3_image_free(&image);
    return status != FP3_OK;
}
