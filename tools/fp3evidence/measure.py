"""Measures figures: what is exact or an error two at a time, then times one by one, so that nothing of ours runs beside them."""

import os
import pathlib
import resource
import shlex
import signal
import subprocess
import sys
import time

import bench
from fp3evidence import figures as fig
from fp3evidence import inputs, probes

AT_A_TIME = 2
LOGS = probes.KEPT.parent       # what commands say
PATIENCE = 20                   # seconds to stop in
TAIL = 5                        # lines of a command that failed


def say(text):
    print(f"evidence: {text}", file=sys.stderr, flush=True)


def minutes_of(figure, records):
    """Of its command: what it took last, unless other work ran beside it; else what the description says."""
    known = records.get(figure.name, {})
    return known["seconds"] / 60 if "seconds" in known and (known.get("load") or 0) <= fig.IDLE else figure.minutes


class Job:
    """A command, and all figures that it measures: it writes them all."""

    def __init__(self, figures, records):
        self.figures, self.minutes = figures, max(minutes_of(figure, records) for figure in figures)
        self.command, self.log = figures[0].command, LOGS / f"{figures[0].name}.txt"
        self.target = shlex.split(self.command)[:2]                     # of which two would write the same results
        self.is_timed = any(figure.kind == "time" for figure in figures)
        self.name = ", ".join(figure.name for figure in figures)

    def start(self, fp3):
        self.before = {figure.name: inputs.now(figure, fp3) for figure in self.figures}
        self.date, self.begin, self.busy = time.strftime("%Y-%m-%d"), time.monotonic(), busy()
        self.process = start(self.command, self.log, "wb")

    def load(self):
        """Processors that others have kept busy since it began."""
        return max(0.0, (busy() - self.busy) / (time.monotonic() - self.begin))


def busy():
    """Seconds that all processors have worked for others: not for commands that have ended."""
    tick, mine = os.sysconf("SC_CLK_TCK"), resource.getrusage(resource.RUSAGE_CHILDREN)
    user, nice, system, _, _, irq, soft, steal = map(int, pathlib.Path("/proc/stat").read_text(encoding="ascii").split()[1:9])
    return (user + nice + system + irq + soft + steal) / tick - mine.ru_utime - mine.ru_stime


def start(command, log, mode):
    """As if nobody had called make before; in a session of its own, so that Ctrl-C does not end it before us."""
    mine = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    log.parent.mkdir(parents=True, exist_ok=True)
    with open(log, mode) as file:
        return subprocess.Popen(shlex.split(command), cwd=fig.ROOT, env=mine, stdin=subprocess.DEVNULL, stdout=file, stderr=file, start_new_session=True)


def stop(processes):
    """With all that they have started."""
    for kind in (signal.SIGINT, signal.SIGKILL):
        going = [process for process in processes if process.poll() is None]
        for process in going:
            os.killpg(process.pid, kind)
        end = time.monotonic() + PATIENCE
        while any(process.poll() is None for process in going) and time.monotonic() < end:
            time.sleep(0.1)


def run(command, log, mode="ab"):
    """Why it failed, or nothing."""
    process = start(command, log, mode)
    try:
        code = process.wait()
    except KeyboardInterrupt:
        stop([process])
        raise
    return failure(command, code, log) if code else None


def failure(command, code, log):
    last = log.read_text(encoding="utf-8", errors="replace").splitlines()[-TAIL:]
    return "\n".join([f"`{command}`: exit code {code}, {log}", *(f"    {line}" for line in last)])


def machine():
    return f"{os.cpu_count()} processors, {bench.processor()}"


def finish(job, code, fp3):
    """Makes the pages and records the figures. Why not, or nothing."""
    load, seconds = job.load(), time.monotonic() - job.begin
    if code:
        return failure(job.command, code, job.log)
    for report in dict.fromkeys(figure.report for figure in job.figures if figure.report):
        if why := run(report, job.log):
            return why
    inputs.forget()
    found = fig.records()
    for figure in job.figures:
        now = inputs.now(figure, fp3)
        # Of a probe that could not be asked before the command had built it, the answer after it counts.
        if any(job.before[figure.name][name] not in (None, now[name]) for name in now):
            return f"{figure.name}: its inputs have changed while it was measured"
        found[figure.name] = {"revision": bench.said("git", "rev-parse", "--short", "HEAD"), "date": job.date, "machine": machine(),
                              **({"load": round(load, 2)} if figure.kind == "time" else {}), "seconds": round(seconds), "inputs": now}
    fig.record(found)
    return None


def may_start(job, running, waiting):
    """Alone, or one of two that write different results; not before what it needs has ended."""
    if any(figure.after == other.name for figure in job.figures for one in (*running, *waiting) for other in one.figures):
        return False
    return not running or not job.is_timed and len(running) < AT_A_TIME and all(not one.is_timed and one.target != job.target for one in running)


def measure_all(jobs, prepare, fp3):
    """Yields what failed; the others go on."""
    waiting = sorted(jobs, key=lambda job: (job.is_timed, 0 if job.is_timed else -job.minutes))
    running, begun, begin = [], 0, time.monotonic()
    if prepare:
        say(f"`{prepare}`")
        if why := run(prepare, LOGS / "prepare.txt", "wb"):
            say(why)
            yield why
            return
    try:
        while waiting or running:
            for job in [job for job in waiting if may_start(job, running, waiting)][:1]:
                waiting.remove(job)
                begun += 1
                say(f"{begun} of {len(jobs)}: {job.name}, about {job.minutes:.2g} min; {(time.monotonic() - begin) / 60:.0f} min so far, "
                    f"about {minutes([job, *running, *waiting]):.0f} to go")
                job.start(fp3)
                running.append(job)
            ended = [job for job in running if job.process.poll() is not None]
            for job in ended:
                running.remove(job)
                why = finish(job, job.process.returncode, fp3)
                say(why or f"{job.name}: {(time.monotonic() - job.begin) / 60:.1f} min")
                if why:
                    yield why
            if not ended and not (waiting and any(may_start(job, running, waiting) for job in waiting)):
                time.sleep(0.2)
    finally:
        stop([job.process for job in running])


def minutes(jobs):
    """Until all are done: two at a time but for times."""
    both = sorted(job.minutes for job in jobs if not job.is_timed)
    return sum(job.minutes for job in jobs if job.is_timed) + max([sum(both) / AT_A_TIME, *both[-1:]])
