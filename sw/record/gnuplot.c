/* SPDX-License-Identifier: Apache-2.0 */
/* gnuplot.c - see gnuplot.h. The script is in an unnamed file and the picture comes through a pipe:
 * if gnuplot ends early, nothing is written into a closed pipe, and a full disk is seen here and
 * not by gnuplot, which would say nothing. */
#include "gnuplot.h"

#include "base/child.h"
#include "base/host.h"
#include "base/number.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <strings.h>
#include <sys/wait.h>
#include <unistd.h>

#define SECONDS_MOST 120u

/* Its exit code, -1, or TOO_LONG. */
#define TOO_LONG (-2)
static int wait_for(const fp3_child *child) {
    int how = 0;
    const int failed = fp3_child_wait(child, &how);
    return failed == ETIMEDOUT ? TOO_LONG : !failed && WIFEXITED(how) ? WEXITSTATUS(how) : -1;
}

static fp3_status too_long(fp3_error *error) {
    return fp3_fail(error, FP3_E_SYSTEM, "gnuplot took longer than %u s, and was ended",
                    SECONDS_MOST);
}

static fp3_status cannot_start(int number, fp3_error *error) {
    if (number == ENOENT)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "plots are drawn by gnuplot, which is not installed (Debian's package "
                        "gnuplot-nox)");
    return fp3_fail(error, FP3_E_SYSTEM, "gnuplot does not start: %s", strerror(number));
}

fp3_status fp3_gnuplot_check(fp3_error *error) {
    char *const arguments[] = {"gnuplot", "--version", NULL};
    const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
    fp3_child child;
    if (nothing < 0)
        return fp3_fail(error, FP3_E_SYSTEM, "/dev/null: cannot open: %s", strerror(errno));
    const int failed = fp3_child_start(arguments, nothing, nothing, nothing, SECONDS_MOST, &child);
    const int code = failed ? 0 : wait_for(&child);
    close(nothing);
    if (failed)
        return cannot_start(failed, error);
    if (code == TOO_LONG)
        return too_long(error);
    return code ? fp3_fail(error, FP3_E_SYSTEM, "gnuplot does not start: it ends with %d", code)
                : FP3_OK;
}

/* The first line that says something. */
static fp3_status tell(FILE *said, int code, fp3_error *error) {
    char line[256];
    rewind(said);
    while (fgets(line, sizeof line, said)) {
        line[strcspn(line, "\n")] = '\0';
        if (strspn(line, " ^\t") < strlen(line))
            return fp3_fail(error, FP3_E_SYSTEM, "gnuplot: %s", line);
    }
    return fp3_fail(error, FP3_E_SYSTEM, "gnuplot ends with %d", code);
}

/* Until gnuplot closes its end, or its time is over. What cannot be written, the stream remembers.
 */
static void copy(int from, const fp3_child *child, FILE *to) {
    char bytes[65536];
    struct pollfd end = {.fd = from, .events = POLLIN};
    for (;;) {
        const int ready = poll(&end, 1, fp3_child_left(child));
        const ssize_t count = ready > 0 ? read(from, bytes, sizeof bytes) : 0;
        if (count > 0)
            fwrite(bytes, 1, (size_t)count, to);
        else if (ready == 0 ? !fp3_child_left(child) : (ready > 0 && count == 0) || errno != EINTR)
            return;
    }
}

static fp3_status draw(FILE *script, FILE *to, FILE *said, fp3_error *error) {
    char *const arguments[] = {"gnuplot", "--default-settings", NULL};
    int ends[2];
    fp3_child child;
    if (lseek(fileno(script), 0, SEEK_SET) < 0 || pipe2(ends, O_CLOEXEC))
        return fp3_fail(error, FP3_E_SYSTEM, "cannot make a pipe: %s", strerror(errno));
    const int failed =
        fp3_child_start(arguments, fileno(script), ends[1], fileno(said), SECONDS_MOST, &child);
    close(ends[1]);
    if (!failed)
        copy(ends[0], &child, to);
    close(ends[0]);
    if (failed)
        return cannot_start(failed, error);
    const int code = wait_for(&child);
    return code == TOO_LONG ? too_long(error) : code ? tell(said, code, error) : FP3_OK;
}

static int ends(const char *path, const char *end) {
    const char *dot = strrchr(path, '.');
    return dot && !strcasecmp(dot, end);
}

const char *fp3_gnuplot_colour(size_t i) {
    /* Okabe and Ito, Color Universal Design (2008). */
    static const char *const colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                          "#e69f00", "#56b4e9", "#000000", "#999999"};
    return colours[i % (sizeof colours / sizeof *colours)];
}

fp3_status fp3_gnuplot_check_picture(const char *path, fp3_error *error) {
    if (ends(path, ".svg") || ends(path, ".png"))
        return fp3_gnuplot_check(error);
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "%s: expected the name of a picture that ends in .svg or .png", path);
}

void fp3_gnuplot_begin(FILE *script, const char *path, int width, int height, double right) {
    fprintf(script,
            ends(path, ".png")
                ? "set terminal pngcairo size %d,%d font 'sans,11' background '#ffffff'\n"
                : "set terminal svg size %d,%d font 'sans,13' background '#ffffff'\n",
            width, height);
    /* Names have _ and ^, which are to be seen as such: only exponents of axes are raised. */
    fprintf(script,
            "set encoding utf8\nset grid lt 1 lc rgb '#dddddd'\nset title noenhanced\n"
            "set xlabel noenhanced\nset ylabel noenhanced\n"
            "set key noenhanced at screen %g, graph 1 left top Left reverse\n",
            right + 0.01);
}

static fp3_status cannot_write(fp3_error *error) {
    return fp3_fail(error, FP3_E_SYSTEM, "cannot write a temporary file: %s", strerror(errno));
}

fp3_status fp3_gnuplot_write(fp3_gnuplot_script_fn *script, const void *user, FILE *to,
                             fp3_error *error) {
    FILE *file = tmpfile(), *said = tmpfile();
    fp3_status status = file && said ? FP3_OK : cannot_write(error);
    if (!status) {
        FP3_HOST;
        script(user, file);
        status = fflush(file) || ferror(file) ? cannot_write(error) : FP3_OK;
    }
    if (!status)
        status = draw(file, to, said, error);
    if (file)
        fclose(file);
    if (said)
        fclose(said);
    return status;
}
