/* solids3 - sw/bodies/shapes/ in space, by words on a pipe.
 *
 * Standard input has commands, each a number and what it needs; standard output has the answers,
 * all as words of 32 bits (mass: doubles). tests/bodies/solids.py writes and reads them.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bodies/shapes/collide3.h"
#include "bodies/shapes/distance3.h"
#include "bodies/shapes/mass3.h"
#include "bodies/shapes/mesh3.h"
#include "bodies/shapes/query3.h"

enum {
    MAKE,
    COLLIDE,
    SHAPE,
    BOUNDS,
    MASS,
    PLANE,
    MATCH,
    DISTANCE,
    MEASURE,
    RAY,
    IMPACT,
    CAST,
    MESH,
    HEIGHTS,
    GROUND
};
enum { BALL, CAPSULE, BOX, TRIANGLE, HULL };
#define MOST 4096

static fp3_shape3 *shapes;
static fp3_mesh3 *ground;
static uint32_t count;

static void get(void *to, size_t size) {
    if (fread(to, 1, size, stdin) != size)
        exit(2);
}

static void put(const void *from, size_t size) {
    if (fwrite(from, 1, size, stdout) != size)
        exit(2);
}

static uint32_t word(void) {
    uint32_t w;
    get(&w, sizeof w);
    return w;
}

static const fp3_shape3 *shape(void) {
    const uint32_t i = word();
    if (i >= count)
        exit(2);
    return &shapes[i];
}

/* A failure is answered by its text; the shape's number is taken all the same. */
static void make(void) {
    const uint32_t kind = word(), points = word();
    float radius;
    fp3_point3 p[64];
    fp3_pose3 pose;
    fp3_error error = {.text = ""};
    get(&radius, sizeof radius);
    get(p, (points < 64 ? points : 64) * sizeof *p);
    get(&pose, sizeof pose);
    fp3_shape3 *to = &shapes[count < MOST ? count : 0];
    if (++count > MOST)
        exit(2);
    const uint32_t status = kind == BALL      ? fp3_ball3(p[0], radius, to, &error)
                            : kind == CAPSULE ? fp3_capsule3(p[0], p[1], radius, to, &error)
                            : kind == BOX
                                ? fp3_box3(p[0], pose.q[0] == 2 ? NULL : &pose, radius, to, &error)
                            : kind == TRIANGLE ? fp3_triangle3(p, radius, to, &error)
                                               : fp3_hull3(points, p, radius, to, &error);
    put(&status, sizeof status);
    put(error.text, 128);
}

static void collide(void) {
    const fp3_shape3 *a = shape(), *b = shape();
    fp3_pose3 pose[2];
    float reach;
    fp3_manifold3 m;
    memset(&m, 0, sizeof m);
    get(pose, sizeof pose);
    get(&reach, sizeof reach);
    fp3_collide3(a, &pose[0], b, &pose[1], reach, &m);
    put(&m, sizeof m);
}

static void plane(void) {
    fp3_plane3 a;
    get(&a, sizeof a);
    const fp3_shape3 *b = shape();
    fp3_pose3 pose[2];
    float reach;
    fp3_manifold3 m;
    memset(&m, 0, sizeof m);
    get(pose, sizeof pose);
    get(&reach, sizeof reach);
    fp3_collide_plane3(&a, &pose[0], b, &pose[1], reach, &m);
    put(&m, sizeof m);
}

static void bounds(void) {
    const fp3_shape3 *a = shape();
    fp3_pose3 pose;
    float margin;
    get(&pose, sizeof pose);
    get(&margin, sizeof margin);
    const fp3_bounds3 box = fp3_bound3(a, &pose, margin);
    put(&box, sizeof box);
}

static void mass(void) {
    fp3_mass3 part[16], sum;
    double answer[17];
    const uint32_t parts = word();
    for (uint32_t i = 0; i < parts; i++) {
        const fp3_shape3 *s = shape();
        float density;
        get(&density, sizeof density);
        part[i % 16] = fp3_weigh3(s, (double)density);
    }
    sum = fp3_weigh_together3(part, parts);
    memcpy(answer, &sum, sizeof sum);
    fp3_axes_of_mass3(&sum, answer + 10, answer + 13);
    put(answer, sizeof answer);
}

static void match(void) {
    fp3_manifold3 m[2];
    float near;
    uint8_t from[4];
    get(m, sizeof m);
    get(&near, sizeof near);
    fp3_match_manifold3(&m[0], &m[1], near, from);
    put(from, sizeof from);
}

