/* SPDX-License-Identifier: Apache-2.0 */
/* bench_page.c - see bench_files.h: the tables and the pictures of fp3 bench MODEL as one page, which loads nothing. */
#include "bench_files.h"

#include "base/file.h"
#include "base/host.h"
#include "processor.h"

#include <fp3/program.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#define HEAD                                                                                       \
    "<!doctype html>\n<html lang=\"en\">\n"                                                        \
    "<!-- Written by fp3 bench. All of it is in this file: it loads nothing. -->\n"                \
    "<meta charset=\"utf-8\">\n"                                                                   \
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"                   \
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "                  \
    "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"                                   \
    "<title>fp3 bench: error against run time</title>\n"

/* In the dark a picture is inverted and its hues are turned back: a blue curve stays blue. */
#define STYLE                                                                                      \
    "<style>\n:root{color-scheme:light dark}\n"                                                    \
    "body{font:15px/1.5 sans-serif;max-width:1000px;margin:2em auto;padding:0 1em;"                \
    "color:#222;background:#fff}\n"                                                                \
    "svg{display:block;max-width:100%;height:auto;margin:1em 0}use:hover{stroke-width:2}\n"        \
    "table{border-collapse:collapse;font-size:13px;margin:1em 0;"                                  \
    "font-variant-numeric:tabular-nums}\n"                                                         \
    "td,th{border:1px solid #ccc;padding:2px 8px;text-align:right}"                                \
    "td:nth-child(-n+3),th:nth-child(-n+3){text-align:left}\n"                                     \
    "th button{all:unset;cursor:pointer}th button:focus-visible{outline:2px solid #0072b2}\n"      \
    "th[aria-sort=ascending] button::after{content:' \\25b4'}"                                     \
    "th[aria-sort=descending] button::after{content:' \\25be'}\n"                                  \
    "code{background:#f2f2f2;padding:0 .2em}dt{font-weight:bold}dd{margin:0 0 .3em 1.5em}\n"       \
    ".wide{overflow-x:auto}\n"                                                                     \
    "@media (prefers-color-scheme:dark){body{color:#ddd;background:#141414}"                       \
    "code{background:#2a2a2a}td,th{border-color:#444}"                                             \
    "svg{filter:invert(.92) hue-rotate(180deg)}}\n</style>\n"

#define COLUMNS                                                                                    \
    "<dl>\n<dt>engine</dt><dd>what runs the steps: <code>fast</code> is native code of this "      \
    "machine, <code>rtl</code> the hardware of that configuration, <code>plain_c</code> a loop "   \
    "in C, <code>gsl</code> the GNU Scientific Library</dd>\n"                                     \
    "<dt>how</dt><dd>method, integrator and arithmetic</dd>\n"                                     \
    "<dt>step</dt><dd>the time step h, or the tolerance of adaptive steps</dd>\n"                  \
    "<dt>error, worst</dt><dd>the error at the end, relative to the largest magnitude of each "    \
    "state, root of the mean square over the states: the median of the objects, and the largest"   \
    "</dd>\n<dt>ns</dt><dd>nanoseconds for one object, all its steps: median of repeats</dd>\n"    \
    "<dt>cycles</dt><dd>cycles of the hardware for one object, all its steps</dd>\n</dl>\n"

#define SCRIPT                                                                                     \
    "<script>\n"                                                                                   \
    "for (const button of document.querySelectorAll('th button')) button.onclick = () => {\n"      \
    "  const th = button.parentNode, body = th.closest('table').tBodies[0];\n"                     \
    "  const way = th.ariaSort === 'ascending' ? -1 : 1;\n"                                        \
    "  const key = row => row.cells[th.cellIndex].textContent;\n"                                  \
    "  const order = (a, b) => a === '' || b === '' ? (a === '') - (b === '')\n"                   \
    "    : way * (isNaN(a) || isNaN(b) ? a.localeCompare(b, 'en', {numeric: true}) : a - b);\n"    \
    "  for (const other of th.parentNode.cells) other.removeAttribute('aria-sort');\n"             \
    "  th.ariaSort = way > 0 ? 'ascending' : 'descending';\n"                                      \
    "  body.append(...[...body.rows].sort((a, b) => order(key(a), key(b))));\n"                    \
    "};\n</script>\n</html>\n"

/* ---- texts ---- */

static void put_text(FILE *out, const char *text) {
    for (; *text; text++)
        switch (*text) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        default:
            putc(*text, out);
        }
}

