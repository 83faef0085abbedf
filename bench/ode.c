/* ode.c - the ship as a body of the Open Dynamics Engine: three dimensions, in its dReal. It
 * forgets forces after each step. */
#include "bodies.h"

#include <ode/ode.h>
#include <stdlib.h>

typedef struct {
    dWorldID ode;
    dBodyID *bodies;
} world;

static void *make(const bench_ships *ships) {
    world *w = calloc(1, sizeof *w);
    if (!w || !(w->bodies = calloc(ships->objects + 1, sizeof(dBodyID)))) {
        free(w);
        return NULL;
    }
    dInitODE2(0);
    w->ode = dWorldCreate();
    dWorldSetLinearDamping(w->ode, (dReal)(ships->h * ships->C[0] * ships->rm[0]));
    dWorldSetLinearDampingThreshold(w->ode, 0);
    for (size_t i = 0; i < ships->objects; i++) {
        dMass mass;
        dMassSetSphereTotal(&mass, (dReal)(1 / ships->rm[i]), 1);
        w->bodies[i] = dBodyCreate(w->ode);
        dBodySetMass(w->bodies[i], &mass);
        dBodySetPosition(w->bodies[i], (dReal)ships->s[i], 0, 0);
        dBodySetLinearVel(w->bodies[i], (dReal)ships->v[i], 0, 0);
    }
    return w;
}

static void step(void *self, const bench_ships *ships, uint64_t steps) {
    const world *w = self;
    for (uint64_t n = 0; n < steps; n++) {
        for (size_t i = 0; i < ships->objects; i++)
            dBodyAddForce(w->bodies[i], (dReal)ships->T[i], 0, 0);
        dWorldQuickStep(w->ode, (dReal)ships->h);
    }
}

static void end(void *self, const bench_ships *ships) {
    world *w = self;
    for (size_t i = 0; i < ships->objects; i++) {
        ships->v[i] = (float)dBodyGetLinearVel(w->bodies[i])[0];
        ships->s[i] = (float)dBodyGetPosition(w->bodies[i])[0];
    }
    dWorldDestroy(w->ode);
    dCloseODE();
    free(w->bodies);
    free(w);
}

const bench_bodies bench_ode = {make, step, end};
