"""What was measured, beside what particles of water do."""

import numpy as np
from fp3world import scene as ws
from fp3world.physics import relative, row

# Martin and Moyce, Philosophical Transactions of the Royal Society A 244 (1952), table 2: a column twice as high as it is wide.
# Time in widths: t sqrt(2 g/a); where the front is, in widths.
TIMES = [0.41, 0.84, 1.19, 1.43, 1.63, 1.83, 1.98, 2.20, 2.32, 2.51, 2.65, 2.83, 2.98, 3.11, 3.33]
FRONTS = [1.11, 1.22, 1.44, 1.67, 1.89, 2.11, 2.33, 2.56, 2.78, 3.00, 3.22, 3.44, 3.67, 3.89, 4.11]


def dam(lab):
    """Monaghan, Simulating free surface flows with SPH, Journal of Computational Physics 110 (1994)."""
    found, times = lab.record(ws.text_of("dam"), "--every", 20)
    front = np.interp(TIMES, times * np.sqrt(2), found["x_x"].max(1) + 0.025)
    why = "in the experiment a gate had to rise and the floor had friction: water without them is ahead by a sixth of a unit of time, 0.2 widths, and half a particle"
    for k in (5, 9, 14):
        yield row("dam", f"front at {TIMES[k]:g} units of time, in widths of the column", FRONTS[k], front[k], 0.27, why)
    speeds = [np.polyfit(TIMES[5:], one[5:], 1)[0] for one in (FRONTS, front)]
    yield relative("dam", "speed of the front from then on", *speeds, 0.05, "fronts of the table are read off to 0.02 of 2 widths, and the floor has no friction here")
    yield row("dam", "largest change of density", 0, abs(found["rho"] - 1).max(), 0.04, "(v/c)^2/2 of what falls from the top is 0.005; where it hits the corner several times that")
    yield row("dam", "who is below the floor or behind the wall", 0, int(((found["x_x"] < 0) | (found["x_y"] < 0)).any(0).sum()), 0, "a particle is half a width of its own away")