static const char *text_of(const json_t *point, const char *key) {
    return json_string_value(json_object_get(point, key));
}

static double number_of(const json_t *point, const char *key) {
    return json_number_value(json_object_get(point, key));
}

static int is_time(const json_t *point) { return !strcmp(text_of(point, "unit"), "ns"); }

/* As a shell reads it. */
static void put_word(FILE *out, const char *word) {
    const int is_quoted = !*word || strpbrk(word, " \t\n\"'\\$`*?[]{}()<>|&;#~!");
    fputs(is_quoted ? " '" : " ", out);
    for (char one[2] = ""; (*one = *word); word++)
        put_text(out, *one == '\'' ? "'\\''" : one);
    fputs(is_quoted ? "'" : "", out);
}

static void put_machine(FILE *out) {
    char name[128], when[32] = "";
    const time_t now = time(NULL);
    struct tm day;
    struct utsname system;
    fp3_processor_name(name, sizeof name);
    if (gmtime_r(&now, &day))
        strftime(when, sizeof when, "%Y-%m-%d", &day);
    fprintf(out, "<p>Measured %s by fp3 " FP3_VERSION " on %ld processors: ", when,
            sysconf(_SC_NPROCESSORS_ONLN));
    put_text(out, name);
    if (!uname(&system)) {
        fputs(", ", out);
        put_text(out, system.sysname);
        putc(' ', out);
        put_text(out, system.release);
        putc(' ', out);
        put_text(out, system.machine);
    }
    fputs(".</p>\n", out);
}

/* ---- pictures ---- */

/* What the pointer says of a point. */
static void put_note(FILE *out, const json_t *point) {
    fputs("<title>", out);
    put_text(out, text_of(point, "curve"));
    fputs(": ", out);
    put_text(out, text_of(point, "how"));
    fprintf(out, ", %s: error %.2e, %.5g %s</title>", text_of(point, "step"),
            number_of(point, "error"), number_of(point, "cost"), text_of(point, "unit"));
}

typedef struct {
    FILE *out;
    const fp3_bench_picture *picture;
    unsigned number; /* of the picture in the page: names in it are its own */
    size_t next;     /* point of `shown` */
    size_t left;     /* of the curve: marks that are points, not the legend's */
} drawing;

/* Of a curve, from `next` on. */
static void begin_curve(drawing *d) {
    const json_t *shown = d->picture->shown, *before = NULL, *point;
    d->next += d->left;
    while ((point = json_array_get(shown, d->next)) && !fp3_bench_is_drawn(d->picture, point))
        d->next++;
    for (d->left = 0; (point = json_array_get(shown, d->next + d->left)) &&
                      fp3_bench_is_drawn(d->picture, point) &&
                      (!before || !strcmp(text_of(before, "curve"), text_of(point, "curve")));
         d->left++)
        before = point;
}

static int skip(const char **at, const char *begin, const char *end) {
    const char *found = strncmp(*at, begin, strlen(begin)) ? NULL : strstr(*at, end);
    if (found)
        *at = found + strlen(end);
    return found != NULL;
}

/* What follows is copied, and something else stands in the page in place of `what`. */
static int replace(drawing *d, const char **at, const char *what, const char *by) {
    if (strncmp(*at, what, strlen(what)) != 0)
        return 0;
    fprintf(d->out, by, d->number);
    *at += strlen(what);
    return 1;
}

/* gnuplot's text without what a page does not need, and with a note at each point. */
static void put_svg(drawing *d, const char *at) {
    int is_mark = 0;
    while (*at) {
        if (!strncmp(at, "<g id=\"gnuplot_plot_", 20))
            begin_curve(d);
        if (skip(&at, " xmlns=", "\"\n") || skip(&at, " xmlns:xlink=", "\"\n") ||
            skip(&at, "<title>", "</title>") || skip(&at, "<desc>", "</desc>") ||
            replace(d, &at, "xlink:href='#", "href='#s%u-") ||
            replace(d, &at, "id='", "id='s%u-") || replace(d, &at, "id=\"", "id=\"s%u-"))
            continue;
        is_mark |= d->left && !strncmp(at, "<use ", 5);
        if (is_mark && !strncmp(at, "/>", 2)) {
            putc('>', d->out);
            put_note(d->out, json_array_get(d->picture->shown, d->next++));
            fputs("</use>", d->out);
            d->left--;
            is_mark = 0;
            at += 2;
            continue;
        }
        putc(*at++, d->out);
    }
}

