// tower.cpp - a ball knocks a tower down: fp3/bodies.h in C++17, which closes what it opened.
//     c++ -std=c++17 tower.cpp $(pkg-config --cflags --libs fp3) -o tower
#include <array>
#include <cstdio>
#include <fp3/bodies.h>
#include <memory>
#include <stdexcept>
#include <vector>

class World {
  public:
    explicit World(double gravity) : error(std::make_unique<fp3_error>()) {
        fp3_bodies_def def = fp3_bodies_default();
        fp3_bodies *opened = nullptr;
        def.gravity[1] = -gravity;
        def.error = error.get(); // on the heap, so that a World may move
        check(fp3_bodies_open(&def, &opened));
        bodies.reset(opened);
    }

    std::uint64_t add(const fp3_body_def &def, const fp3_shape_def &shape) {
        std::uint64_t handle = 0;
        check(fp3_bodies_add(bodies.get(), &def, 1, &handle));
        check(fp3_bodies_attach(bodies.get(), &handle, 1, &shape, nullptr));
        return handle;
    }

    void step(std::uint64_t count = 1) { check(fp3_bodies_step(bodies.get(), count)); }

    std::array<double, 2> place(std::uint64_t handle) const {
        std::array<double, 2> x{};
        check(fp3_bodies_read(bodies.get(), "x", &handle, 1, x.data()));
        return x;
    }

    // Contacts that began fast in the last call of step; a copy.
    std::vector<fp3_contact> hits() const {
        const fp3_contact *first = nullptr;
        std::size_t count = 0;
        check(fp3_bodies_changes(bodies.get(), FP3_CONTACT_HIT, &first, &count));
        return {first, first + count};
    }

  private:
    struct Close {
        void operator()(fp3_bodies *opened) const { fp3_bodies_close(&opened); }
    };
    void check(fp3_status status) const {
        if (status != FP3_OK)
            throw std::runtime_error(error->text);
    }
    std::unique_ptr<fp3_error> error; // outlives the bodies: members end in the reverse order
    std::unique_ptr<fp3_bodies, Close> bodies;
};

int main() try {
    World world(10);
    fp3_body_def ground = fp3_body_default(), box = ground, ball = ground;
    ground.type = FP3_STATIC;
    ground.x[1] = -1;
    ball.x[0] = -8, ball.x[1] = 4, ball.v[0] = 20;
    ball.is_fast = 1;
    world.add(ground, fp3_shape_box(50, 1, 0));
    std::vector<std::uint64_t> tower;
    for (int row = 0; row < 8; row++) {
        box.x[1] = row + 0.5;
        tower.push_back(world.add(box, fp3_shape_box(0.5, 0.5, 0)));
    }
    const std::uint64_t thrown = world.add(ball, fp3_shape_circle(0.4));
    std::size_t hits = 0;
    for (int frame = 0; frame < 240; frame++) {
        world.step();
        for (const fp3_contact &hit : world.hits())
            hits += hit.body_a == thrown || hit.body_b == thrown;
    }
    std::size_t stand = 0;
    double middle = 0.5; // of a box that is where it was
    for (const std::uint64_t handle : tower)
        stand += world.place(handle)[1] > middle++ - 0.1;
    std::printf("%zu hits by the ball, and %zu of %zu boxes stand\n", hits, stand, tower.size());
    try {
        world.place(12345);
    } catch (const std::runtime_error &why) {
        std::printf("refused: %s\n", why.what());
    }
} catch (const std::exception &why) {
    std::fprintf(stderr, "%s\n", why.what());
    return 1;
}
