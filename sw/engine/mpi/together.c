/* SPDX-License-Identifier: Apache-2.0 */
/* together.c - see together.h. */
#include "together.h"

#include <stdlib.h>
#include <string.h>

/* Too much for one call of MPI is sent in pieces of each rank's share: its counts are ints. */
#define PIECE ((uint64_t)1 << 26)

void fp3_mpi_gather(fp3_mpi *world, const void *own, const uint64_t *bytes, void *all) {
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

void fp3_mpi_add(fp3_mpi *world, uint64_t *sums, unsigned count) {
    (void)world;
    MPI_Allreduce(MPI_IN_PLACE, sums, (int)count, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
}
