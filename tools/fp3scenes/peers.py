"""Who steps which scene of curves, by which methods, with which steps. A step is 2^-k s."""

import importlib
import importlib.util

EULER, LEAPFROG, HEUN = "semi_implicit_euler", "leapfrog", "heun"
CHOSEN = {"ias15"}              # which chooses its steps: k stands for a tolerance
# Name: the package that it needs, and of each scene the methods, each with its k.
PEERS = {
    "fp3": ("numpy", {"cloth": {EULER: range(9, 16), HEUN: range(10, 13), "rk4": range(9, 12)},
                      "net": {EULER: range(11, 16), LEAPFROG: range(11, 15), f"{LEAPFROG}, compensated": range(12, 15), "rk4": range(12, 14)},
                      "balls": {EULER: range(7, 14), HEUN: range(7, 13)},
                      "stars": {LEAPFROG: range(3, 10), "rk4": range(3, 7), "rk6": range(3, 6), "rk6, compensated": range(4, 7)},
                      "heap": {EULER: range(8, 14), HEUN: range(8, 12)},
                      "dam": {HEUN: range(8, 13), "rk4": range(8, 11)}}),
    "taichi": ("taichi", {"cloth": {EULER: range(9, 16, 2)}, "net": {EULER: range(11, 16)}, "stars": {LEAPFROG: range(3, 10, 2)}}),
    "warp": ("warp", {"cloth": {EULER: range(9, 14, 2)}, "net": {EULER: range(11, 15)}, "stars": {LEAPFROG: range(3, 8, 2)},
                      "balls": {EULER: range(7, 12, 2)}, "heap": {EULER: range(8, 11)}, "dam": {HEUN: range(8, 11)}}),
    "mujoco": ("mujoco", {"net": {"Euler": range(11, 14), "RK4": range(12, 13)}}),
    "rebound": ("rebound", {"stars": {LEAPFROG: range(3, 10, 2), f"{LEAPFROG} of order 8": range(1, 5), "ias15": range(3)}}),
    "lammps": ("lammps", {"balls": {"verlet": range(7, 12)}, "heap": {"verlet": range(8, 12)}}),
}
QUICK = {"fp3": {"cloth": {EULER: (10, 11)}, "stars": {LEAPFROG: (4, 5)}}, "taichi": {"cloth": {EULER: (10,)}, "stars": {LEAPFROG: (4,)}}}


def ways(name, quick):
    return QUICK.get(name, {}) if quick else PEERS[name][1]


def installed():
    return [name for name, (package, _) in PEERS.items() if importlib.util.find_spec(package)]


def module(name):
    return importlib.import_module(f"fp3scenes.by_{name}")
