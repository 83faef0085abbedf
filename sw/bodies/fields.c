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
    W(is_bouncy), W(is_changed), W(awake), W(touching), W(told)};
#undef THIS

#define THIS fp3_body
static const fp3_kept_field bodies[] = {
    D(at), F(v), F(rest), B(type), B(is_fast), B(may_not_turn), B(may_not_sleep), D(boxed), F(extent), F(inner),
    F(gravity), F(force), F(mass), F(centre), F(damping), F(spin_damping), W(generation), W(first_shape), W(next_asleep)};
static const fp3_kept_field bodies2[] = {F(turn), F(w), F(boxed_turn), D(angle), F(torque), F(inertia)};
#undef THIS
#define THIS fp3_body3
static const fp3_kept_field bodies3[] = {D(q), D(boxed_turn), F(spin), F(torque), F(moment), D(axes)};
#undef THIS

#define THIS fp3_attached
#define SHAPE(of) W(of.core.count), F(of.core.corner), F(of.core.normal), F(of.radius), F(of.extent), F(of.middle)
#define LINK(of) F(of.corner), F(of.radius), W(of.ends)
static const fp3_kept_field shapes[] = {
    F(extent), F(inner), F(friction), F(restitution), F(rolling), F(density), W(category), W(mask), W(body), W(next),
    W(generation), B(is_sensor)};
static const fp3_kept_field shapes2[] = {
    SHAPE(given), SHAPE(shape), LINK(given_link), LINK(link), D(mass), F(belt), B(is_link)};
static const fp3_kept_field shapes3[] = {F(surface)};
#undef THIS

#define THIS fp3_box
static const fp3_kept_field boxes[] = {E(low), E(high)};
#undef THIS

#define THIS fp3_box_filter
static const fp3_kept_field filters[] = {W(category), W(mask), W(may_move)};
#undef THIS

#define THIS fp3_touch2
static const fp3_kept_field touches[] = {
    W(m.count), F(m.point), W(is_found), W(a), W(b), W(body_a), W(body_b), A(approach), A(top),
    B(is_bouncy), B(is_sensor), B(is_touching), B(is_left), D(at), F(normal), F(friction), F(belt), F(rolling), F(radius_a), F(radius_b)};
static const fp3_kept_field touches2[] = {
    F(m.normal), A(p), A(f), A(r), F(from), F(before),
    F(found.normal), W(found.count), F(found.point), F(found_from), F(turn_a), F(turn_b), W(points)};
static const fp3_kept_field touches3[] = {B(has_belt), W(first_patch), W(patches)};
#undef THIS

#define THIS fp3_patch3
static const fp3_kept_field patches[] = {
    W(a), W(b), W(part), F(m.normal), W(m.count), F(m.point), F(gap), F(from), F(turn_a), F(turn_b), A(p), A(twist), A(top), A(f),
    A(roll), F(friction), F(rolling), F(radius_a), F(radius_b)};
#undef THIS

#define THIS fp3_joint
static const fp3_kept_field joints[] = {
    W(def.type), Q(def.a), Q(def.b), D(def.anchor_a), D(def.anchor_b), D(def.axis), D(def.axle), D(def.ratio),
    W(def.has_limits), D(def.low), D(def.high), D(def.speed), D(def.most), D(def.hertz), D(def.damping),
    D(def.rest), D(def.force), D(def.torque), W(def.may_collide), W(a), W(b), W(generation), B(laws)};
static const fp3_kept_field joints2[] = {
    F(anchor_a), F(anchor_b), F(axis), D(from), A(point), A(rod), A(slide), A(twist), A(force), A(torque)};
#undef THIS
#define THIS fp3_joint3
static const fp3_kept_field joints3[] = {
    D(q), D(anchor_a), D(anchor_b), D(axis_b), D(axle_b), A(pin), A(spin), A(line), A(twist), A(force), A(torque)};
#undef THIS

#define THIS fp3_contact
static const fp3_kept_field changes[] = {
    Q(body_a), Q(body_b), Q(shape_a), Q(shape_b), E(point), E(normal), E(speed), E(impulse)};
#undef THIS

#define THIS fp3_kept_form
static const fp3_kept_field forms[] = {
    W(type), W(corners), W(triangles), D(radius), D(centre), D(half), D(q), D(normal)};
