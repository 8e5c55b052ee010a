#!/usr/bin/env python3
"""Creates a procedural town as CityJSON: detached and terraced houses with gabled roofs along streets.

    district_city.py BUILDINGS [SEED] > town.city.json

The same arguments create the same town. It is in UTM zone 32 (EPSG:25832), with bases at 380 m. The
attribute "use" is "public" for each twelfth building and "house" for the others.
"""
import json
import math
import random
import sys

EAST, NORTH, FOOT = 675_000.0, 5_402_000.0, 380.0
STREET, GARDEN = 18.0, 7.0  # between blocks, and between detached houses
A_BLOCK = 10  # buildings per block, in two rows


def house(low, size, eaves, ridge):
    """Returns the vertices and faces of a house with its ridge along the longer side."""
    (x, y), (width, depth) = low, size
    corners = [(x, y), (x + width, y), (x + width, y + depth), (x, y + depth)]
    points = [(a, b, z) for z in (0.0, eaves) for a, b in corners]
    if width >= depth:
        points += [(x, y + depth / 2, ridge), (x + width, y + depth / 2, ridge)]
        roofs, gables = [[4, 5, 9, 8], [6, 7, 8, 9]], [[5, 6, 9], [7, 4, 8]]
    else:
        points += [(x + width / 2, y, ridge), (x + width / 2, y + depth, ridge)]
        roofs, gables = [[5, 6, 9, 8], [7, 4, 8, 9]], [[4, 5, 8], [6, 7, 9]]
    walls = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    faces = [([3, 2, 1, 0], 0)] + [(wall, 1) for wall in walls + gables] + [(roof, 2) for roof in roofs]
    return points, faces


def block(draw, origin, count):
    """Returns the houses of a block in two rows. One block in three has a terrace."""
    is_terrace = draw.random() < 1 / 3
    found = []
    for row in range(2):
        x = origin[0]
        eaves, depth = draw.uniform(5.0, 7.0), draw.uniform(9.0, 11.0)
        for i in range((count + 1 - row) // 2):
            width = draw.uniform(7.0, 9.0) if is_terrace else draw.uniform(9.0, 14.0)
            if not is_terrace:
                eaves, depth = draw.uniform(4.0, 8.0), draw.uniform(9.0, 13.0)
            y = origin[1] + (0.0 if row == 0 else 13.0 + 2 * GARDEN)
            found.append(house((x, y), (width, depth), eaves, eaves + draw.uniform(2.0, 4.0)))
            gap = 0.0 if is_terrace and i % 3 != 2 else GARDEN
            x += width + gap
    return found


def town(count, seed):
    draw = random.Random(seed)
    blocks = math.ceil(count / A_BLOCK)
    across = math.ceil(math.sqrt(blocks / 2))
    houses = []
    for number in range(blocks):
        left = min(A_BLOCK, count - len(houses))
        origin = (number % across * (5 * 14.0 + 4 * GARDEN + STREET),
                  number // across * (26.0 + 2 * GARDEN + STREET))
        houses += block(draw, origin, left)
    return houses


def cityjson(houses):
    vertices, objects = [], {}
    for number, (points, faces) in enumerate(houses):
        first = len(vertices)
        vertices += [[round(1000 * value) for value in point] for point in points]
        objects[f"house_{number:04d}"] = {
            "type": "Building",
            "attributes": {"use": "house" if number % 12 else "public"},
            "geometry": [{
                "type": "Solid", "lod": "2",
                "boundaries": [[[[first + i for i in face]] for face, _ in faces]],
                "semantics": {"surfaces": [{"type": kind} for kind in
                                           ("GroundSurface", "WallSurface", "RoofSurface")],
                              "values": [[kind for _, kind in faces]]}}]}
    return {"type": "CityJSON", "version": "1.1",
            "metadata": {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/25832"},
            "transform": {"scale": [0.001, 0.001, 0.001], "translate": [EAST, NORTH, FOOT]},
            "CityObjects": objects, "vertices": vertices}


if __name__ == "__main__":
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    json.dump(cityjson(town(int(sys.argv[1]), seed)), sys.stdout, separators=(",", ":"))
