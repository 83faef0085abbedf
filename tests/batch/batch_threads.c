/* batch_threads.c - two threads, each with batches of its own at the same time: of a text each, and
 * of one compiled program. Prints what differs.
 *
 *     build/tests/batch_threads MODEL PARAM STATE
 */
#include <fp3/batch.h>
#include <fp3/program.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { OBJECTS = 3000, FRAMES = 20 };

typedef struct {
    const char *model, *param, *state;
    const fp3_compiled *compiled; /* of both */
    float column[2][OBJECTS];
    fp3_error error;
} player;

static fp3_status play(player *p, int is_shared) {
    fp3_batch_def def = fp3_batch_default();
    fp3_batch *batch = NULL;
    float column[OBJECTS];
    def.model = is_shared ? NULL : p->model;
    def.compiled = is_shared ? p->compiled : NULL;
    def.objects = OBJECTS;
    def.threads = 2;
    def.error = &p->error;
    fp3_status status = fp3_batch_open(&def, &batch);
    for (int frame = 0; !status && frame < FRAMES; frame++) {
        for (int i = 0; i < OBJECTS; i++)
            column[i] = 1 + (float)(i % 100) / 64 + (float)frame;
        status = fp3_batch_write(batch, p->param, 0, OBJECTS, column);
        if (!status)
            status = fp3_batch_run(batch, 40);
        if (!status)
            status =
                fp3_batch_read(batch, &p->state, 1, 0, OBJECTS, (float *[]){p->column[is_shared]});
    }
    fp3_batch_close(&batch);
    return status;
}

static void *start(void *user) {
    player *p = user;
    if (play(p, 0) || play(p, 1))
        printf("%s\n", p->error.text);
    return NULL;
}

int main(int argc, char **argv) {
    static player players[2];
    pthread_t threads[2];
    fp3_error error;
    fp3_program *program = NULL;
    fp3_program_def how = fp3_program_default();
    how.compile.config = "many_full";
    if (argc != 4 || fp3_program_open(argv[1], &how, &program, NULL, &error))
        return 2;
    for (int i = 0; i < 2; i++) {
        players[i].model = argv[1];
        players[i].param = argv[2];
        players[i].state = argv[3];
        players[i].compiled = program->compiled;
        if (pthread_create(&threads[i], NULL, start, &players[i]))
            return 2;
    }
    for (int i = 0; i < 2; i++)
        pthread_join(threads[i], NULL);
    if (memcmp(players[0].column, players[1].column, sizeof players[0].column))
        printf("the threads have different numbers\n");
    if (memcmp(players[0].column[0], players[0].column[1], sizeof players[0].column[0]))
        printf("the batches have different numbers\n");
    fp3_program_close(&program);
    return 0;
}
