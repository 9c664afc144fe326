#!/usr/bin/env python3
"""Writes the FACS, viseme and VRM rows that stand on ARKit shapes, so that one fit serves every vocabulary.

    derive_expressions.py anatomy/data/expressions

figures/expression_derivations.json says which shapes at which weight make a row; rows it does not name keep their own
weights. `mouthSmile` stands for both sides; an action unit's `L` and `R` rows take its left and right channels.
"""
import json
import sys
from pathlib import Path

FIGURES = Path(__file__).resolve().parent.parent.parent / "anatomy/figures"


def combined(recipe, arkit, limits):
    total = {}
    for shape, weight in recipe.items():
        names = [shape] if shape in arkit else [shape + "Left", shape + "Right"]
        for name in names:
            for channel, value in arkit[name].items():
                total[channel] = total.get(channel, 0.0) + weight * value
    return {n: round(max(-limits(n), min(limits(n), v)), 3) for n, v in total.items() if abs(v) >= 0.005}


def write(path, table):
    """One expression a line."""
    lines = ["{"]
    for key, value in table.items():
        if key == "expressions":
            continue
        lines.append(f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)},")
    lines.append('  "expressions": [')
    rows = [f"    {json.dumps(e, ensure_ascii=False)}" for e in table["expressions"]]
    lines.append(",\n".join(rows))
    lines += ["  ]", "}"]
    path.write_text("\n".join(lines) + "\n")


def main(folder):
    arkit = {e["name"]: e["weights"] for e in json.loads((folder / "arkit.json").read_text())["expressions"]}
    tables = json.loads((FIGURES / "expression_derivations.json").read_text())["tables"]
    for file, rows in tables.items():
        path = folder / file
        table = json.loads(path.read_text())
        for entry in table["expressions"]:
            name = entry["name"]
            side = name[0] if file == "facs.json" and name[0] in "LR" else ""
            recipe = rows.get(name, rows.get(name[1:]) if side else None)
            if recipe is None:
                continue
            weights = combined(recipe, arkit, lambda n: 1.0)
            drop = {"L": "_right", "R": "_left"}.get(side)
            entry["weights"] = {n: v for n, v in weights.items() if not drop or not n.endswith(drop)}
        write(path, table)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