static void distance(void) {
    const fp3_shape3 *a = shape(), *b = shape();
    fp3_pose3 pose[2];
    fp3_closest3 c;
    get(pose, sizeof pose);
    const fp3_turn3 of_a = fp3_turn_of3(pose[0].q), of_b = fp3_between3(&pose[0], &of_a, &pose[1]);
    fp3_distance3(a, b, &of_b, &c);
    put(&c, sizeof c);
}

static void measure(void) {
    const fp3_shape3 *a = shape(), *b = shape();
    fp3_pose3 pose[2];
    struct {
        uint32_t is, overlap;
        fp3_apart3 apart;
    } answer;
    memset(&answer, 0, sizeof answer);
    get(pose, sizeof pose);
    answer.is = (uint32_t)fp3_separation3(a, &pose[0], b, &pose[1], &answer.apart);
    answer.overlap = (uint32_t)fp3_overlap3(a, &pose[0], b, &pose[1]);
    put(&answer, sizeof answer);
}

static void first_hit(uint32_t command) {
    const fp3_shape3 *a = shape(), *b = command == RAY ? a : shape();
    fp3_sweep3 sweep[2];
    fp3_pose3 pose[2];
    fp3_point3 ray[2];
    float slop;
    struct {
        uint32_t is;
        fp3_hit3 hit;
    } answer;
    memset(&answer, 0, sizeof answer);
    if (command == IMPACT) {
        get(sweep, sizeof sweep);
        get(&slop, sizeof slop);
        answer.is = (uint32_t)fp3_impact3(a, &sweep[0], b, &sweep[1], slop, &answer.hit);
    } else if (command == CAST) {
        get(pose, sizeof pose);
        get(ray, sizeof *ray);
        get(&slop, sizeof slop);
        answer.is = (uint32_t)fp3_cast3(a, &pose[0], b, &pose[1], ray[0], slop, &answer.hit);
    } else {
        get(pose, sizeof *pose);
        get(ray, sizeof ray);
        answer.is = (uint32_t)fp3_ray3(a, &pose[0], ray[0], ray[1], &answer.hit);
    }
    put(&answer, sizeof answer);
}

static void *get_more(size_t size) {
    void *to = malloc(size + 1);
    if (!to)
        exit(1);
    get(to, size);
    return to;
}

static void mesh(uint32_t command) {
    const uint32_t first = word(), second = word();
    fp3_error error = {.text = ""};
    float step[2];
    uint32_t status;
    fp3_free_mesh3(&ground);
    if (command == HEIGHTS) {
        get(step, sizeof step);
        float *height = get_more(sizeof(float) * first * second);
        status = fp3_make_heights3(first, second, step[0], step[1], height, &ground, &error);
        free(height);
    } else {
        fp3_point3 *point = get_more(sizeof *point * first);
        uint32_t(*corner)[3] = get_more(sizeof *corner * second);
        status =
            fp3_make_mesh3(first, point, second, (const uint32_t(*)[3])corner, &ground, &error);
        free(point);
        free(corner);
    }
    put(&status, sizeof status);
    put(error.text, 128);
}

static void on_ground(void) {
    const fp3_shape3 *b = shape();
    fp3_pose3 pose[2];
    float reach;
    fp3_mesh_touch3 touch[16];
    memset(touch, 0, sizeof touch);
    get(pose, sizeof pose);
    get(&reach, sizeof reach);
    const uint32_t found =
        ground ? fp3_collide_mesh3(ground, &pose[0], b, &pose[1], reach, 16, touch) : 0;
    put(&found, sizeof found);
    put(touch, sizeof touch);
}

int main(void) {
    uint32_t command;
    shapes = calloc(MOST, sizeof *shapes);
    if (!shapes)
        return 1;
    while (fread(&command, sizeof command, 1, stdin) == 1)
        switch (command) {
        case MAKE:
            make();
            break;
        case COLLIDE:
            collide();
            break;
        case SHAPE:
            put(shape(), sizeof *shapes);
            break;
        case BOUNDS:
            bounds();
            break;
        case MASS:
            mass();
            break;
        case PLANE:
            plane();
            break;
        case MATCH:
            match();
            break;
        case DISTANCE:
            distance();
            break;
        case MEASURE:
            measure();
            break;
        case RAY:
        case IMPACT:
        case CAST:
            first_hit(command);
            break;
        case MESH:
        case HEIGHTS:
            mesh(command);
            break;
        case GROUND:
            on_ground();
            break;
        default:
            return 2;
        }
    free(shapes);
    fp3_free_mesh3(&ground);
    return 0;
}
