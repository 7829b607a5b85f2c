#!/usr/bin/env python3
"""Writes docs/accuracy.md and docs/stability.md from the measurements in docs/measured.

    tools/measured_docs.py                 writes both
    tools/measured_docs.py --check         fails if they are not what the measurements give
    tools/measured_docs.py --runs FOLDER   first takes docs/measured/predictions.json anew from the runs in FOLDER/*/

The measurements come from (any machine; docs/accuracy.md says which one these are of):

    ./sunder validate --json docs/measured/catalogue.json --svg docs/pictures/accuracy.svg
    ./sunder validate --hard --json docs/measured/stability.json
    ./sunder bench switch --json docs/measured/switches.json
    ./sunder accuracy SCENE --out out/x, and then out/x/accuracy.json as docs/measured/scene_<name>.json
"""
import json
import math
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MEASURED = ROOT / "docs" / "measured"


def load(name):
    return json.loads((MEASURED / name).read_text())


def number(x, digits=3):
    if x is None:
        return "–"
    if x != 0 and (abs(x) < 1e-3 or abs(x) >= 1e5):
        return f"{x:.{max(1, digits - 1)}e}"
    return f"{x:.{digits}g}"


def machine_of(data):
    m = data["machine"]
    return f"{m['processor']}, {m['threads']} threads, {m['memory_gb']:.0f} GB; version {m['version']} ({m['git'].split('-')[0]})"


