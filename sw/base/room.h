/* SPDX-License-Identifier: Apache-2.0 */
/* room.h - arrays that grow. */
#ifndef FP3_BASE_ROOM_H
#define FP3_BASE_ROOM_H

#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

/* Grows an array of `size` bytes an element to hold `wanted`; FP3_E_SYSTEM: unchanged. Elements are
 * aligned to 64 bytes. */
fp3_status fp3_room(void **array, uint32_t *room, size_t size, size_t wanted, fp3_error *error);

#endif
