/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes of rigid bodies in a Box3D that the user has built: `make bodies BOX3D=DIR`.
 * tools/fp3bodies/by_box3d.py calls these functions. */
#include <box3d/box3d.h>
#include <math.h>
#include <stdlib.h>

enum { BALL, BOX, CAPSULE, HULL };

typedef struct {
    b3WorldId world;
    b3BodyId *bodies, origin;
    b3JointId *pins;
    int body_count, pin_count;
} lab;

lab *fp3_box3d_open(const double *gravity, int most_bodies, int most_pins);
int fp3_box3d_body(lab *lab, int kind, const double *state, int is_fast);
void fp3_box3d_shape(lab *lab, int body, int shape, const double *numbers, int count,
                     const double *surface);
void fp3_box3d_mass(lab *lab, int body, double mass, const double *inertia);
void fp3_box3d_pin(lab *lab, int a, int b, const double *at, int is_hinge);
void fp3_box3d_step(lab *lab, double h, int substeps, int count);
void fp3_box3d_read(lab *lab, double *to);
void fp3_box3d_push(lab *lab, int body, const double *force);
void fp3_box3d_pulls(lab *lab, double *to);
void fp3_box3d_close(lab *lab);

static b3Vec3 vector(const double *x) { return (b3Vec3){(float)x[0], (float)x[1], (float)x[2]}; }

static void put(double *to, b3Vec3 x) {
    to[0] = x.x;
    to[1] = x.y;
    to[2] = x.z;
}

lab *fp3_box3d_open(const double *gravity, int most_bodies, int most_pins) {
    lab *lab = calloc(1, sizeof *lab);
    b3WorldDef def = b3DefaultWorldDef();
    def.gravity = vector(gravity);
    def.enableSleep = false;
    def.restitutionThreshold = 0;
    def.maximumLinearSpeed = 4000;
    lab->world = b3CreateWorld(&def);
    b3BodyDef held = b3DefaultBodyDef();
    lab->origin = b3CreateBody(lab->world, &held);
    lab->bodies = calloc((size_t)most_bodies + 1, sizeof *lab->bodies);
    lab->pins = calloc((size_t)most_pins + 1, sizeof *lab->pins);
    return lab;
}

/* kind: 0 held, 1 moved by the caller, 2 loose. state: place, turn (w, x, y, z), speed, spin. */
int fp3_box3d_body(lab *lab, int kind, const double *state, int is_fast) {
    b3BodyDef def = b3DefaultBodyDef();
    def.type = (b3BodyType)kind;
    def.position = vector(state);
    def.rotation = (b3Quat){vector(state + 4), (float)state[3]};
    def.linearVelocity = vector(state + 7);
    def.angularVelocity = vector(state + 10);
    def.isBullet = is_fast;
    def.allowFastRotation = true;
    lab->bodies[lab->body_count] = b3CreateBody(lab->world, &def);
    return lab->body_count++;
}

/* surface: density, friction, restitution. */
void fp3_box3d_shape(lab *lab, int body, int shape, const double *numbers, int count,
                     const double *surface) {
    b3ShapeDef def = b3DefaultShapeDef();
    def.density = (float)surface[0];
    def.baseMaterial.friction = (float)surface[1];
    def.baseMaterial.restitution = (float)surface[2];
    if (shape == BALL) {
        b3Sphere ball = {{0, 0, 0}, (float)numbers[0]};
        b3CreateSphereShape(lab->bodies[body], &def, &ball);
    } else if (shape == CAPSULE) {
        b3Capsule capsule = {
            {(float)-numbers[0], 0, 0}, {(float)numbers[0], 0, 0}, (float)numbers[1]};
        b3CreateCapsuleShape(lab->bodies[body], &def, &capsule);
    } else if (shape == BOX) {
        b3BoxHull box = b3MakeBoxHull((float)numbers[0], (float)numbers[1], (float)numbers[2]);
        b3CreateHullShape(lab->bodies[body], &def, &box.base);
    } else {
        b3Vec3 corners[32];
        int corner_count = count / 3 < 32 ? count / 3 : 32;
        for (int k = 0; k < corner_count; k++)
            corners[k] = vector(numbers + 3 * k);
        b3HullData *hull = b3CreateHull(corners, corner_count, corner_count);
        b3CreateHullShape(lab->bodies[body], &def, hull);
        b3DestroyHull(hull);
    }
}

void fp3_box3d_mass(lab *lab, int body, double mass, const double *inertia) {
    b3Vec3 i = vector(inertia);
    b3Body_SetMassData(
        lab->bodies[body],
        (b3MassData){.mass = (float)mass, .inertia = {{i.x, 0, 0}, {0, i.y, 0}, {0, 0, i.z}}});
}

static b3Transform frame(b3BodyId body, b3Vec3 at) {
    const b3Quat q = b3Body_GetRotation(body);
    const b3Quat back = {{-q.v.x, -q.v.y, -q.v.z}, q.s};
    return (b3Transform){b3Body_GetLocalPoint(body, at), back};
}

/* -1: the world. A hinge turns about z. */
void fp3_box3d_pin(lab *lab, int a, int b, const double *at, int is_hinge) {
    b3BodyId from = a < 0 ? lab->origin : lab->bodies[a];
    b3RevoluteJointDef hinge = b3DefaultRevoluteJointDef();
    b3SphericalJointDef ball = b3DefaultSphericalJointDef();
    b3JointDef *def = is_hinge ? &hinge.base : &ball.base;
    def->bodyIdA = from;
    def->bodyIdB = lab->bodies[b];
    def->localFrameA = frame(from, vector(at));
    def->localFrameB = frame(lab->bodies[b], vector(at));
    lab->pins[lab->pin_count++] = is_hinge ? b3CreateRevoluteJoint(lab->world, &hinge)
                                           : b3CreateSphericalJoint(lab->world, &ball);
}

void fp3_box3d_step(lab *lab, double h, int substeps, int count) {
    for (int k = 0; k < count; k++)
        b3World_Step(lab->world, (float)h, substeps);
}

/* Of each body place, turn (w, x, y, z), speed, spin. */
void fp3_box3d_read(lab *lab, double *to) {
    for (int k = 0; k < lab->body_count; k++, to += 13) {
        const b3Quat q = b3Body_GetRotation(lab->bodies[k]);
        put(to, b3Body_GetPosition(lab->bodies[k]));
        to[3] = q.s;
        put(to + 4, q.v);
        put(to + 7, b3Body_GetLinearVelocity(lab->bodies[k]));
        put(to + 10, b3Body_GetAngularVelocity(lab->bodies[k]));
    }
}

void fp3_box3d_push(lab *lab, int body, const double *force) {
    b3Body_ApplyForceToCenter(lab->bodies[body], vector(force), true);
}

void fp3_box3d_pulls(lab *lab, double *to) {
    for (int k = 0; k < lab->pin_count; k++) {
        const b3Vec3 force = b3Joint_GetConstraintForce(lab->pins[k]);
        to[k] =
            sqrt((double)force.x * force.x + (double)force.y * force.y + (double)force.z * force.z);
    }
}

void fp3_box3d_close(lab *lab) {
    b3DestroyWorld(lab->world);
    free(lab->bodies);
    free(lab->pins);
    free(lab);
}
