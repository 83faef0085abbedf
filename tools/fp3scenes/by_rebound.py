"""Stars by REBOUND: double, one thread. Leapfrog, also of higher order, and IAS15, which chooses its steps: there h stands for a tolerance."""

import time

import numpy as np
import rebound


class Stars:
    def __init__(self, problem, method, h, start, _):
        self.problem, self.method, self.h, self.start = problem, method, h, start

    def go(self):
        made, simulation = self.problem.made, rebound.Simulation()
        for (x, y, z), (a, b, c) in zip(*(column.tolist() for column in self.start)):
            simulation.add(m=made["m"], x=x, y=y, z=z, vx=a, vy=b, vz=c)
        integrator, _, order = self.method.partition(" of order ")
        simulation.integrator, simulation.gravity, simulation.softening, simulation.dt = integrator, "basic", made["soft"], self.h
        if order:
            simulation.integrator.order = int(order)
        if integrator == "ias15":
            simulation.integrator.epsilon = self.h ** 7         # its error in a step is of the seventh power
        begin = time.process_time()
        simulation.integrate(self.problem.seconds)
        took = time.process_time() - begin
        self.x, self.velocity = (np.array([getattr(body, name) for body in simulation.particles]) for name in ("xyz", "vxyz"))
        self.steps = simulation.steps_done
        return took


SCENES = {"stars": Stars}
