/* SPDX-License-Identifier: Apache-2.0 */
/* processor.c - see processor.h. */
#include "processor.h"

#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>

void fp3_processor_name(char *name, size_t size) {
    char line[256];
    struct utsname system;
    FILE *about = fopen("/proc/cpuinfo", "r");
    *name = '\0';
    while (about && !*name && fgets(line, sizeof line, about)) {
        const char *value = strncmp(line, "model name", 10) ? NULL : strchr(line, ':');
        if (value)
            snprintf(name, size, "%.*s", (int)strcspn(value + 2, "\n"), value + 2);
    }
    if (about)
        fclose(about);
    if (!*name && !uname(&system))
        snprintf(name, size, "%s", system.machine);
}
