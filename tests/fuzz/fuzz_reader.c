/* fuzz_reader.c - any bytes for the readers beside that of models: each refuses them with one line
 * of text, or gives what its header promises.
 *
 *     fuzz_reader assembly FILE...     each file once (tests/fuzz/test_corpus.py)
 *
 * With -DFP3_LIBFUZZER it is the target of clang's libFuzzer, of the reader that the environment
 * names in FP3_READER (`make fuzz READER=assembly`). HDF5 and checkpoints are not among them: what
 * libhdf5 makes of files that are broken on purpose is in docs/limits.md. */
#include <fp3/compile.h>
#include <fp3/image.h>
#include <fp3/program.h>
#include <fp3/scene.h>

#include "engine/board/packet.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#define REQUIRE(condition)                                                                         \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "fuzz_reader.c:%d: not true: %s\n", __LINE__, #condition);             \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

static void check_error(fp3_status status, const fp3_error *error) {
    REQUIRE(status > 0 && error->text[0]);
    for (const char *c = error->text; *c; c++)
        REQUIRE((unsigned char)*c >= ' ' && *c != 0x7f);
}

/* ---- programs ---- */

/* Text of it assembles to the same image. */
static void check_image(const fp3_image *image) {
    fp3_error error;
    fp3_assembly *again = NULL;
    uint32_t *words = NULL, *same = NULL;
    size_t count = 0, same_count = 0;
    char *text = NULL;
    REQUIRE(image->step < image->last && image->last <= image->code_count);
    REQUIRE(image->registers <= 64 && image->shared <= 64);
    REQUIRE(!fp3_image_encode(image, &words, &count, &error));
    const fp3_status status = fp3_disassemble(image, &text, &error);
    if (status)
        check_error(status, &error);
    else {
        REQUIRE(!fp3_assemble(text, strlen(text), "again.s", &again, &error));
        REQUIRE(!fp3_image_encode(again->image, &same, &same_count, &error));
        REQUIRE(same_count == count && !memcmp(words, same, count * sizeof *words));
    }
    free(text);
    free(words);
    free(same);
    fp3_assembly_free(&again);
}

static void assembly(const char *data, size_t size) {
    fp3_error error;
    fp3_assembly *result = NULL;
    char *listing = NULL;
    const fp3_status status = fp3_assemble(data, size, "fuzz.s", &result, &error);
    REQUIRE(result && !status == !!result->image);
    if (status) {
        check_error(status, &error);
        REQUIRE(result->error_count > 0 && result->error_count <= 20 && result->report[0]);
    } else {
        check_image(result->image);
        REQUIRE(!fp3_listing(result, data, size, &listing, &error));
    }
    free(listing);
    fp3_assembly_free(&result);
    REQUIRE(!result);
}

/* Its number of words and its CRC are made right: else nothing behind them would be read. */
static void image(const char *data, size_t size) {
    const size_t count = size / 4;
    uint32_t *words = malloc((count ? count : 1) * sizeof *words), *same = NULL;
    size_t same_count = 0;
    fp3_image *made = NULL;
    fp3_error error;
    REQUIRE(words);
    memcpy(words, data, 4 * count);
    if (count > FP3_IMAGE_HEADER_WORDS && words[2] % 16) {
        words[0] = FP3_IMAGE_MAGIC;
        words[2] = (uint32_t)count;
        words[count - 1] = (uint32_t)crc32(0, (const Bytef *)words, (uInt)(4 * (count - 1)));
    }
    const fp3_status status = fp3_image_decode(words, count, &made, &error);
    if (status) {
        check_error(status, &error);
        REQUIRE(!made);
    } else {
        REQUIRE(!fp3_image_encode(made, &same, &same_count, &error));
        REQUIRE(same_count == count && !memcmp(words, same, 4 * count));
        check_image(made);
    }
    free(same);
    free(words);
    fp3_image_free(&made);
}

static void integrator(const char *data, size_t size) {
    char *text = calloc(size + 1, 1);
    fp3_integrator *made = NULL;
    fp3_error error;
    REQUIRE(text);
    memcpy(text, data, size);
    const fp3_status status = fp3_integrator_read(text, "fuzz.cfg", &made, &error);
    if (status)
        check_error(status, &error);
    REQUIRE(!status == !!made);
    fp3_integrator_free(&made);
    free(text);
}

/* ---- files: in a folder of their own, in which scenes find the programs ---- */

static char folder[] = "/tmp/fp3-fuzz-XXXXXX";
static char path[64];

