"""A game: a car drives over a bridge, jumps, knocks boxes down, and reaches a goal. PYTHONPATH=python python3 examples/bridge.py"""
import copy

import fp3

GROUND = [(90, 0), (36, 0), (36, 1), (30, 0), (20, 0), (20, -6), (10, -6), (10, 0), (-10, 0)]
FRAMES, GOAL, BOXES = 540, 70, 12
OTHER, CAR = 1, 2                   # categories: what belongs to the car, and all else
BRAKE, TOLD = range(120, 150), 160  # frames in which the player brakes, and the frame in which the game hears of it


class Game:
    def __init__(self):
        self.world = fp3.Bodies(gravity=(0, -10))
        self.score = {"points": 0, "fallen": set(), "jump": 0.0, "goal": 0}
        self.build()
        self.build_car()

    def build(self):
        """The ground with a ramp, a bridge of ten planks, a pile of boxes, and the goal."""
        world = self.world
        self.ground, self.goal = world.add(type="static"), world.add(type="static", x=(GOAL, 2))
        world.attach(self.goal, fp3.box(0.1, 2, is_sensor=True))
        world.chain(self.ground, GROUND, friction=0.9)
        planks = world.add(x=[(10.5 + plank, -0.1) for plank in range(10)])
        world.attach(planks, fp3.box(0.5, 0.1))
        world.join("hinge", self.ground, planks[0], anchor_a=(10, -0.1), anchor_b=(-0.5, 0))
        world.join("hinge", planks[:-1], planks[1:], anchor_a=(0.5, 0), anchor_b=(-0.5, 0))
        world.join("hinge", self.ground, planks[9], anchor_a=(20, -0.1), anchor_b=(0.5, 0))
        self.boxes = world.add(x=[(54 + box % 3, 0.5 + box // 3) for box in range(BOXES)])
        world.attach(self.boxes, fp3.box(0.49, 0.5, density=0.1))

    def build_car(self):
        """A body and two wheels, each on a spring and with a motor."""
        world = self.world
        self.car = world.add(x=(0, 1))
        world.attach(self.car, fp3.box(1.2, 0.3, density=3, category=CAR))
        wheels = world.add(x=[(-0.8, 0.6), (0.8, 0.6)])
        world.attach(wheels, fp3.circle(0.4, friction=0.9, category=CAR))
        self.motors = [world.join("wheel", self.car, wheel, anchor_a=(side, -0.4), axis=(0, 1), hertz=4, damping=0.7, most=4)[0]
                       for wheel, side in zip(wheels, (-0.8, 0.8))]

    def frame(self, brakes):
        """The player's key goes in, a step is made, and the score comes out."""
        below = self.world.ray(self.world.read("x", self.car), [(0, -20)], mask=OTHER)[0]  # OTHER: the ray begins within the car
        self.score["jump"] = max(self.score["jump"], below["distance"])
        flies = below["distance"] > 1.3  # then wheels that push would turn the car over
        self.world.write_joint("speed", self.motors, 0 if brakes or flies or self.score["goal"] else -40)
        self.world.step()
        for contact in self.world.changes("began"):
            self.touch({contact["body_a"], contact["body_b"]})

    def touch(self, pair):
        """Two bodies have begun to touch: a box that falls to the ground gives points, and the goal ends the race."""
        box = pair & set(self.boxes[3:]) - self.score["fallen"]
        if self.ground[0] in pair and box:
            self.score["points"] += 10
            self.score["fallen"] |= box
        if pair == {self.car[0], self.goal[0]} and not self.score["goal"]:
            self.score["goal"] = round(self.world.time * 60)

    def x(self):
        return self.world.read("x_x", self.car)[0]

    def save(self):
        return self.world.save(), copy.deepcopy(self.score)

    def restore(self, saved):
        self.world.restore(saved[0])
        self.score = copy.deepcopy(saved[1])


def play(game, is_late):
    """A game whose key is known at once, or late: then it plays on as if nobody braked, and once more when it is told."""
    for frame in range(FRAMES):
        if is_late and frame == BRAKE[0]:
            saved = game.save()
        if is_late and frame == TOLD:
            guess = game.x()
            game.restore(saved)
            for again in range(BRAKE[0], TOLD):
                game.frame(again in BRAKE)
            print(f"frame {TOLD}: the car is at {guess:.3f} by guess, at {game.x():.3f} as played")
        game.frame(frame in BRAKE and not is_late)


def main():
    games = {"here": Game(), "there": Game()}
    for name, game in games.items():
        play(game, name == "there")
    for name, game in games.items():
        score = game.score
        print(f"{name}: {score['points']} points, {score['jump']:.3f} m high, goal in frame {score['goal']}, hash {game.world.hash:016x}")


if __name__ == "__main__":
    main()
