/* SPDX-License-Identifier: Apache-2.0 */
/* video.c - see video.h. */
#include "video.h"

#include "base/child.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <strings.h>
#include <sys/wait.h>
#include <unistd.h>

#define SECONDS_MOST 3600u

int fp3_view_video_is_named(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && !strcasecmp(dot, ".mp4");
}

/* The first line of what it said. */
static fp3_status tell(FILE *said, int code, fp3_error *error) {
    char line[256];
    rewind(said);
    if (!fgets(line, sizeof line, said))
        return fp3_fail(error, FP3_E_SYSTEM, "ffmpeg ends with %d", code);
    line[strcspn(line, "\n")] = '\0';
    return fp3_fail(error, FP3_E_SYSTEM, "ffmpeg: %s", line);
}

static fp3_status start_and_wait(char *const *arguments, int in, int out, FILE *said,
                                 fp3_error *error) {
    fp3_child child;
    int how = 0;
    const int failed = fp3_child_start(arguments, in, out, fileno(said), SECONDS_MOST, &child);
    if (failed == ENOENT)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "videos are made by ffmpeg, which is not installed (Debian's package "
                        "ffmpeg); a film whose name ends in .png does not need it");
    if (failed)
        return fp3_fail(error, FP3_E_SYSTEM, "ffmpeg does not start: %s", strerror(failed));
    const int ended = fp3_child_wait(&child, &how);
    if (ended == ETIMEDOUT)
        return fp3_fail(error, FP3_E_SYSTEM, "ffmpeg took longer than %u s, and was ended",
                        SECONDS_MOST);
    const int code = !ended && WIFEXITED(how) ? WEXITSTATUS(how) : -1;
    return code ? tell(said, code, error) : FP3_OK;
}

static fp3_status run(char *const *arguments, int in, fp3_error *error) {
    const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
    FILE *said = nothing < 0 ? NULL : tmpfile();
    fp3_status status =
        said ? start_and_wait(arguments, in < 0 ? nothing : in, nothing, said, error)
             : fp3_fail(error, FP3_E_SYSTEM, "cannot start ffmpeg: %s", strerror(errno));
    if (said)
        fclose(said);
    if (nothing >= 0)
        close(nothing);
    return status;
}

fp3_status fp3_view_video_check(uint32_t width, uint32_t height, fp3_error *error) {
    char *const arguments[] = {"ffmpeg", "-version", NULL};
    if (width % 2 || height % 2)
        return fp3_fail(error, FP3_E_ARGUMENT, "a video is even in width and height, found %u x %u",
                        width, height);
    return run(arguments, -1, error);
}

/* By a name, not as a pipe: ffmpeg seeks in it. yuv420p is what all players play. */
fp3_status fp3_view_video_make(FILE *film, const char *path, fp3_error *error) {
    char file[4200];
    char *const arguments[] = {"ffmpeg",     "-y",       "-loglevel", "error", "-f",  "apng", "-i",
                               "/dev/stdin", "-pix_fmt", "yuv420p",   "-f",    "mp4", file,   NULL};
    if ((size_t)snprintf(file, sizeof file, "file:%s", path) >= sizeof file)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: a name that is too long", path);
    if (fflush(film) || lseek(fileno(film), 0, SEEK_SET) < 0)
        return fp3_fail(error, FP3_E_SYSTEM, "cannot write the film: %s", strerror(errno));
    return run(arguments, fileno(film), error);
}
