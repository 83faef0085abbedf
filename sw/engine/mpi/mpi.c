/* SPDX-License-Identifier: Apache-2.0 */
/* mpi.c - see fp3_mpi.h. */
#include "divide.h"
#include "plan.h"
#include "together.h"
#include "window.h"

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
    if (!all || !world->node_rank) {
        free(all);
        free(world->node_rank);
        return -1;
    }
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
    int is_begun = 0, is_ended = 0, level = 0;
    MPI_Initialized(&is_begun);
    MPI_Finalized(&is_ended);
    /* Engine fast has threads; the one that calls MPI is always the same. */
    if (is_ended ||
        (!is_begun && MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &level) != MPI_SUCCESS) ||
        (!is_begun && level < MPI_THREAD_FUNNELED))
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

static unsigned beside(const fp3_mpi *world) {
    int count;
    MPI_Comm_size(world->node, &count);
    return (unsigned)count;
}

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

__attribute__((visibility("default"))) const fp3_mpi_ops fp3_mpi_calls = {
    .version = FP3_MPI_VERSION,
    .size = sizeof(fp3_mpi_ops),
    .open = open_world,
    .rank = rank_of,
    .ranks = ranks_of,
    .beside = beside,
    .close = close_world,
    .abort = abort_world,
    .gather = fp3_mpi_gather,
    .most = fp3_mpi_most,
    .add = fp3_mpi_add,
    .plan = fp3_mpi_plan_make,
    .begin = fp3_mpi_plan_begin,
    .end = fp3_mpi_plan_end,
    .forget = fp3_mpi_plan_forget,
    .divide = fp3_mpi_divide,
};