static fp3_status put_picture(FILE *out, const fp3_bench_picture *p, unsigned number,
                              fp3_error *error) {
    char *text = NULL;
    size_t size = 0;
    if (!fp3_bench_drawn(p)) {
        fprintf(out, "<p>No point in %s has an error.</p>\n", p->unit);
        return FP3_OK;
    }
    FILE *to = open_memstream(&text, &size);
    if (!to)
        return fp3_no_memory(error);
    fp3_status status = fp3_gnuplot_write(fp3_bench_script, p, to, error);
    const int is_lost = ferror(to) | fclose(to);
    if (!status && is_lost)
        status = fp3_no_memory(error);
    const char *svg = status ? NULL : strstr(text, "<svg");
    if (!status && !svg)
        status = fp3_fail(error, FP3_E_SYSTEM, "gnuplot has drawn nothing");
    drawing d = {.out = out, .picture = p, .number = number};
    if (!status)
        put_svg(&d, svg);
    free(text);
    return status;
}

/* ---- tables ---- */

static void put_table(FILE *out, const json_t *shown, const char *model) {
    static const char *const heads[] = {"engine", "how", "step", "error", "worst", "ns", "cycles"};
    json_t *point;
    size_t i;
    fputs("<div class=\"wide\"><table>\n<thead><tr>", out);
    for (i = 0; i < sizeof heads / sizeof *heads; i++)
        fprintf(out, "<th scope=\"col\"><button>%s</button></th>", heads[i]);
    fputs("</tr></thead>\n<tbody>\n", out);
    json_array_foreach(shown, i, point) {
        if (strcmp(text_of(point, "model"), model) != 0)
            continue;
        fprintf(out, "<tr><td>%s</td><td>", text_of(point, "curve"));
        put_text(out, text_of(point, "how"));
        fprintf(out, "</td><td>%s</td><td>%.2e</td>", text_of(point, "step"),
                number_of(point, "error"));
        if (json_is_null(json_object_get(point, "worst")))
            fputs("<td>inf</td>", out);
        else
            fprintf(out, "<td>%.2e</td>", number_of(point, "worst"));
        fprintf(out,
                is_time(point) ? "<td>%.4g</td><td></td></tr>\n" : "<td></td><td>%.6g</td></tr>\n",
                number_of(point, "cost"));
    }
    fputs("</tbody></table></div>\n", out);
}

/* ---- the whole ---- */

static fp3_status put_model(FILE *out, const fp3_bench_page *page, const json_t *problem,
                            unsigned number, fp3_error *error) {
    static const char *const units[] = {"ns", "cycles"};
    const char *model = text_of(problem, "model");
    fp3_status status = FP3_OK;
    fprintf(out, "<h2>%s</h2>\n<p>", model);
    put_text(out, text_of(problem, "doc"));
    fprintf(out, "; from 0 to %g.</p>\n", number_of(problem, "span"));
    for (unsigned i = 0; !status && i < 2; i++) {
        const fp3_bench_picture p = {page->path, model, units[i], page->shown};
        status = put_picture(out, &p, 2 * number + i, error);
    }
    put_table(out, page->shown, model);
    return status;
}

static fp3_status put_page(FILE *out, const fp3_bench_page *page, fp3_error *error) {
    fp3_status status = FP3_OK;
    json_t *problem;
    size_t i;
    fputs(HEAD STYLE "<h1>Error against run time</h1>\n<p><code>fp3", out);
    for (int word = 0; word < page->argc; word++)
        put_word(out, word ? page->argv[word] : "bench");
    fputs("</code></p>\n", out);
    put_machine(out);
    fputs("<p>Each object of a model has other values. A curve and the rows of an engine have the "
          "points that are more accurate than all faster ones. The pointer over a point names it; "
          "a click on the head of a column sorts by it.</p>\n" COLUMNS,
          out);
    json_array_foreach(page->problems, i, problem) if (!status) status =
        put_model(out, page, problem, (unsigned)i, error);
    fputs(SCRIPT, out);
    return status;
}

fp3_status fp3_bench_html(const fp3_bench_page *page, fp3_error *error) {
    fp3_output *output = NULL;
    fp3_status status = fp3_output_open(page->path, &output, error);
    if (status)
        return status;
    FP3_HOST;
    status = put_page(fp3_output_stream(output), page, error);
    if (!status)
        status = fp3_output_publish(output, error);
    fp3_output_close(&output);
    return status;
}
