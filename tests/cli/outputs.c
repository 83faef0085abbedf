/* SPDX-License-Identifier: Apache-2.0 */
/* outputs.c - a file that is written again and again, where a write or an allocation fails. In the
 * current directory. */
#include "base/file.h"
#include "base/temporary.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CHECK(is)                                                                                  \
    do {                                                                                           \
        if (!(is)) {                                                                               \
            printf("line %d: %s: %s\n", __LINE__, #is, error.text);                                \
            return 1;                                                                              \
        }                                                                                          \
    } while (0)

static int is_out;

/* Instead of the C library's. */
char *strdup(const char *text) {
    char *made = is_out ? NULL : malloc(strlen(text) + 1);
    return made ? strcpy(made, text) : NULL;
}

int main(void) {
    fp3_error error = {.text = ""};
    fp3_output *output = NULL;
    fp3_temporary place;
    char *text = NULL;
    size_t size = 0;
    CHECK(!fp3_output_open_again("file", &output, &error));
    CHECK(!fp3_output_begin(output, &error) && fputs("lost", fp3_output_stream(output)) >= 0);
    CHECK(!fp3_output_begin(output, &error) && fputs("kept", fp3_output_stream(output)) >= 0);
    CHECK(!fp3_output_publish(output, &error));
    CHECK(!fp3_output_begin(output, &error) && fputs("lost", fp3_output_stream(output)) >= 0);
    fp3_output_close(&output);
    CHECK(!fp3_file_read("file", &text, &size, &error) && !strcmp(text, "kept"));
    free(text);
    is_out = 1;
    CHECK(fp3_temporary_open("place", &place) && access("place", F_OK));
    return 0;
}
