/* spelled.c - files in libconfig's syntax, damaged at random: libconfig sees exactly the numbers
 * that were replaced, in their order, and reads none by itself.
 *
 *     spelled SEED COUNT
 */
#include "base/settings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROOM 600

static const char whole[] =
    "\xef\xbb\xbf"
    "config = \"array\\\"x\"; # c\nsteps=12; /* a */ h : 0.5e-3; l=[1,2.5,0x1fL];\n"
    "g=({p=\"a\";o=-3;s={m=+.5;t=true;};},(1,\"x\" \"y\"));// e\n@include \"x\"\n";

static size_t below(size_t n) { return (size_t)rand() % n; }

static size_t damage(char text[ROOM]) {
    static const char special[] = "{}()[];:=\"\\#/*@-+.eELx019\n";
    size_t size = sizeof whole - 1;
    memcpy(text, whole, size);
    if (below(2))
        size = (size_t)((char *)memchr(text, '@', size) - text);
    for (size_t left = 1 + below(6); left > 0; left--) {
        const size_t at = below(size), length = below(20);
        switch (below(4)) {
        case 0:
            text[at] = (char)below(256);
            break;
        case 1:
            text[at] = special[below(sizeof special - 1)];
            break;
        case 2:
            size = at + 1;
            break;
        default:
            if (size + length < ROOM && at + length <= size) {
                memmove(text + at + length, text + at, size - at);
                size += length;
            }
        }
    }
    return size;
}

/* Counts the numbers; 0: one is not the next of the list, or was read by libconfig. */
static int walk(const fp3_settings *s, const config_setting_t *at, int *seen) {
    const int type = config_setting_type(at);
    int is_good = type != CONFIG_TYPE_INT64 && type != CONFIG_TYPE_FLOAT;
    double number;
    uint64_t count;
    if (type == CONFIG_TYPE_INT)
        is_good = config_setting_get_int(at) == (*seen)++;
    fp3_setting_number(s, at, "number", &number);
    fp3_setting_count(s, at, "count", 0, UINT64_MAX, &count);
    for (int i = 0; is_good && config_setting_is_aggregate(at) && i < config_setting_length(at);
         i++)
        is_good = walk(s, config_setting_get_elem(at, (unsigned)i), seen);
    return is_good;
}

/* 1: read; 0: refused, with its line; -1: neither. */
static int try(const char *text, size_t size) {
    fp3_error error = {.text = ""};
    fp3_settings s;
    int seen = 0, is_good = 0;
    const fp3_status status = fp3_settings_read(text, size, "x", FP3_E_ARGUMENT, &s, &error);
    if (!status)
        is_good = walk(&s, s.root, &seen) && (size_t)seen == s.spelled.count ? 1 : -1;
    else if (strncmp(error.text, "x:", 2) != 0)
        is_good = -1;
    fp3_settings_close(&s);
    return is_good;
}

int main(int argc, char **argv) {
    if (argc != 3)
        return 2;
    long read = 0, count = strtol(argv[2], NULL, 10);
    srand((unsigned)strtoul(argv[1], NULL, 10));
    for (long i = 0; i < count; i++) {
        char text[ROOM];
        const size_t size = damage(text);
        char *exact = malloc(size); /* so that a sanitizer sees what is read beyond it */
        if (!exact)
            return 1;
        memcpy(exact, text, size);
        const int found = try(exact, size);
        free(exact);
        if (found < 0) {
            printf("input %ld: ", i);
            fwrite(text, 1, size, stdout);
            return 1;
        }
        read += found;
    }
    printf("%ld read, %ld refused\n", read, count - read);
    return 0;
}
