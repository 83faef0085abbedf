/* mpi.c - see fp3_mpi.h. */
#include "fp3_mpi.h"

#include <mpi.h>
#include <scotch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PATIENCE 1000 /* milliseconds that a failure waits for the others: all may have it */
#define UNEVEN 0.02   /* how much more than its share a part may weigh */
#define TAG 1

struct fp3_mpi {
    int rank, ranks;
};

struct fp3_mpi_plan {
    MPI_Request *requests;
    int count;
};

/* ---- begin and end ---- */

static fp3_mpi *open_world(void) {
    int is_begun = 0, is_ended = 0;
    MPI_Initialized(&is_begun);
    MPI_Finalized(&is_ended);
    if (is_ended || (!is_begun && MPI_Init(NULL, NULL) != MPI_SUCCESS))
        return NULL;
    fp3_mpi *world = malloc(sizeof *world);
    if (!world)
        return NULL;
    MPI_Comm_rank(MPI_COMM_WORLD, &world->rank);
    MPI_Comm_size(MPI_COMM_WORLD, &world->ranks);
    return world;
}

static unsigned rank_of(const fp3_mpi *world) { return (unsigned)world->rank; }
static unsigned ranks_of(const fp3_mpi *world) { return (unsigned)world->ranks; }

static unsigned beside(const fp3_mpi *world) {
    MPI_Comm node;
    int count;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, world->rank, MPI_INFO_NULL, &node);
    MPI_Comm_size(node, &count);
    MPI_Comm_free(&node);
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

static uint64_t most_of(fp3_mpi *world, uint64_t own) {
    (void)world;
    uint64_t most;
    MPI_Allreduce(&own, &most, 1, MPI_UINT64_T, MPI_MAX, MPI_COMM_WORLD);
    return most;
}

static void add(fp3_mpi *world, uint64_t *sums, unsigned count) {
    (void)world;
    MPI_Allreduce(MPI_IN_PLACE, sums, (int)count, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
}

/* ---- again and again ---- */

static void forget(fp3_mpi_plan *plan) {
    if (!plan)
        return;
    for (int i = 0; i < plan->count; i++)
        MPI_Request_free(&plan->requests[i]);
    free(plan->requests);
    free(plan);
}

static fp3_mpi_plan *make_plan(fp3_mpi *world, const uint32_t *send, const uint32_t *receive,
                               uint32_t *out, uint32_t *in) {
    fp3_mpi_plan *plan = calloc(1, sizeof *plan);
    if (plan)
        plan->requests = calloc(2 * (size_t)world->ranks, sizeof *plan->requests);
    if (!plan || !plan->requests) {
        free(plan);
        return NULL;
    }
    for (int r = 0; r < world->ranks; in += receive[r], r++)
        if (receive[r])
            MPI_Recv_init(in, (int)receive[r], MPI_UINT32_T, r, TAG, MPI_COMM_WORLD,
                          &plan->requests[plan->count++]);
    for (int r = 0; r < world->ranks; out += send[r], r++)
        if (send[r])
            MPI_Send_init(out, (int)send[r], MPI_UINT32_T, r, TAG, MPI_COMM_WORLD,
                          &plan->requests[plan->count++]);
    return plan;
}

static void begin(fp3_mpi_plan *plan) {
    if (plan->count)
        MPI_Startall(plan->count, plan->requests);
}

static void end(fp3_mpi_plan *plan) {
    if (plan->count)
        MPI_Waitall(plan->count, plan->requests, MPI_STATUSES_IGNORE);
}

/* ---- who gets what ---- */

static int scotch(const fp3_mpi_graph *g, SCOTCH_Num parts, SCOTCH_Num *whose) {
    const size_t entries = g->begin[g->count];
    SCOTCH_Num *begin = malloc((g->count + (size_t)1) * sizeof *begin),
               *other = malloc((entries + 1) * sizeof *other),
               *weight = malloc((g->count + (size_t)1) * sizeof *weight);
    SCOTCH_Graph graph;
    SCOTCH_Strat strategy;
    int status = !begin || !other || !weight;
    for (size_t i = 0; !status && i <= g->count; i++)
        begin[i] = (SCOTCH_Num)g->begin[i];
    for (size_t i = 0; !status && i < entries; i++)
        other[i] = (SCOTCH_Num)g->other[i];
    for (size_t i = 0; !status && i < g->count; i++)
        weight[i] = (SCOTCH_Num)g->weight[i];
    SCOTCH_randomReset();
    if (!status)
        status = SCOTCH_graphInit(&graph) || SCOTCH_stratInit(&strategy) ||
                 SCOTCH_stratGraphMapBuild(&strategy, SCOTCH_STRATSPEED, parts, UNEVEN) ||
                 SCOTCH_graphBuild(&graph, 0, (SCOTCH_Num)g->count, begin, NULL, weight, NULL,
                                   (SCOTCH_Num)entries, other, NULL) ||
                 SCOTCH_graphPart(&graph, parts, &strategy, whose);
    if (begin && other && weight) {
        SCOTCH_graphExit(&graph);
        SCOTCH_stratExit(&strategy);
    }
    free(begin);
    free(other);
    free(weight);
    return status ? -1 : 0;
}

/* One process divides, and tells the others. */
static int divide(fp3_mpi *world, const fp3_mpi_graph *graph, uint32_t *whose) {
    SCOTCH_Num *of = malloc((graph->count + (size_t)1) * sizeof *of);
    int status = !of ? -1 : world->rank == 0 ? scotch(graph, world->ranks, of) : 0;
    for (uint32_t i = 0; !status && world->rank == 0 && i < graph->count; i++)
        whose[i] = (uint32_t)of[i];
    free(of);
    status = most_of(world, status != 0) ? -1 : 0;
    if (!status)
        MPI_Bcast(whose, (int)graph->count, MPI_UINT32_T, 0, MPI_COMM_WORLD);
    return status;
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
    .gather = gather,
    .most = most_of,
    .add = add,
    .plan = make_plan,
    .begin = begin,
    .end = end,
    .forget = forget,
    .divide = divide,
};
