/* SPDX-License-Identifier: Apache-2.0 */
/* divide.c - see divide.h: by Scotch. */
#include "divide.h"

#include "together.h"

#include <stdio.h>

#include <scotch.h>
#include <stdlib.h>

#define UNEVEN 0.02 /* how much more than its share a part may weigh */

/* Scotch adds weights in its own integers. */
#define HEAVIEST ((uint64_t)1 << 30)

static uint64_t unit_of(const fp3_mpi_graph *g) {
    uint64_t sum = 0;
    for (size_t i = 0; i < g->count; i++)
        sum += g->weight[i];
    return sum / HEAVIEST + 1;
}

static int scotch(const fp3_mpi_graph *g, SCOTCH_Num parts, SCOTCH_Num *whose) {
    const size_t entries = g->begin[g->count];
    const uint64_t unit = unit_of(g);
    SCOTCH_Num *begin = malloc((g->count + (size_t)1) * sizeof *begin),
               *other = malloc((entries + 1) * sizeof *other),
               *weight = malloc((g->count + (size_t)1) * sizeof *weight);
    int status = !begin || !other || !weight || entries > INT32_MAX;
    for (size_t i = 0; !status && i <= g->count; i++)
        begin[i] = (SCOTCH_Num)g->begin[i];
    for (size_t i = 0; !status && i < entries; i++)
        other[i] = (SCOTCH_Num)g->other[i];
    for (size_t i = 0; !status && i < g->count; i++)
        weight[i] = (SCOTCH_Num)(1 + g->weight[i] / unit);
    SCOTCH_Graph graph;
    SCOTCH_Strat strategy;
    SCOTCH_graphInit(&graph);
    SCOTCH_stratInit(&strategy);
    SCOTCH_randomReset();
    if (!status)
        status = SCOTCH_stratGraphMapBuild(&strategy, SCOTCH_STRATSPEED, parts, UNEVEN) ||
                 SCOTCH_graphBuild(&graph, 0, (SCOTCH_Num)g->count, begin, NULL, weight, NULL,
                                   (SCOTCH_Num)entries, other, NULL) ||
                 SCOTCH_graphPart(&graph, parts, &strategy, whose);
    SCOTCH_graphExit(&graph);
    SCOTCH_stratExit(&strategy);
    free(begin);
    free(other);
    free(weight);
    return status ? -1 : 0;
}

/* One process divides, and tells the others. */
int fp3_mpi_divide(fp3_mpi *world, const fp3_mpi_graph *graph, uint32_t *whose) {
    SCOTCH_Num *of =
        graph && world->rank == 0 ? malloc((graph->count + (size_t)1) * sizeof *of) : NULL;
    int status = world->rank == 0 && (!of || scotch(graph, world->ranks, of));
    for (uint32_t i = 0; of && !status && i < graph->count; i++)
        whose[i] = (uint32_t)of[i];
    free(of);
    status = fp3_mpi_most(world, status != 0) ? -1 : 0;
    if (!status)
        MPI_Bcast(whose, (int)graph->count, MPI_UINT32_T, 0, MPI_COMM_WORLD);
    return status;
}
