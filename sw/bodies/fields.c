/* SPDX-License-Identifier: Apache-2.0 */
/* fields.c - see fields.h. A field that is missing here is 0 after a restart: tests of random
 * worlds find other bits. */
#include "fields.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* clang-format off */
#define OF(kind, type, member, number, byte, any)                                                        \
    {#member, offsetof(type, member), number, sizeof(((type *)0)->member) / (sizeof(kind)), byte, any}
#define F(member) OF(float, THIS, member, FP3_HDF5_FLOAT, 0, 0)
/* Impulses where a body fails; boxes of what is not there. */
#define E(member) OF(double, THIS, member, FP3_HDF5_DOUBLE, 0, 1)
#define A(member) OF(float, THIS, member, FP3_HDF5_FLOAT, 0, 1)
#define D(member) OF(double, THIS, member, FP3_HDF5_DOUBLE, 0, 0)
#define W(member) OF(uint32_t, THIS, member, FP3_HDF5_UINT32, 0, 0)
#define Q(member) OF(uint64_t, THIS, member, FP3_HDF5_UINT64, 0, 0)
#define B(member) OF(uint8_t, THIS, member, FP3_HDF5_UINT32, 1, 0)

#define THIS fp3_bodies
static const fp3_kept_field world[] = {
    D(def.gravity), W(def.dimensions), D(def.h), W(def.substeps), D(def.size), D(def.push), D(def.bounce),
    D(def.rest_speed), D(def.rest_time), Q(steps), W(free_body), W(free_shape), W(free_joint),
    W(is_bouncy), W(is_changed), W(is_apart_stale), W(awake), W(touching)};
#undef THIS

#define THIS fp3_body
static const fp3_kept_field bodies[] = {
    D(at), F(turn), F(v), F(w), F(rest), B(type), B(is_fast), B(may_not_turn), B(may_not_sleep), D(boxed),
    F(boxed_turn), F(extent), F(inner), F(gravity), D(angle), F(force), F(torque), F(mass), F(inertia), F(centre),
    F(damping), F(spin_damping), W(generation), W(first_shape), W(next_asleep)};
#undef THIS

#define THIS fp3_attached
#define SHAPE(of) W(of.core.count), F(of.core.corner), F(of.core.normal), F(of.radius), F(of.extent), F(of.middle)
#define LINK(of) F(of.corner), F(of.radius), W(of.ends)
static const fp3_kept_field shapes[] = {
    SHAPE(given), SHAPE(shape), LINK(given_link), LINK(link), D(mass), F(extent), F(inner), F(friction), F(restitution),
    F(rolling), F(belt), F(surface), F(density), W(category), W(mask), W(body), W(next), W(generation), B(is_sensor), B(is_link)};
#undef THIS

#define THIS fp3_box
static const fp3_kept_field boxes[] = {E(low), E(high)};
#undef THIS

#define THIS fp3_box_filter
static const fp3_kept_field filters[] = {W(category), W(mask), W(may_move)};
#undef THIS

#define THIS fp3_touch2
static const fp3_kept_field touches[] = {
    F(m.normal), W(m.count), F(m.point), A(p), A(f), A(r), F(from), F(friction), F(belt), F(rolling),
    F(radius_a), F(radius_b), F(before), A(top), F(found.normal), W(found.count), F(found.point),
    F(found_from), F(turn_a), F(turn_b), W(is_found), W(a), W(b), W(body_a), W(body_b), A(approach),
    W(points), B(is_bouncy), B(is_sensor), B(is_touching), D(at), F(normal)};
#undef THIS

#define THIS fp3_joint
static const fp3_kept_field joints[] = {
    W(def.type), Q(def.a), Q(def.b), D(def.anchor_a), D(def.anchor_b), D(def.axis), D(def.ratio),
    W(def.has_limits), D(def.low), D(def.high), D(def.speed), D(def.most), D(def.hertz), D(def.damping),
    D(def.rest), D(def.force), D(def.torque), W(def.may_collide), W(a), W(b), F(anchor_a), F(anchor_b),
    F(axis), D(from), W(generation), B(laws), A(point), A(rod), A(slide), A(twist), A(force), A(torque)};
#undef THIS

static const fp3_kept_field apart[] = {{"pair", 0, FP3_HDF5_UINT64, 1, 0, 0}};
/* clang-format on */

#define LIST(list) #list, list, sizeof(list) / sizeof *(list)
const fp3_kept_fields fp3_fields_of_world = {LIST(world)};
const fp3_kept_fields fp3_fields_of[FP3_PARTS] = {
    [FP3_PART_BODIES] = {LIST(bodies)},   [FP3_PART_SHAPES] = {LIST(shapes)},
    [FP3_PART_BOXES] = {LIST(boxes)},     [FP3_PART_FILTERS] = {LIST(filters)},
    [FP3_PART_TOUCHES] = {LIST(touches)}, [FP3_PART_JOINTS] = {LIST(joints)},
    [FP3_PART_APART] = {LIST(apart)}};

/* Boxes and filters are of shapes. */
fp3_kept_part fp3_part_of(fp3_bodies *b, int which) {
    const fp3_kept_part parts[FP3_PARTS] = {
        {(void **)&b->body, &b->body_room, &b->body_count, sizeof *b->body},
        {(void **)&b->shape, &b->shape_room, &b->shape_count, sizeof *b->shape},
        {(void **)&b->boxes.box, &b->boxes.room, &b->shape_count, sizeof *b->boxes.box},
        {(void **)&b->boxes.filter, &b->boxes.filter_room, &b->shape_count,
         sizeof *b->boxes.filter},
        {(void **)&b->touch, &b->touch_room, &b->touch_count, sizeof *b->touch},
        {(void **)&b->joint, &b->joint_room, &b->joint_count, sizeof *b->joint},
        {(void **)&b->apart, &b->apart_room, &b->apart_count, sizeof *b->apart},
    };
    return parts[which];
}

void fp3_field_name(char name[FP3_FIELD_NAME], const fp3_kept_fields *of,
                    const fp3_kept_field *field) {
    snprintf(name, FP3_FIELD_NAME, "%s.%s", of->name, field->name);
}

size_t fp3_field_size(const fp3_kept_field *field) {
    const size_t size = field->type == FP3_HDF5_DOUBLE || field->type == FP3_HDF5_UINT64 ? 8 : 4;
    return size * field->count;
}

fp3_status fp3_kept_laws(const fp3_hdf5_ops *calls, const fp3_laws *laws,
                         char text[FP3_DIGEST_SIZE], fp3_error *error) {
    fp3_digest digest;
    fp3_hdf5_sum *sum = calls->sum_begin();
    if (!sum)
        return fp3_no_memory(error);
    for (int i = 0; i < FP3_LAWS; i++) {
        const char *of = fp3_laws_text(laws, (uint32_t)i);
        calls->sum_add(sum, of, strlen(of) + 1);
    }
    calls->sum_end(sum, digest.words);
    fp3_digest_text(&digest, text);
    return FP3_OK;
}

void fp3_kept_hash(const fp3_bodies *bodies, char text[FP3_KEPT_HASH]) {
    snprintf(text, FP3_KEPT_HASH, "%016" PRIx64, fp3_bodies_hash(bodies));
}
