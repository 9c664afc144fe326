#!/usr/bin/env python3
"""paint_head.py FIGURES_FOLDER DATA_FOLDER [SIZE]: paints the generic head's skin from anatomy/figures/head_paint.json and
writes head_skin.jpg (colour), head_skin_normal.jpg (pores and fine folds) and head_skin_roughness.jpg beside head.obj. The same figures give
the same pictures."""

import json
import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from paint import noise
from paint.atlas import Atlas, read_curves, read_landmarks


def smooth(low, high, x):
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def linear(colour):
    return np.power(np.array(colour, np.float32), np.float32(2.2))


def near_polyline(places, line, reach):
    """Distance (mm) of places from a polyline, 99 beyond `reach`."""
    low, high = line.min(0) - reach, line.max(0) + reach
    near = np.all((places > low) & (places < high), axis=1)
    distance = np.full(len(places), 99.0, np.float32)
    distance[near] = to_polyline(places[near], line)[0]
    return distance


def to_polyline(places, line):
    """Nearest distance (mm), share along and signed height above (mm, by +Y) of places from a polyline."""
    places, line = places.astype(np.float32), np.asarray(line, np.float32)
    best = np.full(len(places), 1e9, np.float32)
    along, above = np.zeros(len(places), np.float32), np.zeros(len(places), np.float32)
    lengths = np.linalg.norm(np.diff(line, axis=0), axis=1)
    starts = np.concatenate([[0], np.cumsum(lengths)])
    for k in range(len(line) - 1):
        d = line[k + 1] - line[k]
        low, high = (-1e9 if k == 0 else 0), (1e9 if k == len(line) - 2 else 1)
        raw = (places - line[k]) @ d / (d @ d)
        t = np.clip(raw, 0, 1)
        off = places - (line[k] + t[:, None] * d)
        r = np.linalg.norm(off, axis=1)
        closer = r < best
        best[closer] = r[closer]
        along[closer] = ((starts[k] + np.clip(raw, low, high) * lengths[k]) / starts[-1])[closer]
        above[closer] = off[closer, 1]
    return best, along, above


