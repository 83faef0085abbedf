/* SPDX-License-Identifier: Apache-2.0 */
/* config.h - the named configurations of isa/configs.toml as a table, and their keys. */
#ifndef FP3_CONFIG_H
#define FP3_CONFIG_H

#include "gen/configs.h"

#include <fp3/image.h>
#include <fp3/status.h>
#include <stddef.h>

extern const fp3_config fp3_configs[];
extern const uint32_t fp3_config_count;

/* By name, which may be NULL; NULL if there is none. */
const fp3_config *fp3_config_find(const char *name);
/* FP3_E_ARGUMENT: there is none; the message lists those that there are. */
fp3_status fp3_config_choose(const char *name, const fp3_config **config, fp3_error *error);

/* Schedulers in all: each has its own program and counters. */
uint32_t fp3_config_schedulers(const fp3_config *config);
/* What stands for all of them in an address; 0 if there is one. */
uint32_t fp3_config_broadcast(const fp3_config *config);

/* Whether both have the same arithmetic (docs/arithmetic.md): the same program then gives the same
 * bits on both. */
int fp3_config_computes_as(const fp3_config *config, const fp3_config *other);
/* The words that it computes in, as fp3_image has them. Instructions say whether a multiply-add is
 * fused. */
uint32_t fp3_config_words(const fp3_config *config);

/* What a configuration has for a key; the key's name, of one that follows from others what these
 * must be; what a number stands for, NULL: for itself; and what messages call an instruction that
 * needs the key, NULL if none does. */
uint32_t fp3_config_value(const fp3_config *config, fp3_key key);
const char *fp3_key_name(fp3_key key);
const char *fp3_key_choice(fp3_key key, uint32_t value);
const char *fp3_key_lack(fp3_key key);

#endif
