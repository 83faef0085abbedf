/* SPDX-License-Identifier: Apache-2.0 */
/* fp3_mpi.h - what fp3_mpi.so provides: the processes of a cluster, and how objects are divided
 * among them, by MPI and Scotch.
 *
 * It is a library of its own because an MPI library opens files and devices when it is loaded:
 * linked with it, every start of the command would take that time, and a program could not be
 * linked statically any more.
 */
#ifndef FP3_MPI_H
#define FP3_MPI_H

#include <stdint.h>

#define FP3_MPI_VERSION 1u

typedef struct fp3_mpi fp3_mpi;
typedef struct fp3_mpi_plan fp3_mpi_plan;

/* Neighbours of n things, as fp3_neighbours has them, and what each thing weighs. */
typedef struct {
    uint32_t count;
    const uint32_t *begin, *other, *weight;
} fp3_mpi_graph;

/* All processes make the same calls in the same order. An error of MPI ends them all. */
typedef struct {
    uint32_t version, size;
    /* NULL: MPI does not start, or it was ended before. */
    fp3_mpi *(*open)(void);
    unsigned (*rank)(const fp3_mpi *world);
    unsigned (*ranks)(const fp3_mpi *world);
    /* How many ranks share this one's memory and processors. */
    unsigned (*beside)(const fp3_mpi *world);
    /* Waits for the others; after a failure for a second. 0: all have come, and MPI has ended; -1:
     * some have not. */
    int (*close)(fp3_mpi *world, int has_failed);
    /* Ends all processes; does not return. */
    void (*abort)(fp3_mpi *world, int exit_code);
    /* What each process has, bytes[r] of rank r, side by side in `all`. */
    void (*gather)(fp3_mpi *world, const void *own, const uint64_t *bytes, void *all);
    /* The largest of what each process has; their sums, in place. */
    uint64_t (*most)(fp3_mpi *world, uint64_t own);
    void (*add)(fp3_mpi *world, uint64_t *sums, unsigned count);
    /* An exchange that is made again and again: send[r] words to rank r and receive[r] from it,
     * side by side in `out` and `in`, which stay where they are. NULL: out of memory. */
    fp3_mpi_plan *(*plan)(fp3_mpi *world, const uint32_t *send, const uint32_t *receive,
                          uint32_t *out, uint32_t *in);
    void (*begin)(fp3_mpi_plan *plan);
    void (*end)(fp3_mpi_plan *plan);
    void (*forget)(fp3_mpi_plan *plan); /* NULL does no harm */
    /* Divides the things of a graph among all ranks, so that each weighs about the same and few
     * neighbours are divided: the same for all. Rank 0 has the graph, the others its count. -1, for
     * all: out of memory, more than 2^31 neighbours, or rank 0 has NULL. */
    int (*divide)(fp3_mpi *world, const fp3_mpi_graph *graph, uint32_t *whose);
} fp3_mpi_ops;

#endif
