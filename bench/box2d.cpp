// box2d.cpp - the ship as a body of Box2D: FP32, two dimensions.
#include "bodies.h"

#include <box2d/box2d.h>
#include <new>
#include <vector>

namespace {

struct world {
    b2World box{b2Vec2(0, 0)};
    std::vector<b2Body *> bodies;
};

void *make(const bench_ships *ships) try {
    world *w = new world;
    w->box.SetAutoClearForces(false); // the thrust stays
    w->box.SetAllowSleeping(false);
    for (size_t i = 0; i < ships->objects; i++) {
        b2BodyDef def;
        def.type = b2_dynamicBody;
        def.position.Set(ships->s[i], 0);
        def.linearVelocity.Set(ships->v[i], 0);
        def.linearDamping = ships->C[i] * ships->rm[i];
        b2Body *body = w->box.CreateBody(&def);
        const float mass = 1 / ships->rm[i];
        const b2MassData data = {mass, b2Vec2(0, 0), mass};
        body->SetMassData(&data);
        body->ApplyForceToCenter(b2Vec2(ships->T[i], 0), true);
        w->bodies.push_back(body);
    }
    return w;
} catch (const std::bad_alloc &) {
    return nullptr;
}

void step(void *self, const bench_ships *ships, uint64_t steps) {
    for (uint64_t n = 0; n < steps; n++)
        static_cast<world *>(self)->box.Step(ships->h, 1, 1);
}

void end(void *self, const bench_ships *ships) {
    world *w = static_cast<world *>(self);
    for (size_t i = 0; i < ships->objects; i++) {
        ships->v[i] = w->bodies[i]->GetLinearVelocity().x;
        ships->s[i] = w->bodies[i]->GetPosition().x;
    }
    delete w;
}

} // namespace

extern "C" const bench_bodies bench_box2d = {make, step, end};
