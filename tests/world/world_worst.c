/* world_worst.c - words that objects of two groups compare, by programs of hand-written assembly.
 *
 *     world_worst ENGINE      prints the word that each object has in the end, or why not
 */
#include <fp3/engine.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static fp3_error error;

static void told(fp3_status status) {
    if (!status)
        return;
    printf("FAIL: %s\n", error.text);
    exit(1);
}

static fp3_assembly *made(const char *text) {
    fp3_assembly *a = NULL;
    told(fp3_assemble(text, strlen(text), "w.s", &a, &error));
    return a;
}

static const char head[] = ".state x y z\n.param o\n.worst most other\nstep:\nld x\n";
/* Both words behind the first phase; the other one behind the second, with a phase between. */
static const char *const programs[] = {
    "add most, x, -0.0\nst most\nsub other, -0.0, x\nst other\nphase\n"
    "ld most\nld other\nadd y, most, -0.0\nadd z, other, -0.0\nst y\nst z\n",
    "sub other, -0.0, x\nadd most, x, -0.0\nst most\nst other\nphase\nld x\nst x\nphase\n"
    "ld most\nld other\nadd y, most, -0.0\nadd z, other, -0.0\nst y\nst z\n",
    "add most, x, -0.0\nst most\nphase\nld x\nsub other, -0.0, x\nst other\nphase\n"
    "ld most\nld other\nadd y, most, -0.0\nadd z, other, -0.0\nst y\nst z\n"};

static void run(const char *name, int which) {
    enum { FIRST = 3, ALL = 5 };
    const fp3_foreign word = {"o", 1, "x"};
    fp3_assembly *a[2];
    fp3_engine_def def = fp3_engine_default();
    fp3_engine *engine = NULL;
    const float x[ALL] = {-1, 3, 2, -7, 0.5f};
    float y[ALL], z[ALL];
    char text[1024];
    for (int i = 0; i < 2; i++) {
        snprintf(text, sizeof text, "%s%s", head, programs[i ? which : 0]);
        a[i] = made(text);
    }
    def.engine = name;
    def.config = "world";
    def.objects = ALL;
    def.error = &error;
    told(fp3_engine_open(&def, &engine));
    const fp3_group groups[] = {
        {.image = a[0]->image, .objects = FIRST, .foreign = &word, .foreign_count = 1},
        {.image = a[1]->image, .objects = ALL - FIRST}};
    if (fp3_engine_load_groups(engine, groups, 2)) {
        printf("%s\n", error.text);
    } else {
        told(fp3_engine_write(engine, 0, ALL, 0, x));
        told(fp3_engine_run(engine, 2, NULL));
        told(fp3_engine_read(engine, 0, ALL, 1, y));
        told(fp3_engine_read(engine, 0, ALL, 2, z));
        for (int i = 0; i < ALL; i++)
            printf("%g,%g%s", (double)y[i], (double)z[i], i + 1 < ALL ? " " : "\n");
    }
    fp3_engine_close(&engine);
    for (int i = 0; i < 2; i++)
        fp3_assembly_free(&a[i]);
}

int main(int argc, char **argv) {
    for (int which = 0; which < 3; which++)
        run(argc > 1 ? argv[1] : "isa", which);
    return 0;
}
