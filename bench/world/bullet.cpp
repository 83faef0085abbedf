// bullet.cpp - build/bench/bullet: a net of masses by Bullet's soft bodies, in float32;
// tools/fp3world/peers.py runs it.
//
//     bullet springs|threads COLUMNS ROWS BEFORE STEPS REPEATS
//
// springs: the deformable world, which adds up the forces of springs and then steps as
// programs/world/net.scene does. threads: the soft world, which moves the ends of each thread once
// in a step, so that it is as long as it was. Prints where the masses are after BEFORE steps and in
// the end, and the seconds of a step: the shortest of REPEATS turns.
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <algorithm>
#include <btBulletDynamicsCommon.h>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>

namespace {

// Of programs/world/net.scene.
const btScalar spacing = 0.0078125f, mass = 1.220703125e-5f, step = 0.000244140625f, stiff = 60,
               bending = 6;
const btVector3 gravity(0, -9.81f, 0);

// What both worlds need; it outlives them.
struct parts {
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btDeformableBodySolver soft;
    btDeformableMultiBodyConstraintSolver deformable;
    btSequentialImpulseConstraintSolver rigid;
};

int is_bending(int to, int across) { return to == 2 || across == 2; }

std::unique_ptr<btSoftBody> make_net(btSoftBodyWorldInfo *info, int columns, int rows) {
    static const int ways[][2] = {{1, 0}, {2, 0}, {-1, 1}, {0, 1}, {1, 1}, {0, 2}};
    btAlignedObjectArray<btVector3> x;
    btAlignedObjectArray<btScalar> m;
    for (int k = 0; k < columns * rows; k++) {
        x.push_back(btVector3(spacing * btScalar(k % columns), 1, spacing * btScalar(k / columns)));
        m.push_back(k < columns ? 0 : mass); // 0: held
    }
    std::unique_ptr<btSoftBody> net(new btSoftBody(info, columns * rows, &x[0], &m[0]));
    net->m_materials[0]->m_kLST = 1;
    net->m_cfg.collisions = 0;
    net->m_cfg.piterations = 1;
    net->setCollisionFlags(0);
    net->setActivationState(DISABLE_DEACTIVATION);
    for (int k = 0; k < columns * rows; k++)
        for (const auto &way : ways) {
            const int i = k % columns + way[0], j = k / columns + way[1];
            if (i < 0 || i >= columns || j >= rows)
                continue;
            net->appendLink(k, i + columns * j);
            net->m_links[net->m_links.size() - 1].m_bbending = is_bending(way[0], way[1]);
        }
    return net;
}

double seconds() {
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

void run(btDynamicsWorld *world, int steps) {
    for (int n = 0; n < steps; n++)
        world->stepSimulation(step, 0);
}

struct turns {
    int columns, rows, before, steps, repeats;
};

void print(const btSoftBody *net) {
    for (int k = 0; k < net->m_nodes.size(); k++)
        for (int axis = 0; axis < 3; axis++)
            std::printf("%.9g\n", double(net->m_nodes[k].m_x[axis]));
}

void measure(btDynamicsWorld *world, const btSoftBody *net, const turns &t) {
    run(world, t.before);
    print(net);
    double shortest = 1e30;
    for (int n = 0; n < t.repeats; n++) {
        const double begin = seconds();
        run(world, t.steps);
        shortest = std::min(shortest, (seconds() - begin) / t.steps);
    }
    print(net);
    std::printf("%.9g\n", shortest);
}

void prepare(btSoftBodyWorldInfo *info, parts *p) {
    info->m_gravity = gravity;
    info->m_dispatcher = &p->dispatcher;
    info->m_broadphase = &p->broadphase;
    info->air_density = 0;
    info->m_sparsesdf.Initialize();
}

void with_threads(parts *p, const turns &t) {
    btSoftRigidDynamicsWorld world(&p->dispatcher, &p->broadphase, &p->rigid, &p->configuration);
    world.setGravity(gravity);
    prepare(&world.getWorldInfo(), p);
    std::unique_ptr<btSoftBody> net = make_net(&world.getWorldInfo(), t.columns, t.rows);
    net->randomizeConstraints(); // in the order of the grid the net bursts within 100 steps
    world.addSoftBody(net.get());
    measure(&world, net.get(), t);
    world.removeSoftBody(net.get());
}

void with_springs(parts *p, const turns &t) {
    p->deformable.setDeformableSolver(&p->soft);
    btDeformableMultiBodyDynamicsWorld world(&p->dispatcher, &p->broadphase, &p->deformable,
                                             &p->configuration, &p->soft);
    world.setGravity(gravity);
    world.setImplicit(false);
    world.setLineSearch(false);
    prepare(&world.getWorldInfo(), p);
    std::unique_ptr<btSoftBody> net = make_net(&world.getWorldInfo(), t.columns, t.rows);
    btDeformableMassSpringForce springs(stiff, 0, false, bending);
    btDeformableGravityForce pull(gravity);
    world.addSoftBody(net.get());
    world.addForce(net.get(), &springs);
    world.addForce(net.get(), &pull);
    measure(&world, net.get(), t);
    world.removeSoftBody(net.get());
}

bool number(const char *text, int *found) {
    char *end;
    const long value = std::strtol(text, &end, 10);
    *found = int(value);
    return !*end && value > 0 && value <= 10000;
}

} // namespace

int main(int argc, char **argv) {
    turns t = {};
    int *const numbers[] = {&t.columns, &t.rows, &t.before, &t.steps, &t.repeats};
    bool is_right =
        argc == 7 && (!std::strcmp(argv[1], "springs") || !std::strcmp(argv[1], "threads"));
    for (int i = 0; is_right && i < 5; i++)
        is_right = number(argv[i + 2], numbers[i]);
    if (!is_right) {
        std::fprintf(stderr, "usage: bullet springs|threads COLUMNS ROWS BEFORE STEPS REPEATS, "
                             "each number from 1 to 10000\n");
        return 2;
    }
    parts p;
    if (!std::strcmp(argv[1], "springs"))
        with_springs(&p, t);
    else
        with_threads(&p, t);
    return std::fflush(stdout) || std::ferror(stdout);
}
