"""Street and garden furniture of our own. Metres; fronts look to -y."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw

import ground_patterns as ground
from patterns import label, noise, picture, wood
from shapes import Mesh, block, bulge, disc, lathe, material, moved, panel, spline, tube

STEEL = material("#8b9094", 0.35, 0.7)
DARK = material("#34383c", 0.5, 0.3)
STONE = material("#a8a49a", 0.9)


def picket_fence(color: str = "#e9e7e0", high: float = 0.95) -> list[Mesh]:
    """1.8 m of pickets on two rails; in rows the posts at the west ends meet the next piece."""
    paint = material(color, 0.7)
    parts = [moved(block((1.8, 0.035, 0.07), paint), (0, 0.02, z)) for z in (0.25, high - 0.25)]
    parts += [moved(block((0.09, 0.09, high + 0.05), paint), (s * 0.855, 0.02, (high + 0.05) / 2)) for s in (-1, 1)]
    parts += [moved(block((0.13, 0.13, 0.03), paint), (s * 0.835, 0.0, high + 0.06)) for s in (-1, 1)]
    for x in np.linspace(-0.72, 0.72, 13):
        parts.append(moved(block((0.075, 0.022, high - 0.1), paint), (x, -0.012, (high - 0.1) / 2 + 0.05)))
        tip = moved(disc(0.053, 0.022, paint, sides=4), (0, 0, 0), "x", 90)
        parts.append(moved(tip, (x, 0.0, high - 0.05)))
    return parts


def board_fence(
    low: tuple[int, int, int] = (92, 66, 44), high: tuple[int, int, int] = (150, 114, 80), tall: float = 1.6
) -> list[Mesh]:
    """1.8 m of upright boards, close together, of slightly different height."""
    rng = np.random.default_rng(41)
    grain = material(rough=0.9, image=wood(low, high, seed=43))
    parts = [moved(block((0.1, 0.1, tall), grain, tile=0.8), (s * 0.85, 0.05, tall / 2)) for s in (-1, 1)]
    parts += [moved(block((1.8, 0.04, 0.09), grain, tile=0.8), (0, 0.03, z)) for z in (0.3, tall - 0.3)]
    for k, x in enumerate(np.linspace(-0.83, 0.83, 13)):
        board = block((0.132, 0.022, tall - 0.08 + rng.uniform(-0.012, 0.012)), grain, tile=0.8)
        board.visual.uv = board.visual.uv + [0.17 * k, 0.23 * k]
        parts.append(moved(board, (x, 0.0, tall / 2)))
    return [*parts, moved(block((1.8, 0.1, 0.03), grain, tile=0.8), (0, 0.01, tall - 0.015))]


def garden_wall(high: float = 0.8) -> list[Mesh]:
    """2 m of low brick wall with a stone coping."""
    body = moved(block((2.0, 0.24, high - 0.08), material(rough=0.95, image=ground.bricks()), tile=2.0), (0, 0, (high - 0.08) / 2))
    return [body, *(moved(block((0.499, 0.32, 0.08), STONE, 0.012), (x, 0, high - 0.04)) for x in (-0.75, -0.25, 0.25, 0.75))]


def picnic_table() -> list[Mesh]:
    """A table of planks with two benches on one frame of A shape."""
    plank = material(rough=0.8, image=wood((112, 74, 44), (172, 124, 80), seed=47))

    def board(size: tuple[float, float, float], at: tuple[float, float, float], about: str = "", degrees: float = 0.0) -> Mesh:
        mesh = block(size, plank, tile=0.7)
        mesh.visual.uv = mesh.visual.uv[:, ::-1] + [at[1] * 3, at[0]]
        return moved(mesh, at, about, degrees)

    parts = [board((1.6, 0.136, 0.04), (0, y, 0.73)) for y in np.linspace(-0.29, 0.29, 5)]
    parts += [board((1.6, 0.13, 0.04), (0, s * y, 0.44)) for s in (-1, 1) for y in (0.56, 0.69)]
    for x in (-0.58, 0.58):
        parts.append(board((0.045, 0.7, 0.09), (x, 0, 0.665)))
        parts.append(board((0.045, 1.5, 0.09), (x + 0.045, 0, 0.375)))
        parts += [board((0.045, 0.09, 0.745), (x, s * 0.36, 0.359), "x", s * 24) for s in (-1, 1)]
    return parts


def planter(long: float = 1.1) -> list[Mesh]:
    """A concrete trough with earth and flowers."""
    rng = np.random.default_rng(51)
    stone = material(rough=0.95, image=picture(ground.concrete()[:256, :256]))
    walls = [moved(block((long, 0.05, 0.42), stone, tile=0.8), (0, s * 0.2, 0.21)) for s in (-1, 1)]
    walls += [moved(block((0.05, 0.35, 0.42), stone, tile=0.8), (s * (long / 2 - 0.025), 0, 0.21)) for s in (-1, 1)]
    parts = [*walls, moved(block((long - 0.1, 0.35, 0.05), material("#4a3524", 1.0)), (0, 0, 0.35))]
    from greenery import cards, leaves

    places = np.c_[rng.uniform(-long / 2 + 0.14, long / 2 - 0.14, 70), rng.uniform(-0.13, 0.13, 70), rng.uniform(0.4, 0.5, 70)]
    green = material(rough=0.9, image=leaves("laurel", 60, 0.3, 0.1, 128, seed=52))
    parts.append(cards(places, rng.normal(size=places.shape) * 0.6 + [0, 0, 1], 0.2, green, (0, 0, 0.1)))
    for color, seed in (("#c8323c", 53), ("#e6b422", 54), ("#d9d4e6", 55)):
        at = places[seed % 3 :: 3][:14] + [0, 0, 0.07]
        blooms = [moved(bulge((0.055, 0.055, 0.035), (1.0, 1.0), material(color, 0.7), 6), p) for p in at]
        parts += blooms
    return parts


def bollard() -> list[Mesh]:
    """A dark steel post with a rounded head and white bands that reflect."""
    rim = [
        (0.0, 0.0),
        (0.095, 0.0),
        (0.095, 0.03),
        (0.062, 0.05),
        (0.058, 0.78),
        (0.07, 0.8),
        (0.07, 0.83),
        (0.055, 0.88),
        (0.0, 0.91),
    ]
    bands = [moved(disc(0.0605, 0.06, material("#e8e8e2", 0.25), sides=24), (0, 0, z)) for z in (0.58, 0.68)]
    return [lathe(rim, DARK, 24), *bands]


def _post_sign(face: Image.Image, sides: int, wide: float, middle: float, start: float) -> list[Mesh]:
    """A plate with `sides` corners, `wide` across, on a steel post; its face looks to -y."""
    post = disc(0.03, middle + wide / 2 + 0.03, STEEL, sides=14)
    foot = disc(0.1, 0.04, STONE, 0.01, 20)
    radius = wide / 2 / np.cos(np.pi / sides)
    angle = start + np.linspace(0, 2 * np.pi, sides + 1)[:-1]
    ring = np.c_[radius * np.cos(angle), np.zeros(sides), radius * np.sin(angle)]
    vertices = np.vstack([[0, 0, 0], ring]) + [0, -0.042, middle]
    faces = [[0, 1 + k, 1 + (k + 1) % sides] for k in range(sides)]
    uv = np.vstack([[0, 0], ring[:, [0, 2]]]) / (2 * radius * max(np.abs(np.cos(angle)).max(), np.abs(np.sin(angle)).max())) + 0.5
    from shapes import dressed

    front = dressed(Mesh(vertices, faces, process=False), material(rough=0.35, image=face), uv)
    back = dressed(Mesh(vertices + [0, 0.008, 0], [f[::-1] for f in faces], process=False), material("#9a9ea2", 0.5, 0.4))
    clip = [moved(block((0.08, 0.03, 0.05), STEEL), (0, -0.025, middle + s * 0.15)) for s in (-1, 1)]
    return [post, foot, front, back, *clip]


def parking_sign() -> list[Mesh]:
    """A blue square with a white P."""
    face = label(256, 256, "#1c4f9c", "#f4f4f0", [("P", 0.78, 0.5)])
    ImageDraw.Draw(face).rounded_rectangle([6, 6, 249, 249], 22, outline="#f4f4f0", width=8)
    return _post_sign(face, 4, 0.5, 2.1, np.pi / 4)


def stop_sign() -> list[Mesh]:
    """A red octagon with a white rim and STOP."""
    face = label(256, 256, "#f0eeea", "#f4f4f0", [])
    angle = np.pi / 8 + np.linspace(0, 2 * np.pi, 9)[:-1]
    corners = [(128 + 128 * c, 128 + 128 * s) for c, s in zip(np.cos(angle), np.sin(angle), strict=True)]
    ImageDraw.Draw(face).polygon(corners, fill="#b3161c")
    words = label(200, 90, "#b3161c", "#f6f4f0", [("STOP", 0.85, 0.5)])
    face.paste(words, (28, 83))
    return _post_sign(face, 8, 0.62, 2.15, np.pi / 8)


def bus_shelter() -> list[Mesh]:
    """A shelter open to -y: posts, panes, a flat roof, a bench and a timetable."""
    w, d, h = 2.8, 1.3, 2.35
    pane = material("#a9c3c9", 0.08, 0.1)
    pane.baseColorFactor = [*pane.baseColorFactor[:3], 0.5]
    pane.alphaMode = "BLEND"
    parts = [
        moved(block((0.07, 0.07, h), DARK), (sx * (w / 2 - 0.1), sy, h / 2))
        for sx in (-1, 1)
        for sy in (-d / 2 + 0.25, d / 2 - 0.1)
    ]
    parts.append(moved(block((w, d, 0.09), DARK, 0.02), (0, 0, h + 0.04)))
    parts.append(moved(block((w - 0.3, 0.012, 1.75), pane), (0, d / 2 - 0.1, 1.2)))
    parts += [moved(block((0.012, d - 0.42, 1.75), pane), (s * (w / 2 - 0.1), 0.06, 1.2)) for s in (-1, 1)]
    parts += [moved(block((w - 0.26, 0.035, 0.045), DARK), (0, d / 2 - 0.1, z)) for z in (0.3, 2.08)]
    parts += [moved(block((0.035, 0.045, 1.75), DARK), (x, d / 2 - 0.1, 1.2)) for x in (-0.44, 0.44)]
    seat = material(rough=0.7, image=wood((120, 82, 48), (178, 132, 86), seed=57))
    parts += [moved(block((1.7, 0.109, 0.035), seat, 0.004, tile=0.7), (-0.2, y, 0.46)) for y in (0.14, 0.25, 0.36)]
    parts += [moved(block((0.05, 0.3, 0.44), DARK), (x, 0.25, 0.22)) for x in (-0.85, 0.45)]
    lines = [("BUS", 0.13, 0.1), *((f"{6 + k}  10  25  40  55", 0.06, 0.26 + 0.075 * k) for k in range(9))]
    board = material(rough=0.4, image=label(160, 256, "#f2efe2", "#22364e", lines))
    parts.append(moved(block((0.5, 0.03, 0.8), DARK), (1.0, d / 2 - 0.13, 1.5)))
    parts.append(moved(moved(panel(0.44, 0.72, board), (0, 0, 0), "x", 90), (1.0, d / 2 - 0.148, 1.5)))
    name = material(rough=0.4, image=label(256, 32, "#24588a", "#f6f4ee", [("MARKET STREET", 0.7, 0.5)]))
    return [*parts, moved(moved(panel(1.6, 0.1, name), (0, 0, 0), "x", 90), (0, -d / 2 - 0.002, h + 0.04))]


def playground_slide() -> list[Mesh]:
    """A slide of 1.3 m with a ladder at +y; children come down to -y."""
    red, blue, yellow = material("#c23a2c", 0.4), material("#2a66a8", 0.45), material("#e4b332", 0.4)
    path = spline([(0, 0.55, 1.3), (0, 0.4, 1.27), (0, -0.3, 0.62), (0, -0.85, 0.24), (0, -1.15, 0.2)], 22)
    parts: list[Mesh] = []
    for a, b in zip(path[:-1], path[1:], strict=True):
        long, pitch = float(np.linalg.norm(b - a)), np.degrees(np.arctan2(a[2] - b[2], a[1] - b[1]))
        parts.append(moved(block((0.44, long + 0.012, 0.02), yellow), (a + b) / 2, "x", pitch))
    parts += [tube(path + [s * 0.235, 0, 0.08], 0.035, red, 8) for s in (-1, 1)]
    parts.append(moved(block((0.5, 0.42, 0.04), blue, 0.01), (0, 0.74, 1.28)))
    for s in (-1, 1):
        rail = [(s * 0.25, 1.15, 0.0), (s * 0.25, 0.98, 1.25), (s * 0.25, 0.9, 1.75), (s * 0.25, 0.7, 1.82), (s * 0.25, 0.5, 1.32)]
        parts.append(tube(spline(rail, 24), 0.022, blue, 8))
        parts.append(tube([(s * 0.25, 0.56, 1.27), (s * 0.27, 0.5, 0.6), (s * 0.28, 0.44, 0.0)], 0.022, blue, 8))
        parts.append(tube([(s * 0.21, -0.95, 0.2), (s * 0.21, -0.96, 0.1), (s * 0.21, -0.97, 0.0)], 0.02, blue, 8))
    return [
        *parts,
        *(
            tube([(-0.25, y, z), (0, y, z), (0.25, y, z)], 0.018, yellow, 8)
            for y, z in ((1.11, 0.27), (1.08, 0.53), (1.04, 0.79), (1.0, 1.05))
        ),
    ]


def sandbox() -> list[Mesh]:
    """A square of boards filled with sand, with a seat at each corner."""
    plank = material(rough=0.85, image=wood((120, 84, 52), (180, 136, 92), seed=59))
    sand = picture(
        np.array((206, 182, 134))
        * (0.8 + 0.2 * noise(128, 60, 5, 8) + 0.1 * np.random.default_rng(61).random((128, 128)))[..., None]
    )
    parts = [moved(block((1.6, 0.05, 0.26), plank, tile=0.7), (0, s * 0.775, 0.13)) for s in (-1, 1)]
    parts += [moved(block((0.05, 1.5, 0.26), plank, tile=0.7), (s * 0.775, 0, 0.13)) for s in (-1, 1)]
    parts += [moved(block((1.6, 0.2, 0.03), plank, tile=0.7), (0, s * 0.72, 0.275)) for s in (-1, 1)]
    heap = moved(
        bulge((0.7, 0.6, 0.24), (1.0, 1.0), material(rough=1.0, image=Image.fromarray(np.asarray(sand))), 16, 2.0),
        (0.25, 0.2, 0.13),
    )
    return [*parts, moved(block((1.5, 1.5, 0.14), material(rough=1.0, image=sand), tile=0.6), (0, 0, 0.07)), heap]


def letter_box(color: str = "#b8212a") -> list[Mesh]:
    """A round post box with a slot, a door and a cap."""
    paint, black = material(color, 0.4), material("#1d1f22", 0.6)
    rim = [
        (0.0, 0.0),
        (0.25, 0.0),
        (0.25, 0.12),
        (0.225, 0.14),
        (0.225, 1.15),
        (0.265, 1.18),
        (0.265, 1.22),
        (0.2, 1.29),
        (0.0, 1.33),
    ]
    parts = [lathe(rim, paint, 32), lathe([(0.252, 0.0), (0.252, 0.1)], black, 32)]
    parts.append(moved(block((0.24, 0.06, 0.035), black, 0.01), (0, -0.215, 1.03)))
    parts.append(moved(block((0.26, 0.05, 0.02), paint), (0, -0.22, 1.06)))
    parts.append(moved(block((0.24, 0.03, 0.42), paint, 0.01), (0, -0.215, 0.62)))
    plate = material(rough=0.6, image=label(96, 64, "#f1eee2", "#333", [("MAIL", 0.5, 0.32), ("9.00  17.00", 0.26, 0.72)]))
    parts.append(moved(moved(panel(0.15, 0.1, plate), (0, 0, 0), "x", 90), (0, -0.2325, 0.88)))
    return [*parts, moved(disc(0.014, 0.02, STEEL, 0.003, 12), (0.08, -0.225, 0.62), "x", 90)]


def newspaper_kiosk() -> list[Mesh]:
    """A green kiosk with a counter, shutters, papers and a striped edge."""
    green, cream = material("#2f5a48", 0.5), material("#e6dcc2", 0.7)
    w, d, h = 2.0, 1.5, 2.3
    parts = [moved(block((w, d, 1.0), green), (0, 0, 0.5)), moved(block((w - 0.06, d - 0.06, 1.3), cream), (0, 0, 1.6))]
    parts += [
        moved(block((0.09, 0.09, h), green), (sx * (w / 2 - 0.045), sy * (d / 2 - 0.045), h / 2))
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    parts.append(moved(block((w + 0.3, d + 0.3, 0.12), green, 0.03), (0, 0, h + 0.06)))
    parts.append(moved(block((w - 0.3, d - 0.3, 0.16), green, 0.04), (0, 0, h + 0.2)))
    rng = np.random.default_rng(63)
    papers = np.full((128, 192, 3), 34.0)
    for row in (8, 48, 88):
        for x in range(8, 180, 26):
            papers[row : row + 32, x : x + 22] = rng.uniform(90, 235, 3)
            papers[row + 3 : row + 8, x + 2 : x + 20] = rng.choice([30.0, 240.0])
            papers[row + 12 : row + 26, x + 3 : x + 19] *= rng.uniform(0.5, 0.9)
    shelf = material(rough=0.5, image=picture(papers))
    parts.append(moved(moved(panel(1.6, 1.0, shelf), (0, 0, 0), "x", 90), (0, -d / 2 + 0.025, 1.62)))
    parts.append(moved(block((1.84, 0.14, 0.05), cream, 0.01), (0, -d / 2 - 0.05, 1.02)))
    name = material(rough=0.5, image=label(256, 40, "#e6dcc2", "#2b3a30", [("NEWS  &  TEA", 0.75, 0.5)]))
    return [*parts, moved(moved(panel(1.5, 0.2, name), (0, 0, 0), "x", 90), (0, -d / 2 + 0.02, 2.2))]


MAKERS = {n: f for n, f in list(globals().items()) if getattr(f, "__module__", "") == __name__ and not n.startswith("_")}