#undef THIS
static const fp3_kept_field corners[] = {{"x", 0, FP3_HDF5_DOUBLE, 3, 0, 0}};
static const fp3_kept_field triangles[] = {{"corners", 0, FP3_HDF5_UINT32, 3, 0, 0}};
static const fp3_kept_field form_of[] = {{"form", 0, FP3_HDF5_UINT32, 1, 0, 0}};
/* clang-format on */

#define LIST(name, list, part, ...)                                                                \
    { name, list, sizeof(list) / sizeof *(list), part, __VA_ARGS__ }
const fp3_kept_list fp3_kept_lists[] = {LIST("world", world, -1, 0, 1),
                                        LIST("bodies", bodies, FP3_PART_BODIES, 0, 0),
                                        LIST("bodies", bodies2, FP3_PART_BODIES, 2, 1),
                                        LIST("bodies", bodies3, FP3_PART_BODIES3, 3, 1),
                                        LIST("shapes", shapes, FP3_PART_SHAPES, 0, 0),
                                        LIST("shapes", shapes2, FP3_PART_SHAPES, 2, 1),
                                        LIST("shapes", shapes3, FP3_PART_SHAPES, 3, 1),
                                        LIST("shapes", form_of, FP3_PART_FORM_OF, 3, 1),
                                        LIST("forms", forms, FP3_PART_FORMS, 3, 0),
                                        LIST("corners", corners, FP3_PART_CORNERS, 3, 0),
                                        LIST("triangles", triangles, FP3_PART_TRIANGLES, 3, 0),
                                        LIST("boxes", boxes, FP3_PART_BOXES, 0, 1),
                                        LIST("filters", filters, FP3_PART_FILTERS, 0, 1),
                                        LIST("touches", touches, FP3_PART_TOUCHES, 0, 0),
                                        LIST("touches", touches2, FP3_PART_TOUCHES, 2, 1),
                                        LIST("touches", touches3, FP3_PART_TOUCHES, 3, 1),
                                        LIST("patches", patches, FP3_PART_PATCHES, 3, 0),
                                        LIST("joints", joints, FP3_PART_JOINTS, 0, 0),
                                        LIST("joints", joints2, FP3_PART_JOINTS, 2, 1),
                                        LIST("joints", joints3, FP3_PART_JOINTS3, 3, 1),
                                        LIST("began", changes, FP3_PART_BEGAN, 0, 0),
                                        LIST("ended", changes, FP3_PART_ENDED, 0, 0),
                                        LIST("hit", changes, FP3_PART_HIT, 0, 0)};
const size_t fp3_kept_list_count = sizeof fp3_kept_lists / sizeof *fp3_kept_lists;

/* Boxes and filters are of shapes. */
static fp3_kept_part part_in_plane(fp3_bodies *b, int which) {
    const int change = which - FP3_PART_BEGAN;
    switch (which) {
    case FP3_PART_BODIES:
        return (fp3_kept_part){(void **)&b->body, &b->body_room, &b->body_count, sizeof *b->body};
    case FP3_PART_SHAPES:
        return (fp3_kept_part){(void **)&b->shape, &b->shape_room, &b->shape_count,
                               sizeof *b->shape};
    case FP3_PART_BOXES:
        return (fp3_kept_part){(void **)&b->boxes.box, &b->boxes.room, &b->shape_count,
                               sizeof *b->boxes.box};
    case FP3_PART_FILTERS:
        return (fp3_kept_part){(void **)&b->boxes.filter, &b->boxes.filter_room, &b->shape_count,
                               sizeof *b->boxes.filter};
    case FP3_PART_TOUCHES:
        return (fp3_kept_part){(void **)&b->touch, &b->touch_room, &b->touch_count,
                               sizeof *b->touch};
    case FP3_PART_JOINTS:
        return (fp3_kept_part){(void **)&b->joint, &b->joint_room, &b->joint_count,
                               sizeof *b->joint};
    default:
        return (fp3_kept_part){(void **)&b->change[change], &b->change_room[change],
                               &b->change_count[change], sizeof *b->change[change]};
    }
}

