"""A catapult tries its aims, takes the best, and shoots at a tower. PYTHONPATH=python python3 examples/castle.py"""
import math

import fp3

RING, LAYERS, FRAMES = 12, 8, 240


class Castle:
    def __init__(self):
        self.world = fp3.Bodies(dimensions=3, gravity=(0, -10, 0))
        self.build()

    def build(self):
        """The ground, and a round tower: in each layer bricks stand over the gaps of the layer below."""
        world = self.world
        ground = world.add(type="static")
        world.attach(ground, fp3.plane(friction=0.8))
        turns = [2 * math.pi / RING * (brick + layer / 2) for layer in range(LAYERS) for brick in range(RING)]
        self.start = [(2 * math.cos(turn), 0.25 + 0.5 * (brick // RING), 2 * math.sin(turn)) for brick, turn in enumerate(turns)]
        self.bricks = world.add(x=self.start, q=[(math.cos(turn / 2), 0, -math.sin(turn / 2), 0) for turn in turns])
        world.attach(self.bricks, fp3.box(0.25, 0.25, 0.45))

    def shoot(self, up):
        """A ball of 4 t flies to the tower, and 4 seconds pass."""
        ball = self.world.add(x=(-12, 1, 0.5), v=(28, up, 0), is_fast=True)
        self.world.attach(ball, fp3.sphere(0.5, density=8))
        self.world.step(FRAMES)

    def fallen(self):
        """How many bricks have come down by a layer."""
        return sum(x[1] < start[1] - 0.5 for x, start in zip(self.world.read("x", self.bricks), self.start))

    def best_aim(self):
        """Each aim is tried, and the world goes back."""
        saved, best, most = self.world.save(), 0, -1
        for up in (0, 2, 4, 6):
            self.shoot(up)
            print(f"aim {up}: {self.fallen()} bricks fall")
            if self.fallen() > most:
                best, most = up, self.fallen()
            self.world.restore(saved)
        return best


def main():
    castle = Castle()
    hit = castle.world.ray((-12, 1, 0.5), (24, 0, 0))[0]
    print(f"the tower is {hit['distance']:.3f} m away")
    aim = castle.best_aim()
    castle.shoot(aim)
    print(f"shot with {aim}: {castle.fallen()} of {RING * LAYERS} bricks fell, hash {castle.world.hash:016x}")


if __name__ == "__main__":
    main()
