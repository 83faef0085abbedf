/* SPDX-License-Identifier: Apache-2.0 */
/* processor.h - what this machine's processor is called. */
#ifndef FP3_CLI_PROCESSOR_H
#define FP3_CLI_PROCESSOR_H

#include <stddef.h>

/* As the system says it, "AMD EPYC"; else its family, "aarch64". */
void fp3_processor_name(char *name, size_t size);

#endif
