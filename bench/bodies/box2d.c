/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes of rigid bodies in a Box2D that the user has built, version 3: `make bodies BOX2D=DIR`.
 * tools/fp3bodies/by_own_box2d.py calls these functions. */
#include <box2d/box2d.h>
#include <math.h>
#include <stdlib.h>

enum { DISC, BOX, CAPSULE, POLYGON };

typedef struct {
    b2WorldId world;
    b2BodyId *bodies, origin;
    b2JointId *pins;
    int body_count, pin_count;
} lab;

lab *fp3_box2d_open(double x, double y, int most_bodies, int most_pins);
int fp3_box2d_body(lab *lab, int kind, const double *state, int is_fast);
void fp3_box2d_shape(lab *lab, int body, int shape, const double *numbers, int count,
                     const double *surface);
void fp3_box2d_mass(lab *lab, int body, double mass, double inertia);
void fp3_box2d_pin(lab *lab, int a, int b, double x, double y);
void fp3_box2d_step(lab *lab, double h, int substeps, int count);
void fp3_box2d_read(lab *lab, double *to);
void fp3_box2d_push(lab *lab, int body, double x, double y);
void fp3_box2d_pulls(lab *lab, double *to);
void fp3_box2d_close(lab *lab);

lab *fp3_box2d_open(double x, double y, int most_bodies, int most_pins) {
    lab *lab = calloc(1, sizeof *lab);
    b2WorldDef def = b2DefaultWorldDef();
    def.gravity = (b2Vec2){(float)x, (float)y};
    def.enableSleep = false;
    def.restitutionThreshold = 0;
    def.maximumLinearSpeed = 4000;
    lab->world = b2CreateWorld(&def);
    b2BodyDef held = b2DefaultBodyDef();
    lab->origin = b2CreateBody(lab->world, &held);
    lab->bodies = calloc((size_t)most_bodies + 1, sizeof *lab->bodies);
    lab->pins = calloc((size_t)most_pins + 1, sizeof *lab->pins);
    return lab;
}

/* kind: 0 held, 1 moved by the caller, 2 loose. state: x, y, angle, their speeds. */
int fp3_box2d_body(lab *lab, int kind, const double *state, int is_fast) {
    b2BodyDef def = b2DefaultBodyDef();
    def.type = (b2BodyType)kind;
    def.position = (b2Vec2){(float)state[0], (float)state[1]};
    def.rotation = b2MakeRot((float)state[2]);
    def.linearVelocity = (b2Vec2){(float)state[3], (float)state[4]};
    def.angularVelocity = (float)state[5];
    def.isBullet = is_fast;
    lab->bodies[lab->body_count] = b2CreateBody(lab->world, &def);
    return lab->body_count++;
}

/* surface: density, friction, restitution. */
void fp3_box2d_shape(lab *lab, int body, int shape, const double *numbers, int count,
                     const double *surface) {
    b2ShapeDef def = b2DefaultShapeDef();
    def.density = (float)surface[0];
    def.material.friction = (float)surface[1];
    def.material.restitution = (float)surface[2];
    if (shape == DISC) {
        b2Circle disc = {{0, 0}, (float)numbers[0]};
        b2CreateCircleShape(lab->bodies[body], &def, &disc);
    } else if (shape == CAPSULE) {
        b2Capsule capsule = {{(float)-numbers[0], 0}, {(float)numbers[0], 0}, (float)numbers[1]};
        b2CreateCapsuleShape(lab->bodies[body], &def, &capsule);
    } else if (shape == BOX) {
        b2Polygon box = b2MakeBox((float)numbers[0], (float)numbers[1]);
        b2CreatePolygonShape(lab->bodies[body], &def, &box);
    } else {
        b2Vec2 corners[B2_MAX_POLYGON_VERTICES];
        for (int k = 0; k < count / 2; k++)
            corners[k] = (b2Vec2){(float)numbers[2 * k], (float)numbers[2 * k + 1]};
        b2Hull hull = b2ComputeHull(corners, count / 2);
        b2Polygon polygon = b2MakePolygon(&hull, 0);
        b2CreatePolygonShape(lab->bodies[body], &def, &polygon);
    }
}

void fp3_box2d_mass(lab *lab, int body, double mass, double inertia) {
    b2Body_SetMassData(lab->bodies[body], (b2MassData){(float)mass, {0, 0}, (float)inertia});
}

/* -1: the world. */
void fp3_box2d_pin(lab *lab, int a, int b, double x, double y) {
    b2Vec2 at = {(float)x, (float)y};
    b2BodyId from = a < 0 ? lab->origin : lab->bodies[a];
    b2RevoluteJointDef def = b2DefaultRevoluteJointDef();
    def.base.bodyIdA = from;
    def.base.bodyIdB = lab->bodies[b];
    def.base.localFrameA.p = b2Body_GetLocalPoint(from, at);
    def.base.localFrameB.p = b2Body_GetLocalPoint(lab->bodies[b], at);
    lab->pins[lab->pin_count++] = b2CreateRevoluteJoint(lab->world, &def);
}

void fp3_box2d_step(lab *lab, double h, int substeps, int count) {
    for (int k = 0; k < count; k++)
        b2World_Step(lab->world, (float)h, substeps);
}

/* Of each body x, y, angle and their speeds. */
void fp3_box2d_read(lab *lab, double *to) {
    for (int k = 0; k < lab->body_count; k++, to += 6) {
        b2Vec2 x = b2Body_GetPosition(lab->bodies[k]), v = b2Body_GetLinearVelocity(lab->bodies[k]);
        to[0] = x.x;
        to[1] = x.y;
        to[2] = (double)b2Rot_GetAngle(b2Body_GetRotation(lab->bodies[k]));
        to[3] = v.x;
        to[4] = v.y;
        to[5] = b2Body_GetAngularVelocity(lab->bodies[k]);
    }
}

void fp3_box2d_push(lab *lab, int body, double x, double y) {
    b2Body_ApplyForceToCenter(lab->bodies[body], (b2Vec2){(float)x, (float)y}, true);
}

void fp3_box2d_pulls(lab *lab, double *to) {
    for (int k = 0; k < lab->pin_count; k++) {
        b2Vec2 force = b2Joint_GetConstraintForce(lab->pins[k]);
        to[k] = hypot(force.x, force.y);
    }
}

void fp3_box2d_close(lab *lab) {
    b2DestroyWorld(lab->world);
    free(lab->bodies);
    free(lab->pins);
    free(lab);
}