def table(head, align, rows):
    lines = ["| " + " | ".join(head) + " |", "| " + " | ".join(align) + " |"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def escaped(text):
    return text.replace("|", "\\|")


def scenes():
    return [json.loads(file.read_text()) for file in sorted(MEASURED.glob("scene_*.json"))]


def plain(hit):
    return [r for r in hit["rungs"] if r["variant"] == "quadratic"]


def mean(values):
    values = [v for v in values if v is not None]
    return sum(values) / len(values) if values else None


def catalogue_tables(data):
    rows = []
    for p in data["problems"]:
        rows.append(
            [p["id"], escaped(p["title"]), escaped(p["tightest"]), number(p["error"]), number(p["bound"]), p["verdict"],
             f"{p['seconds']:.1f}", number(p["particle_steps"], 2), f"{p['memory_mb']:.0f}"])
    text = table(["", "problem", "tightest check", "error", "bound", "verdict", "s", "particle-steps", "MB"],
                 ["---", "---", "---", "---:", "---:", "---", "---:", "---:", "---:"], rows)
    studies = []
    for p in data["problems"]:
        s = p["study"]
        if not s:
            continue
        errors = ", ".join(f"{q['resolution']}: {number(q['error'])}" for q in s["points"])
        halves = f"{2 ** s['cost_exponent']:.1f} times" if s["least_order"] is not None else "no order by design"
        order = number(s["order"]) if s["least_order"] is not None else "–"
        studies.append([p["id"], escaped(s["error"]), escaped(s["size"]), errors, order, halves])
    return text, table(["", "error", "resolution", "errors", "order", "time for half the error"],
                       ["---", "---", "---", "---", "---:", "---"], studies)


def level_rows(all_scenes):
    rows = []
    for particles in (5000, 10000, 20000, 40000, 80000, 160000):
        hits = [h for s in all_scenes for h in s["hits"]]
        rungs = [[r for r in plain(h) if r["particles"] == particles] for h in hits]
        finest = [h["rungs"][0] for h in hits]
        if not any(rungs) or all(f["particles"] <= particles for f in finest):
            continue
        pairs = [(r, f) for rs, f in zip(rungs, finest) for r in rs if f["particles"] > particles]
        rows.append([
            f"{particles}",
            number(mean([r["processor_seconds"] for r, f in pairs])),
            number(mean([r["peak_memory_mb"] for r, f in pairs])),
            number(mean([r["to_finest"]["crack_mean"] for r, f in pairs])),
            number(mean([r["to_finest"]["damage"] for r, f in pairs])),
            number(mean([r["to_finest"]["volumes"] for r, f in pairs])),
            number(mean([abs(r["fragments"] / f["fragments"] - 1) for r, f in pairs])),
            number(mean([abs(r["crack_area"] / f["crack_area"] - 1) for r, f in pairs if f["crack_area"] > 0])),
            number(mean([abs(r["peak_force"] / f["peak_force"] - 1) for r, f in pairs])),
            number(mean([abs(r["impulse"] / f["impulse"] - 1) for r, f in pairs])),
        ])
    return rows


def scene_section(scene):
    text = ""
    for hit in scene["hits"]:
        finest = hit["rungs"][0]
        text += f"### {scene['scene']}: {hit['body']}, {finest['particles']} particles at the finest\n\n"
        rows = []
        for c in hit["convergence"]:
            if not c["difference"]:
                continue
            rows.append([c["quantity"], c["unit"], number(c["difference"][0]), number(c["difference"][-1]),
                         number(c["between_seeds"]), number(c["order"]) if c["converges"] else "–",
                         "yes" if c["converges"] else "no"])
        first, last = hit["convergence"][0]["particles"][0], hit["convergence"][0]["particles"][-1]
        text += table(["quantity", "unit", f"at {first:.0f}", f"at {last:.0f}", "between seeds", "order", "converges"],
                      ["---", "---", "---:", "---:", "---:", "---:", "---"], rows)
        front = [r for r in hit["rungs"] if r["pareto"]]
        text += "\nNothing is nearer in less time than: " + ", ".join(
            f"{r['particles']} particles ({r['variant'].replace('_', ' ')}, {number(r['processor_seconds'])} s)"
            for r in sorted(front, key=lambda r: r["processor_seconds"])) + ".\n\n"
    return text


def switch_table(data):
    by = {}
    order = []
    for scene in data["scenes"]:
        for row in scene["rows"]:
            key = (row["switch"], row["setting"])
            if key not in by:
                by[key] = []
                order.append(key)
            by[key].append(row)
    rows = []
    for key in order:
        group = by[key]
        rows.append([key[0], key[1], number(math.exp(mean([math.log(r["time"]) for r in group])), 2),
                     number(mean([r["crack_mean"] for r in group])), number(mean([r["damage"] for r in group])),
                     ", ".join(str(r["pieces"]) for r in group), number(mean([r["peak_force"] for r in group]))])
    names = ", ".join(s["scene"] for s in data["scenes"])
    return names, table(["switch", "setting", "time", "cracks moved [diagonal]", "cells changed", "pieces", "peak force"],
                        ["---", "---", "---:", "---:", "---:", "---", "---:"], rows)


def prediction_table(data):
    rows = []
    for r in data["runs"]:
        row = [r["scene"], r["quality"]]
        for key in ["processor_seconds", "seconds", "peak_memory_mb"]:
            row += [number(r["predicted"][key]), number(r[key]), number(r["predicted"][key] / r[key], 2)]
        rows.append(row)
    return table(["scene", "quality", "processor [s]: predicted", "took", "ratio", "clock [s]: predicted", "took", "ratio",
                  "memory [MB]: predicted", "took", "ratio"], ["---", "---"] + ["---:"] * 9, rows)


def converging(all_scenes):
    """In how many of the fractures each quantity converges."""
    hits = [h for s in all_scenes for h in s["hits"]]
    counts = {}
    for h in hits:
        for c in h["convergence"]:
            counts.setdefault(c["quantity"], []).append(c["converges"])
    parts = [f"{name}: {sum(v)} of {len(v)}" for name, v in counts.items()]
    return "Number of fractures in which the difference to the finest falls with an order above 0.3: " + "; ".join(parts) + "."


def accuracy():
    catalogue = load("catalogue.json")
    everything, studies = catalogue_tables(catalogue)
    all_scenes = scenes()
    switch_scenes, switches = switch_table(load("switches.json"))
    levels = table(["particles", "processor s", "MB", "cracks", "damage", "volumes", "fragments", "crack area", "peak force", "impulse"],
                   ["---:"] * 10, level_rows(all_scenes))
    failed = sum(p["verdict"] != "pass" for p in catalogue["problems"])
    return f"""# What accuracy costs in time

`tools/measured_docs.py` writes this page from `docs/measured`; its head says by which commands those numbers were measured. Seconds are processor time of
all threads. Machine: {machine_of(catalogue)}.

## How long for how good

![Error against time of every problem that has an order](pictures/accuracy.svg)

{studies}
## The catalogue

`./sunder validate` solves {len(catalogue['problems'])} problems whose references are not Sunder's own; {failed} fail. `--only ID --resolution 16,32,64` studies one of
them, `--html FILE` draws all. Where a check says "catalogue: ...", the problem was meant to hold that, and does not; the comment at the problem in `validation/` says why.

{everything}
## Fractures of scenes, against the resolution

`./sunder accuracy SCENE` solves the first fracture of a scene at 5000 particles and ever twice as many, with several seeds, and compares all with the finest. Means over
{', '.join(s['scene'] for s in all_scenes)} and their seeds: difference to the finest resolution, of crack surfaces in body diagonals, of
damage in cells of a sixteenth of the diagonal, of volumes as mean shift of a piece's size, the rest relative.

{levels}
**What converges.** {converging(all_scenes)} Two runs that differ in nothing but the seed differ by about as much as
two resolutions do: cracks of brittle bodies branch where chance has it. So more particles buy smaller fragments and crack faces that look finer, not the one true crack.
Peak stress is not listed: the strength bounds it by construction.

{"".join(scene_section(s) for s in all_scenes)}
## Switches

`./sunder bench switch`, first fractures of {switch_scenes} at 20000 particles, against the defaults. The rows "another seed" and "a third seed" are the
measure: what moves cracks less than they do cannot be told from chance.

{switches}
Not there: mass scaling and dynamic relaxation. Every load is an impact that lasts microseconds, whose course inertia decides; scaled masses would change the answer, not only its price.
Cracks are extracted once, when a solve has ended, so there is no extraction interval to choose.

## Predictions

`./sunder check SCENE` runs the scene at 800 particles a body, for at most four seconds of processor time, and says what a run at the quality asked for takes;
`report.json` keeps what was predicted beside what it took. The table is of a machine with nothing else to do; a test holds every
scene of `assets/scenes`, as a draft, to a factor of two in processor time and memory.

{prediction_table(load('predictions.json'))}"""


def stability():
    data = load("stability.json")
    failed = sum(p["verdict"] != "pass" for p in data["problems"])
    text = f"""# Hard cases

`tools/measured_docs.py` writes this page from `docs/measured/stability.json`, which `./sunder validate --hard --json FILE` writes; `tests/stability` runs the same cases. Each
ends finite and conserves what it must, or is refused by an error that names the parameter. {len(data['problems'])} cases, {failed} fail.
Machine: {machine_of(data)}.

"""
    text += table(["", "case", "what must hold", "verdict", "s", "MB"], ["---", "---", "---", "---", "---:", "---:"],
                  [[p["id"], escaped(p["title"]), escaped(p["source"]), p["verdict"], f"{p['seconds']:.1f}", f"{p['memory_mb']:.0f}"]
                   for p in data["problems"]])
    text += "\n## Refusals\n\nWhat they say, where an impossible value is answered by an error:\n\n"
    for p in data["problems"]:
        for c in p["checks"]:
            if ": refused, " in c["what"]:
                text += f"- {p['id']}, {c['what']}\n"
    text += """
## What they found

- Wedged fragments of very large bodies threw each other up: restitution and friction at several points of one hit made energy, in each step again. The rigid
  solver now takes back a solve that makes energy and repeats it without restitution (case X12, `rigid/detail/dynamics.cpp`).
"""
    return text


def take_predictions(folder):
    runs = []
    for file in sorted(pathlib.Path(folder).glob("*/report.json")):
        r = json.loads(file.read_text())
        if not r.get("prediction"):
            continue
        runs.append({"scene": r["scene"], "quality": r["quality"], "predicted": r["prediction"],
                     "seconds": r["seconds"]["total"], "processor_seconds": r["seconds"]["processor"],
                     "peak_memory_mb": r["peak_memory_mb"], "fractures": len(r["fractures"])})
    (MEASURED / "predictions.json").write_text(json.dumps({"runs": runs}, indent=1) + "\n")


def main(arguments):
    if arguments[:1] == ["--runs"] and len(arguments) == 2:
        take_predictions(arguments[1])
        arguments = []
    if arguments not in ([], ["--check"]):
        sys.exit(__doc__)
    for name, text in (("accuracy.md", accuracy()), ("stability.md", stability())):
        file = ROOT / "docs" / name
        if arguments == ["--check"] and file.read_text() != text:
            sys.exit(f"docs/{name} is not what docs/measured gives; run tools/measured_docs.py")
        if not arguments:
            file.write_text(text)


main(sys.argv[1:])
