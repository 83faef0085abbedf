/* SPDX-License-Identifier: Apache-2.0 */
/* plan.c - an exchange that is made again and again: through memory with ranks of the node, by
 * messages with the others.
 *
 * In memory, each rank has two places for the words of each peer, by turns, and a number: the turn
 * whose words are there. A sender may write those of turn t as soon as its peer has copied those of
 * turn t - 2. It knows that, because it has the peer's number t - 1, and a peer writes that after
 * it has ended turn t - 2. So every peer writes its number, also one that has no words to send.
 */
#include "plan.h"

#include "together.h"
#include "window.h"

#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define TAG 1
#define LINE 64   /* bytes: a number has a line of the cache for itself */
#define SPINS 200 /* before another process gets the processor */

/* A rank with which words are exchanged through memory. */
typedef struct {
    int rank;
    const uint32_t *out;
    uint32_t *in;
    size_t send, receive; /* bytes */
    uint64_t to, from;    /* the first of two places: in the peer's memory, in the own one */
    char *memory;         /* the peer's */
} peer;

struct fp3_mpi_plan {
    fp3_mpi *world;
    MPI_Request *requests;
    MPI_Status *statuses; /* unread: MPICH's MPI_STATUSES_IGNORE makes GCC 12 warn */
    int count;
    peer *peers;
    int peer_count;
    fp3_window *window;
    uint64_t turn;
};

static uint64_t whole_lines(uint64_t bytes) { return (bytes + LINE - 1) / LINE * LINE; }

/* ---- make and forget ---- */

void fp3_mpi_plan_forget(fp3_mpi_plan *plan) {
    if (!plan)
        return;
    for (int i = 0; i < plan->count; i++)
        MPI_Request_free(&plan->requests[i]);
    if (plan->window)
        plan->window->is_used = 0;
    free(plan->requests);
    free(plan->statuses);
    free(plan->peers);
    free(plan);
}

static int is_near(const fp3_mpi *world, int rank) {
    return world->node_rank[rank] != MPI_UNDEFINED;
}

/* Tells every rank where its words go. */
static int share_places(fp3_mpi_plan *plan, const uint32_t *receive) {
    fp3_mpi *world = plan->world;
    uint64_t *from = calloc(2 * (size_t)world->ranks, sizeof *from);
    if (fp3_mpi_most(world, !from)) {
        free(from);
        return -1;
    }
    uint64_t *to = from + world->ranks, bytes = (uint64_t)world->ranks * LINE;
    for (int r = 0; r < world->ranks; r++)
        if (is_near(world, r)) {
            from[r] = bytes;
            bytes += 2 * whole_lines(4 * (uint64_t)receive[r]);
        }
    plan->window = fp3_mpi_window_take(world, bytes);
    if (plan->window) {
        memset(plan->window->base, 0, (size_t)world->ranks * LINE);
        MPI_Win_sync(plan->window->win);
        MPI_Alltoall(from, 1, MPI_UINT64_T, to, 1, MPI_UINT64_T, MPI_COMM_WORLD);
        for (int i = 0; i < plan->peer_count; i++) {
            peer *p = &plan->peers[i];
            p->from = from[p->rank];
            p->to = to[p->rank];
            p->memory = fp3_mpi_window_of(world, plan->window, p->rank);
        }
    }
    free(from);
    return plan->window ? 0 : -1;
}

fp3_mpi_plan *fp3_mpi_plan_make(fp3_mpi *world, const uint32_t *send, const uint32_t *receive,
                                uint32_t *out, uint32_t *in) {
    const size_t ranks = (size_t)world->ranks;
    fp3_mpi_plan *plan = calloc(1, sizeof *plan);
    if (plan) {
        plan->world = world;
        plan->requests = calloc(2 * ranks, sizeof *plan->requests);
        plan->statuses = calloc(2 * ranks, sizeof *plan->statuses);
        plan->peers = calloc(ranks, sizeof *plan->peers);
    }
    if (!plan || !plan->requests || !plan->statuses || !plan->peers) {
        fp3_mpi_plan_forget(plan);
        return NULL;
    }
    for (int r = 0; r < world->ranks; in += receive[r], out += send[r], r++) {
        if (is_near(world, r) && (send[r] || receive[r])) {
            plan->peers[plan->peer_count++] = (peer){.rank = r,
                                                     .out = out,
                                                     .in = in,
                                                     .send = send[r] * sizeof *out,
                                                     .receive = receive[r] * sizeof *in};
            continue;
        }
        if (receive[r])
            MPI_Recv_init(in, (int)receive[r], MPI_UINT32_T, r, TAG, MPI_COMM_WORLD,
                          &plan->requests[plan->count++]);
        if (send[r])
            MPI_Send_init(out, (int)send[r], MPI_UINT32_T, r, TAG, MPI_COMM_WORLD,
                          &plan->requests[plan->count++]);
    }
    if (share_places(plan, receive)) {
        fp3_mpi_plan_forget(plan);
        return NULL;
    }
    return plan;
}

/* ---- through memory ---- */

/* The first or the second of two places. */
static uint64_t place_of(uint64_t first, size_t bytes, uint64_t turn) {
    return first + (turn & 1 ? whole_lines(bytes) : 0);
}

static void store(const fp3_mpi_plan *plan, const peer *p) {
    memcpy(p->memory + place_of(p->to, p->send, plan->turn), p->out, p->send);
    atomic_store_explicit((_Atomic uint64_t *)(p->memory + (size_t)plan->world->rank * LINE),
                          plan->turn, memory_order_release);
}

static void wait_for(const fp3_mpi_plan *plan, const peer *p) {
    const _Atomic uint64_t *turn =
        (const _Atomic uint64_t *)(plan->window->base + (size_t)p->rank * LINE);
    for (unsigned spins = 0; atomic_load_explicit(turn, memory_order_acquire) < plan->turn; spins++)
        if (spins > SPINS)
            sched_yield();
}

/* ---- begin and end ---- */

void fp3_mpi_plan_begin(fp3_mpi_plan *plan) {
    plan->turn++;
    if (plan->count)
        MPI_Startall(plan->count, plan->requests);
    for (int i = 0; i < plan->peer_count; i++)
        store(plan, &plan->peers[i]);
}

void fp3_mpi_plan_end(fp3_mpi_plan *plan) {
    for (int i = 0; i < plan->peer_count; i++) {
        const peer *p = &plan->peers[i];
        wait_for(plan, p);
        memcpy(p->in, plan->window->base + place_of(p->from, p->receive, plan->turn), p->receive);
    }
    if (plan->count)
        MPI_Waitall(plan->count, plan->requests, plan->statuses);
}