class Painter:
    def __init__(self, figures, data, size):
        self.figures = json.loads((figures / "head_paint.json").read_text())
        self.atlas = Atlas(data / "head.obj", size)
        self.landmarks = read_landmarks(data / "landmarks.json")
        self.curves = read_curves(data / "landmarks.json")
        self.loops = json.loads((data / "head_regions.json").read_text())["objects"]["skin"]["loops"]
        self.p = self.atlas.place[self.atlas.mask]
        self.half = self.p * np.array([1, 1, 1], np.float32)
        self.half[:, 0] = np.abs(self.half[:, 0])
        self.blood = np.zeros(len(self.p), np.float32)
        self.melanin = np.zeros(len(self.p), np.float32)
        self.height = np.zeros(len(self.p), np.float32)  # mm, of the fine relief
        self.rough = np.full(len(self.p), self.figures["roughness"]["skin"], np.float32)

    def texels(self, *names):
        return self.atlas.is_in(*names)[self.atlas.mask]

    def gather_pigment(self):
        f = self.figures
        for spot in f["flush"]:
            name = spot["at"] if spot["at"] in self.landmarks else spot["at"] + "_left"
            centre = self.landmarks[name] + np.array(spot["offset"])
            r = np.linalg.norm(self.half - centre, axis=1) / spot["radius"]
            r *= 0.8 + 0.4 * noise.layers(self.p, 0.7 * spot["radius"], 11)
            fall = np.exp(-1.4 * r * r)
            self.blood += spot.get("blood", 0) * fall
            self.melanin += spot.get("melanin", 0) * fall
        mottle = f["mottle"]
        self.blood += mottle["blood"] * (noise.layers(self.p, mottle["period"], 21, 5, 0.7) - 0.5)
        self.melanin += mottle["melanin"] * (noise.layers(self.p, 1.7 * mottle["period"], 41, 5, 0.7) - 0.5)
        spots = f["freckles"]
        first, _ = noise.cells(self.p, spots["period"], 61)
        size = 0.05 + 0.11 * noise.value(self.p, spots["period"], 67)
        sparse = noise.value(self.p, 3 * spots["period"], 71) > 1 - 2.2 * spots["share"]
        self.melanin += spots["melanin"] * sparse * smooth(size, 0.55 * size, first)

    def add_beard(self):
        f = self.figures["beard"]
        p, lip = self.half, self.landmarks["stomion"]
        jaw = smooth(-8, -26, p[:, 1]) * smooth(-112, -92, p[:, 1]) * smooth(20, 60, p[:, 2]) * smooth(70, 60, p[:, 0])
        upper = smooth(-9, -13, p[:, 1]) * smooth(34, 26, p[:, 0]) * smooth(-36, -30, p[:, 1])
        cheek = smooth(34, 52, p[:, 0]) * smooth(-6, -30, p[:, 1])
        cover = np.maximum(upper, jaw * np.maximum(smooth(-40, -52, p[:, 1]), cheek))
        cover *= 1 - smooth(4.5, 0.5, np.linalg.norm((p - lip) / np.array([6.2, 2.6, 9]), axis=1))
        first, _ = noise.cells(self.p, 0.8, 81)
        grain = 1 - f["grain"] + f["grain"] * 2 * smooth(0.42, 0.15, first)
        self.melanin += f["melanin"] * cover * grain
        self.blood += f["blood"] * cover

    def skin_colour(self):
        f = self.figures
        base = linear(f["skin"])[None]
        for amount, what in ((self.blood, "blood"), (self.melanin, "melanin")):
            rates = -np.log(1 - np.array(f[what]["absorbs"], np.float32))
            base = base * np.exp(-amount[:, None] * rates[None])
        return base.astype(np.float32)

    def paint_lips(self, colour):
        f = self.figures["lips"]
        border = self.atlas.vertices[self.loops["vermilion_border"]]
        distance = near_polyline(self.p, np.vstack([border, border[:1]]), 8)
        inside = self.texels("lip_")
        signed = np.where(inside, distance, -distance) + 0.7 * (noise.layers(self.p, 1.6, 91) - 0.5)
        near = np.linalg.norm((self.half - self.landmarks["stomion"]) / np.array([36, 20, 26]), axis=1) < 1
        lining = self.texels("mouth_lining")
        cover = np.where(near | lining, smooth(-f["edge"], f["edge"], signed), 0)
        cover = np.where(lining, 1, cover)
        # Creases run across the lip: fine along the mouth, long across it.
        across = np.stack([self.p[:, 0] * 1.0, self.p[:, 1] * 0.16, self.p[:, 2] * 0.16], 1)
        crease = noise.layers(across + 1.2 * (noise.value(self.p, 4, 95) - 0.5)[:, None], f["creases"], 97, 3)
        lip = linear(f["colour"])[None] * (0.80 + 0.40 * crease)[:, None]
        lip = lip * (0.86 + 0.22 * noise.layers(self.p, 5, 99))[:, None]
        self.height += cover * np.where(inside, 0.20, 0) * (crease - 0.5)
        self.lip_cover = np.where(inside, cover, 0)
        return colour * (1 - cover[:, None]) + lip * cover[:, None]

    def paint_linings(self, colour):
        f = self.figures
        mucosa, lining = f["mucosa"], self.texels("mouth_lining")
        depth = smooth(113, 88, self.p[:, 2])[:, None]
        wet = linear(mucosa["colour"])[None] * (1 - depth) + linear(mucosa["deep"])[None] * depth
        wet = wet * (0.75 + 0.5 * noise.layers(self.p, 3, 111, 4, 0.7))[:, None]
        contact = self.atlas.vertices[self.loops["lip_contact"]]
        distance = near_polyline(self.p, np.vstack([contact, contact[:1]]), 8)
        share = (lining * smooth(0, 5, distance))[:, None]
        colour = colour * (1 - share) + wet * share
        nostril = self.texels("nostril")
        rims = np.vstack([self.atlas.vertices[self.loops["nostril_rim_" + side]] for side in ("left", "right")])
        reach = np.zeros(len(self.p), np.float32)
        reach[nostril] = np.min(np.linalg.norm(self.p[nostril][:, None] - rims[None], axis=2), axis=1)
        share = (nostril * smooth(0, f["nostril"]["fade"], reach))[:, None]
        return colour * (1 - share) + linear(f["nostril"]["colour"])[None] * share

    def paint_lids(self, colour):
        f = self.figures
        conjunctiva = self.texels("conjunctiva")
        for side in ("left", "right"):
            inner = self.atlas.vertices[self.loops["lid_margin_inner_" + side]]
            outer = self.atlas.vertices[self.loops["lid_margin_" + side]]
            rim = np.vstack([0.5 * (inner + outer), 0.5 * (inner + outer)[:1]])
            distance = near_polyline(self.p, rim, 4)
            share = (smooth(f["lid_margin"]["width"], 0.35, distance) * 0.85)[:, None]
            colour = colour * (1 - share) + linear(f["lid_margin"]["colour"])[None] * share
            # A dark line where the lashes grow.
            root = smooth(1.5, 0.5, np.abs(distance - 1.1)) * ~conjunctiva * 0.30
            colour = colour * (1 - root[:, None])
        share = conjunctiva[:, None] * 0.9
        return colour * (1 - share) + linear(f["conjunctiva"])[None] * share

    def hair_cover(self):
        """How much of the scalp is hair, 0..1, by the hairline and the ears."""
        f = self.figures["hair"]
        p, line = self.half, self.curves["hairline"]
        # Height above the hairline where there is one, by the angle about the vertical.
        angle = np.arctan2(p[:, 0], p[:, 2] - 5.0)
        at = np.arctan2(line[:, 0], line[:, 2] - 5.0)
        at = np.concatenate([at, [1.62, 1.95, 2.45, np.pi]])
        ear = self.landmarks["otobasion_superius_left"]
        low = np.concatenate([line[:, 1], [ear[1] + 9, f["behind_ear"], f["nape"] + 6, f["nape"]]])
        # The sideburn before the ear.
        burn = smooth(9, 4, np.abs(p[:, 2] - 19)) * smooth(64, 70, p[:, 0])
        edge = np.interp(angle, at, low) - 26 * burn
        ragged = 5 * (noise.layers(self.p, 7, 131, 4, 0.7) - 0.5)
        cover = smooth(-0.15 * f["edge"], f["edge"], p[:, 1] - edge + ragged)
        return cover * ~self.texels("ear_")

    def paint_hair(self, colour):
        f = self.figures["hair"]
        cover = self.hair_cover()
        # Short hairs, seen as grains drawn out downward and outward from the crown.
        crown = np.array([0, 132, -38], np.float32)
        away = self.p - crown
        radius = np.linalg.norm(away, axis=1)
        turn = np.arctan2(away[:, 0], away[:, 2])
        strands = np.stack([turn * np.maximum(radius, 12) / 0.45, radius / 1.3, np.zeros_like(radius)], 1)
        grain = noise.layers(strands.astype(np.float32), 1.0, 141, 3, 0.6)
        patch = noise.layers(self.p, 5, 147, 4, 0.65)
        dense = np.clip(cover * f["cover"] * (1 + f["grain"] * (grain - 0.5) * 1.4 + 0.30 * (patch - 0.5)), 0, 0.96)
        dense = np.where(cover < 0.9, dense * smooth(0.25, 0.62, cover * 0.75 + 0.45 * grain), dense)
        hair = linear(f["colour"])[None] * (0.55 + 0.9 * grain)[:, None]
        self.height += 0.22 * cover * (grain - 0.5)
        self.rough += dense * (self.figures["roughness"]["hair"] - self.rough)
        return colour * (1 - dense[:, None]) + hair * dense[:, None]

    def paint_brows(self, colour):
        f = self.figures["brow"]
        line = self.curves["brow"]
        length = np.sum(np.linalg.norm(np.diff(line, axis=0), axis=1))
        scale, margin = 24, 12  # canvas pixels a millimetre, mm around
        random = np.random.default_rng(7)
        for side in (1.0, -1.0):
            canvas = Image.new("L", (int((length + 2 * margin) * scale), int(4 * margin * scale)), 0)
            pen = ImageDraw.Draw(canvas)
            for _ in range(f["hairs"]):
                s = random.beta(1.05, 1.12) if random.random() < 0.93 else random.uniform(0, 1)
                width = np.interp(s, [0, 0.10, 0.45, 0.8, 1.0],
                                  [f["width_inner"] * 0.62, f["width_inner"], f["width_middle"] * 0.86,
                                   f["width_outer"] * 1.3, f["width_outer"] * 0.4])
                t = np.clip(random.normal(0, 0.26), -0.5, 0.5) * width
                # Inner hairs stand up, then all lean outward; upper ones sink, lower ones rise to the middle line.
                lean = np.interp(s, [0, 0.12, 0.35, 1.0], [78, 52, 24, 4]) - 34 * np.clip(2 * t / width, -1, 1) * smooth(0.1, 0.4, s)
                lean = np.radians(lean + random.normal(0, 9))
                reach = f["length"] * random.uniform(0.55, 1.05) * np.interp(s, [0, 0.15, 0.7, 1], [0.7, 1, 1, 0.7])
                bend = np.radians(random.normal(-12, 8))
                x, y, a = s * length, t, lean
                ink = int(255 * random.uniform(0.55, 1.0))
                for k in range(10):
                    nx, ny = x + 0.1 * reach * np.cos(a), y + 0.1 * reach * np.sin(a)
                    w = max(1, round(f["thickness"] * scale * (1.25 - 0.1 * k)))
                    pen.line([((x + margin) * scale, (2 * margin - y) * scale), ((nx + margin) * scale, (2 * margin - ny) * scale)],
                             fill=int(ink * (1 - 0.05 * k)), width=w)
                    x, y, a = nx, ny, a + 0.1 * bend
            drawn = np.asarray(canvas.resize((canvas.width // 4, canvas.height // 4), Image.BOX), np.float32) / 255
            signed = self.p[:, 0] * side
            near = (signed > 4) & (np.abs(self.p[:, 1] - 58) < 22) & (self.p[:, 2] > 55)
            places = self.p[near] * np.array([side, 1, 1], np.float32)
            distance, along, above = to_polyline(places, line)
            height = np.sign(above) * distance
            beyond = np.maximum(np.abs(along - 0.5) - 0.5, 0) * length
            height = np.where(beyond > 0, above, height)
            u = (along * length + margin) * scale / 4
            v = (2 * margin - height) * scale / 4
            ok = (u > 0) & (u < drawn.shape[1] - 1) & (v > 0) & (v < drawn.shape[0] - 1)
            ink = np.zeros(len(places), np.float32)
            ink[ok] = drawn[v[ok].astype(int), u[ok].astype(int)]
            cover = np.zeros(len(self.p), np.float32)
            cover[near] = np.minimum(ink * 1.05, 0.94)
            shade = np.zeros(len(self.p), np.float32)
            width = np.interp(along, [0, 0.1, 0.45, 0.8, 1], [4, 7.5, 8, 4.5, 2])
            shade[near] = 0.30 * smooth(0.75, 0.2, np.abs(height) / width) * (beyond < 0.5)
            colour = colour * (1 - shade[:, None])
            colour = colour * (1 - cover[:, None]) + linear(f["colour"])[None] * cover[:, None]
            self.height += 0.10 * cover
        return colour

    def add_relief(self):
        f = self.figures
        first, second = noise.cells(self.p, f["pores"]["period"], 151)
        oily = np.exp(-np.sum(((self.half - np.array([12, 4, 112])) / np.array([30, 30, 40])) ** 2, axis=1))
        self.rough += oily * (f["roughness"]["oily"] - f["roughness"]["skin"])
        self.rough += self.lip_cover * (f["roughness"]["lips"] - self.rough)
        deep = f["pores"]["depth"] * (0.55 + 1.1 * oily) * (1 - self.lip_cover)
        self.height -= deep * smooth(0.34, 0.10, first)
        folds, near = noise.cells(self.p * np.array([1, 1.15, 1], np.float32), f["wrinkles"]["period"], 161)
        self.height -= f["wrinkles"]["depth"] * smooth(0.16, 0.0, near - folds) * (1 - self.lip_cover)
        self.height += 0.05 * (noise.layers(self.p, 2.2, 171, 3) - 0.5)

    def normals(self):
        """Tangent-space normals of the relief, glTF's order (green up)."""
        height = np.zeros((self.atlas.size, self.atlas.size, 1), np.float32)
        height[self.atlas.mask] = self.height[:, None]
        height = self.atlas.bleed(height, 4)[..., 0]
        place = self.atlas.bleed(self.atlas.place, 4)
        step_u = np.linalg.norm(np.roll(place, -1, 1) - np.roll(place, 1, 1), axis=2)
        step_v = np.linalg.norm(np.roll(place, -1, 0) - np.roll(place, 1, 0), axis=2)
        ok = self.atlas.mask & (step_u < 3) & (step_v < 3)
        step_u, step_v = np.clip(step_u, 0.15, 3), np.clip(step_v, 0.15, 3)
        slope_u = np.where(ok, (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / step_u, 0)
        slope_v = np.where(ok, (np.roll(height, -1, 0) - np.roll(height, 1, 0)) / step_v, 0)
        n = np.stack([-np.clip(slope_u, -1, 1), np.clip(slope_v, -1, 1), np.ones_like(slope_u)], 2)
        return n / np.linalg.norm(n, axis=2, keepdims=True)

    def paint(self):
        self.gather_pigment()
        self.add_beard()
        colour = self.skin_colour()
        colour = self.paint_lips(colour)
        colour = self.paint_linings(colour)
        colour = self.paint_lids(colour)
        colour = self.paint_hair(colour)
        colour = self.paint_brows(colour)
        self.add_relief()
        picture = np.zeros((self.atlas.size, self.atlas.size, 3), np.float32)
        picture[self.atlas.mask] = np.power(np.clip(colour, 0, 1), 1 / 2.2)
        rough = np.zeros((self.atlas.size, self.atlas.size, 1), np.float32)
        rough[self.atlas.mask] = np.clip(self.rough, 0, 1)[:, None]
        return self.atlas.bleed(picture), self.normals(), self.atlas.bleed(rough)[..., 0]


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    figures, data = Path(sys.argv[1]), Path(sys.argv[2])
    size = int(sys.argv[3]) if len(sys.argv) == 4 else 2048  # texels; 0.2 mm on the face
    colour, normal, rough = Painter(figures, data, size).paint()
    Image.fromarray((colour * 255 + 0.5).astype(np.uint8)).save(data / "head_skin.jpg", quality=86, optimize=True)
    relief = Image.fromarray(((normal * 0.5 + 0.5) * 255 + 0.5).astype(np.uint8))
    relief.save(data / "head_skin_normal.jpg", quality=84, optimize=True)
    gloss = Image.fromarray((rough * 255 + 0.5).astype(np.uint8)).resize((size // 4, size // 4), Image.BOX)
    gloss.save(data / "head_skin_roughness.jpg", quality=88, optimize=True)


if __name__ == "__main__":
    main()