fp3_kept_part fp3_part_of(fp3_bodies *b, int which) {
    fp3_space *s = b->space;
    switch (which) {
    case FP3_PART_BODIES3:
        return (fp3_kept_part){(void **)&s->body, &s->body_room, &b->body_count, sizeof *s->body};
    case FP3_PART_JOINTS3:
        return (fp3_kept_part){(void **)&s->joint, &s->joint_room, &b->joint_count,
                               sizeof *s->joint};
    case FP3_PART_PATCHES:
        return (fp3_kept_part){(void **)&s->patch, &s->patch_room, &s->patch_count,
                               sizeof *s->patch};
    case FP3_PART_FORMS:
        return (fp3_kept_part){(void **)&s->kept.form, &s->kept.form_room, &s->kept.forms,
                               sizeof *s->kept.form};
    case FP3_PART_CORNERS:
        return (fp3_kept_part){(void **)&s->kept.corner, &s->kept.corner_room, &s->kept.corners,
                               sizeof *s->kept.corner};
    case FP3_PART_TRIANGLES:
        return (fp3_kept_part){(void **)&s->kept.triangle, &s->kept.triangle_room,
                               &s->kept.triangles, sizeof *s->kept.triangle};
    case FP3_PART_FORM_OF:
        return (fp3_kept_part){(void **)&s->kept.of, &s->kept.of_room, &b->shape_count,
                               sizeof *s->kept.of};
    default:
        return part_in_plane(b, which);
    }
}

fp3_kept_part fp3_kept_elements(fp3_bodies *bodies, const fp3_kept_list *list) {
    static const fp3_kept_part own = {.size = sizeof *bodies};
    return list->part < 0 ? own : fp3_part_of(bodies, list->part);
}

void fp3_bodies_count_up(fp3_bodies *b) {
    b->living = b->joints = 0;
    for (uint32_t i = 0; i < b->body_count; i++) {
        b->living += (uint32_t)fp3_body_lives(&b->body[i]);
        b->body[i].slot = FP3_NOBODY;
    }
    for (uint32_t i = 0; i < b->joint_count; i++)
        b->joints += b->joint[i].generation & 1;
    b->time = (double)b->steps * b->def.h;
    b->boxes.count = b->shape_count;
    b->is_apart_stale = 1;
    b->is_still = 0;
}

void fp3_field_name(char name[FP3_FIELD_NAME], const fp3_kept_list *of,
                    const fp3_kept_field *field) {
    snprintf(name, FP3_FIELD_NAME, "%s.%s", of->name, field->name);
}

size_t fp3_field_size(const fp3_kept_field *field) {
    const size_t size = field->type == FP3_HDF5_DOUBLE || field->type == FP3_HDF5_UINT64 ? 8 : 4;
    return size * field->count;
}

void fp3_field_gather(const fp3_kept_field *field, const void *elements, size_t size, uint32_t rows,
                      void *column) {
    const size_t bytes = fp3_field_size(field);
    for (uint32_t i = 0; i < rows; i++) {
        const char *from = (const char *)elements + i * size + field->at;
        const uint32_t word = (uint8_t)*from;
        memcpy((char *)column + i * bytes, field->is_byte ? (const void *)&word : from, bytes);
    }
}

void fp3_field_scatter(const fp3_kept_field *field, const void *column, uint32_t rows,
                       void *elements, size_t size) {
    const size_t bytes = fp3_field_size(field);
    for (uint32_t i = 0; i < rows; i++) {
        char *to = (char *)elements + i * size + field->at;
        uint32_t word;
        if (field->is_byte) {
            memcpy(&word, (const char *)column + i * bytes, sizeof word);
            *to = (char)(word > UINT8_MAX ? UINT8_MAX : word);
        } else {
            memcpy(to, (const char *)column + i * bytes, bytes);
        }
    }
}

fp3_status fp3_kept_laws(const fp3_hdf5_ops *calls, const fp3_bodies *bodies,
                         char text[FP3_DIGEST_SIZE], fp3_error *error) {
    fp3_digest digest;
    fp3_hdf5_sum *sum = calls->sum_begin();
    const char *of;
    if (!sum)
        return fp3_no_memory(error);
    for (uint32_t i = 0; (of = fp3_laws_text(bodies->laws, bodies->def.dimensions, i)); i++)
        calls->sum_add(sum, of, strlen(of) + 1);
    calls->sum_end(sum, digest.words);
    fp3_digest_text(&digest, text);
    return FP3_OK;
}

void fp3_kept_hash(const fp3_bodies *bodies, char text[FP3_KEPT_HASH]) {
    snprintf(text, FP3_KEPT_HASH, "%016" PRIx64, fp3_bodies_hash(bodies));
}