static void leave(void) {
    unlink(path);
    snprintf(path, sizeof path, "%s/programs", folder);
    unlink(path);
    rmdir(folder);
}

static const char *file(const char *data, size_t size) {
    if (!path[0]) {
        char here[4096], link[64];
        REQUIRE(mkdtemp(folder) && getcwd(here, sizeof here - 16));
        strcat(here, "/programs/world");
        snprintf(link, sizeof link, "%s/programs", folder);
        snprintf(path, sizeof path, "%s/fuzz", folder);
        REQUIRE(!symlink(here, link));
        atexit(leave);
    }
    FILE *to = fopen(path, "wb");
    REQUIRE(to && fwrite(data, 1, size, to) == size && !fclose(to));
    return path;
}

static void check_file_error(fp3_status status, const fp3_error *error) {
    check_error(status, error);
    REQUIRE(strstr(error->text, path));
}

static void params(const char *data, size_t size) {
    fp3_params *made = NULL;
    fp3_error error;
    REQUIRE(!fp3_params_make(&made, &error));
    const fp3_status status = fp3_params_load(made, file(data, size), &error);
    if (status)
        check_file_error(status, &error);
    fp3_params_free(&made);
}

static void links(const char *data, size_t size) {
    char text[80];
    size_t objects = 0;
    fp3_params *made = NULL;
    fp3_error error;
    REQUIRE(!fp3_params_make(&made, &error));
    snprintf(text, sizeof text, "ties=%s", file(data, size));
    const fp3_status status =
        fp3_params_link_file(made, text, size % 2 ? 1000 : 0, &objects, &error);
    if (status)
        check_file_error(status, &error);
    else
        REQUIRE(size % 2 == 0 || objects <= 1000);
    fp3_params_free(&made);
}

static void scene(const char *data, size_t size) {
    fp3_scene *made = NULL;
    fp3_error error;
    const fp3_status status = fp3_scene_open(file(data, size), NULL, &made, &error);
    if (status) {
        check_error(status, &error);
        REQUIRE(!made);
    } else {
        size_t objects = 0;
        for (size_t i = 0; i < made->group_count; i++)
            objects += made->groups[i].objects;
        REQUIRE(made->group_count > 0 && objects == made->objects);
    }
    fp3_scene_close(&made);
}

/* ---- the line of a board ---- */

/* Never more than a packet's words, however long the line is bad. */
static void packet(const char *data, size_t size) {
    fp3_packet_reader reader = {0};
    for (size_t i = 0; i < size; i++)
        if (fp3_packet_feed(&reader, (uint8_t)data[i]))
            REQUIRE(reader.size <= FP3_PACKET_CONTENT - 4);
}

/* ---- all of them ---- */

static const struct {
    const char *name;
    void (*read)(const char *data, size_t size);
} readers[] = {{"assembly", assembly}, {"image", image}, {"integrator", integrator},
               {"params", params},     {"links", links}, {"scene", scene},
               {"packet", packet}};
enum { READERS = sizeof readers / sizeof *readers };

static unsigned find(const char *name) {
    for (unsigned i = 0; i < READERS; i++)
        if (name && !strcmp(name, readers[i].name))
            return i;
    fprintf(stderr, "fuzz_reader: no reader '%s': there are", name ? name : "");
    for (unsigned i = 0; i < READERS; i++)
        fprintf(stderr, " %s", readers[i].name);
    fprintf(stderr, "\n");
    exit(2);
}

/* A copy of exactly this size, so that the sanitizer sees a read beyond its end. */
static void run(unsigned reader, const unsigned char *data, size_t size) {
    char *exact = malloc(size ? size : 1);
    REQUIRE(exact);
    memcpy(exact, data, size);
    readers[reader].read(exact, size);
    free(exact);
}

#ifdef FP3_LIBFUZZER

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    static int reader = -1;
    if (reader < 0)
        reader = (int)find(getenv("FP3_READER"));
    run((unsigned)reader, data, size);
    return 0;
}

#else

int main(int argc, char **argv) {
    const unsigned reader = find(argc > 1 ? argv[1] : NULL);
    for (int i = 2; i < argc; i++) {
        FILE *from = fopen(argv[i], "rb");
        static unsigned char data[1 << 21];
        if (!from) {
            perror(argv[i]);
            return 2;
        }
        const size_t size = fread(data, 1, sizeof data, from);
        fclose(from);
        fprintf(stderr, "%s\n", argv[i]); /* after a crash the last line names the input */
        run(reader, data, size);
    }
    printf("%d files\n", argc - 2);
    return 0;
}

#endif
