"""How much memory a command takes at most. A process's peak begins with that of the process that started it: here a small one."""

import subprocess
import sys

MEASURE = """import resource, subprocess, sys
resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
done = subprocess.run(sys.argv[1:], capture_output=True, text=True)
sys.stderr.write(done.stderr)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(done.returncode)"""


def run(command, **options):
    """What subprocess.run gives, and bytes. What the command prints is dropped."""
    done = subprocess.run([sys.executable, "-c", MEASURE, *map(str, command)], capture_output=True, text=True, **options)
    return done, 1024 * int(done.stdout)
