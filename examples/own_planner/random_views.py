"""Planner that takes 12 views from random directions around the points measured so far."""
import math
import random


class RandomViews:
    def __init__(self, task):
        self.random = random.Random(task.seed)
        self.view_distance = task.view_distance

    def next_view(self, scan):
        self.low, self.high = scan.low, scan.high
        return None if scan.number + 1 >= 12 else self.next_alternative_view()

    def next_alternative_view(self):
        direction = [self.random.gauss(0, 1) for _ in range(3)]
        length = math.hypot(*direction)
        radius = self.view_distance + math.dist(self.low, self.high) / 2
        position = [(low + high) / 2 - radius * part / length
                    for low, high, part in zip(self.low, self.high, direction)]
        return position, direction
