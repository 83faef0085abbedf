/* mpi.c - see fp3_mpi.h. */
#include "world.h"

#include <mpi.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PATIENCE 1000 /* milliseconds that a failure waits for the others: all may have it */

/* ---- begin and end ---- */

static int find_node(fp3_mpi *world) {
    int *all = malloc((size_t)world->ranks * sizeof *all);
    MPI_Group every, near;
    world->node_rank = malloc((size_t)world->ranks * sizeof *world->node_rank);
    if (!all || !world->node_rank)
        return -1;
    for (int r = 0; r < world->ranks; r++)
        all[r] = r;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &world->node);
    MPI_Comm_group(MPI_COMM_WORLD, &every);
    MPI_Comm_group(world->node, &near);
    MPI_Group_translate_ranks(every, world->ranks, all, near, world->node_rank);
    MPI_Group_free(&every);
    MPI_Group_free(&near);
    free(all);
    return 0;
}

static fp3_mpi *open_world(void) {
    int is_begun = 0, is_ended = 0;
    MPI_Initialized(&is_begun);
    MPI_Finalized(&is_ended);
    if (is_ended || (!is_begun && MPI_Init(NULL, NULL) != MPI_SUCCESS))
        return NULL;
    fp3_mpi *world = calloc(1, sizeof *world);
    if (!world)
        return NULL;
    MPI_Comm_rank(MPI_COMM_WORLD, &world->rank);
    MPI_Comm_size(MPI_COMM_WORLD, &world->ranks);
    if (find_node(world)) {
        free(world);
        return NULL;
    }
    return world;
}

static unsigned rank_of(const fp3_mpi *world) { return (unsigned)world->rank; }
static unsigned ranks_of(const fp3_mpi *world) { return (unsigned)world->ranks; }

static int close_world(fp3_mpi *world, int has_failed) {
    const struct timespec pause = {0, 1000000};
    MPI_Request request;
    int have_come = 0;
    MPI_Ibarrier(MPI_COMM_WORLD, &request);
    if (!has_failed)
        MPI_Wait(&request, MPI_STATUS_IGNORE);
    for (int i = 0; has_failed && !have_come && i < PATIENCE; i++) {
        MPI_Test(&request, &have_come, MPI_STATUS_IGNORE);
        if (!have_come)
            nanosleep(&pause, NULL);
    }
    if (has_failed && !have_come)
        return -1;
    fp3_mpi_windows_free(world);
    MPI_Comm_free(&world->node);
    free(world->node_rank);
    free(world);
    MPI_Finalize();
    return 0;
}

static void abort_world(fp3_mpi *world, int exit_code) {
    (void)world;
    MPI_Abort(MPI_COMM_WORLD, exit_code);
}

/* ---- all together ---- */

/* Too much for one call of MPI is sent in pieces of each rank's share: its counts are ints. */
#define PIECE ((uint64_t)1 << 26)

static void gather(fp3_mpi *world, const void *own, const uint64_t *bytes, void *all) {
    const int ranks = world->ranks;
    uint64_t most = 0, *begin = malloc((size_t)ranks * sizeof *begin);
    int *counts = malloc((size_t)ranks * sizeof *counts),
        *places = malloc((size_t)ranks * sizeof *places);
    uint64_t sum = 0;
    if (!begin || !counts || !places)
        MPI_Abort(MPI_COMM_WORLD, 1);
    for (int r = 0; r < ranks; r++) {
        begin[r] = sum;
        sum += bytes[r];
        most = bytes[r] > most ? bytes[r] : most;
    }
    if (sum <= INT32_MAX) {
        for (int r = 0; r < ranks; r++) {
            counts[r] = (int)bytes[r];
            places[r] = (int)begin[r];
        }
        MPI_Allgatherv(own, counts[world->rank], MPI_BYTE, all, counts, places, MPI_BYTE,
                       MPI_COMM_WORLD);
    } else {
        for (int r = 0; r < ranks; r++) {
            char *to = (char *)all + begin[r];
            if (r == world->rank)
                memcpy(to, own, bytes[r]);
            for (uint64_t at = 0; at < bytes[r]; at += PIECE)
                MPI_Bcast(to + at, (int)(bytes[r] - at < PIECE ? bytes[r] - at : PIECE), MPI_BYTE,
                          r, MPI_COMM_WORLD);
        }
    }
    free(begin);
    free(counts);
    free(places);
}

uint64_t fp3_mpi_most(fp3_mpi *world, uint64_t own) {
    (void)world;
    uint64_t most;
    MPI_Allreduce(&own, &most, 1, MPI_UINT64_T, MPI_MAX, MPI_COMM_WORLD);
    return most;
}

static void add(fp3_mpi *world, uint64_t *sums, unsigned count) {
    (void)world;
    MPI_Allreduce(MPI_IN_PLACE, sums, (int)count, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
}

__attribute__((visibility("default"))) const fp3_mpi_ops fp3_mpi_calls = {
    .version = FP3_MPI_VERSION,
    .size = sizeof(fp3_mpi_ops),
    .open = open_world,
    .rank = rank_of,
    .ranks = ranks_of,
    .close = close_world,
    .abort = abort_world,
    .gather = gather,
    .most = fp3_mpi_most,
    .add = add,
    .plan = fp3_mpi_plan_make,
    .begin = fp3_mpi_plan_begin,
    .end = fp3_mpi_plan_end,
    .forget = fp3_mpi_plan_forget,
    .divide = fp3_mpi_divide,
};
