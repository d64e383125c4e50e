"""docs/generated/verdict-calibration.md, and verdict-power.md with its picture, of what scripts/quality/calibrate-verdict found."""
SEEN = 0.8  # a share of trials
COLOURS = {6: "#E69F00", 12: "#0072B2", 24: "#009E73"}

HEAD = """# How often a verdict is wrong

Measured on runs of real engines by `scripts/quality/calibrate-verdict` (a step of `scripts/quality/nightly`), which wrote this page; seed {seed}. What the words
mean: [the rule](../verdict-rule.md); what was found with them: [the evidence](../verdict-evidence.md); what they see: [planted differences](verdict-power.md).

Limits are one-sided at 95 % (Clopper and Pearson 1934). *Pools* are runs of `mujoco` and `bullet` from many starts, 3 s each; a trial draws 6, 12 or 24 of
them with replacement, so that the truth behind it, the pool, is known exactly, and is judged by the program's own rule. Trials of one pool share its runs: they
say how the rule does on such data, and not how other behaviours do.

## Bounds

"""
POWER_HEAD = """# What a verdict sees

Differences that are planted in one of two worlds of a real engine, by `scripts/quality/calibrate-verdict`, which wrote this page; seed {seed}. Pools and trials
are as in [how often a verdict is wrong](verdict-calibration.md).
"""


def word(bound):
    """Of a coverage whose limit is below what is promised, though the trials cannot exclude that: no more than that."""
    if not bound["kept"]:
        return "MISSED"
    return "not excluded" if bound["below"] else "kept"


def sentence(bound):
    return (f"{word(bound):6} {bound['part']}: {bound['what']}: {bound['hits']} of {bound['trials']}, "
            f"{_side(bound)} {_percent(bound['limit'])} (promised: {bound['promised']})")


def write(result, starts, folder):
    found = result["found"]

    def sections(by_part):
        return [section(found[part], starts) for part, section in by_part.items() if found.get(part)]

    wrong = [HEAD.format(seed=result["seed"]) + _bounds(result["bounds"]), *sections({"same-law": _same_law, "halves": _halves, "margin": _margin, "coverage": _coverage})]
    seen = [POWER_HEAD.format(seed=result["seed"]), *sections({"power": _power, "pushes": _pushes})]
    if found.get("power"):
        write_whole(folder / "verdict-power.svg", picture(found["power"], starts))
    write_whole(folder / "verdict-calibration.md", "\n".join(wrong))
    write_whole(folder / "verdict-power.md", "\n".join(seen))


def write_whole(path, text):
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text, encoding="utf-8")
    partial.rename(path)


def table(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(row) + " |" for row in rows)]) + "\n"


def of(counts, n):
    """Keys are text once they were kept."""
    return counts[str(n)] if str(n) in counts else counts.get(n)


def _percent(share):
    return f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.1f} %"


def _side(bound):
    return "at least" if bound["part"] == "coverage" else "at most"


def _bounds(bounds):
    rows = [[b["part"], b["what"], f"{b['hits']} of {b['trials']} ({_percent(b['hits'] / b['trials'])})",
             f"{_side(b)} {_percent(b['limit'])}", b["promised"], {"MISSED": "**missed**"}.get(word(b), word(b))] for b in bounds]
    return table(["part", "what", "found", "limit", "promised", ""], rows)


def _same_law(rows, _starts):
    words = {}
    for row in rows:
        words.setdefault(row["engine"], []).append(row["word"])
    lines = [[f"`mujoco` and `{engine}`", *(str(said.count(word)) for word in ("agrees", "unresolved", "step-dependent", "differs"))]
             for engine, said in words.items()]
    odd = [f"- {row['behaviour']}, `{row['engine']}`: {row['word']} in {', '.join(row['odd'])}." for row in rows if row["odd"]]
    return ("## Engines of one law\n\nSettings that are drawn: three robots, nine gaits, six kinds of ground, friction 0.3 to 1.2, starts, headings and "
            "pushes; every sixth randomises friction,\nmasses, gains and damping. 6 starts of 1.5 to 2.5 s, `crossgait verdict`.\n\n"
            + table(["pair", "agrees", "unresolved", "step-dependent", "differs"], lines) + ("\n" + "\n".join(odd) + "\n" if odd else ""))


def _halves(part, starts):
    said = [row["word"] for row in part["settings"]]
    counts = ", ".join(f"{word} {said.count(word)}" for word in ("agrees", "unresolved", "step-dependent", "differs"))
    rows = [[row["pool"], *(f"{of(row['alarms'], n)} of {row['trials']}" for n in starts)] for row in part["pools"] if row["trials"]]
    return ("## Halves of one engine\n\nStarts of `mujoco` against other starts of `mujoco`, as if they were two engines: nothing but chance lies between "
            f"them. In the settings above, 6 starts\nagainst the next 6: {counts}. False alarms of sets that are drawn from pools:\n\n"
            + table(["pool", *(f"{n} and {n} starts" for n in starts)], rows))


def _margin(rows, starts):
    lines, unseen, irregular = [], [], []
    for row in rows:
        cells = []
        for n in starts:
            agrees = {key: hits for key, hits in of(row["agrees"], n).items() if key != "failures"}
            worst = max(agrees, key=agrees.get)
            cells.append(f"{_percent(sum(agrees.values()) / (len(agrees) * row['trials']))} ({worst} {_percent(agrees[worst] / row['trials'])})")
        lines.append([row["pool"], *cells, *(_percent(of(row["differs"], n) / row["trials"]) for n in starts)])
        if "failures" in of(row["agrees"], starts[0]):
            unseen.append([row["pool"], *(_percent(of(row["agrees"], n)["failures"] / row["trials"]) for n in starts)])
        odd = [key for key in of(row["agrees"], starts[0]) if key not in row["regular"] and key != "failures"]
        irregular += [f"{row['pool']}: {', '.join(odd)}"] if odd else []
    text = ("## At the margin\n\nEvery statistic's margin is its true gap, the mean of its pool, or the median where runs of the pool end early: *agrees* is wrong, and may come in "
            "5 % of cases (in brackets the statistic in which it came most\noften); so is *differs*, which may come in any of them in 5 %. Without the check of the time step, which "
            f"only takes words of *agrees* away. {rows[0]['trials']} trials each.\n\n"
            + table(["pool", *(f"agrees, {n}" for n in starts), *(f"differs, {n}" for n in starts)], lines))
    text += ("\nOver all of these together: " + ", ".join(_all_that_agree(rows, n, failures=False) for n in starts) + "; with failures (below): "
             + ", ".join(_all_that_agree(rows, n, failures=True) for n in starts) + ". That the bounds above\nleave failures out was decided after a first look "
             "at such numbers.\n")
    if irregular:
        text += ("\nDifferences that are skewed (a third standardised moment of 1 or more in the pool) or tied (one value makes up a tenth of them), which Student's "
                 f"intervals alone would\nhold less often than promised: {'; '.join(irregular)}.\n")
    if unseen:
        text += ("\nShares of runs that fail are another matter. Where no start fails in one engine alone the row agrees and says what so many starts exclude, "
                 "22 % with 12\n([rule](../verdict-rule.md#failures-and-other-outcomes)). So with the margin at the true difference of a few per cent *agrees* comes "
                 "as often as nothing is seen: it is that sentence\nthat holds, and not the margin.\n\n" + table(["pool: failures agree", *(f"{n} starts" for n in starts)], unseen))
    return text


def _all_that_agree(rows, n, failures):
    hits = [(count, row["trials"]) for row in rows for key, count in of(row["agrees"], n).items() if failures or key != "failures"]
    return f"{_percent(sum(count for count, _ in hits) / sum(trials for _, trials in hits))} with {n}"


def _coverage(rows, starts):
    lines = []
    for row in rows:
        worst = {n: max(of(row["missed"], n).items(), key=lambda kv: kv[1]) for n in starts}
        cells = [f"{_percent(of(row['held'], n) / row['trials'])}, {_percent(of(row['regular'], n) / row['trials'])} "
                 f"({worst[n][0]} {_percent(1 - worst[n][1] / row['trials'])})" for n in starts]
        lines.append([row["pool"], f"{row['cut']} of {row['starts']}", str(row["trials"]), *cells])
    return ("## Coverage\n\nHow often all intervals of a verdict together hold the true gaps (the mean or the median of the pool, as the trial judges; of a trial in "
            "which no run ends early, of its pairs in which none does), and how often those of regular\ndifferences do; in brackets the statistic that is missed most often. "
            "Of medians of fewer starts than their test needs nothing is claimed ([rule](../verdict-rule.md#estimand)), and nothing counted. A bound that the trials cannot tell from "
            "93 % is not excluded: single pools may lie\nfurther below.\n\n" + table(["pool", "pairs that end early", "trials", *(f"{n} starts" for n in starts)], lines))


def size_text(row):
    return f"{row['size']:+g} {row['unit']}"


def smallest_seen(rows, n):
    """The least size of one kind from which on it is seen, among those that were tried."""
    for place, row in enumerate(rows):
        if all(of(later["seen"], n) >= SEEN for later in rows[place:]):
            return size_text(row) + (" or less" if place == 0 else "")
    return f"beyond {size_text(rows[-1])}"


def _power(rows, starts):
    behaviours, kinds = list(dict.fromkeys(r["behaviour"] for r in rows)), list(dict.fromkeys(r["kind"] for r in rows))
    lines, by = [], {}
    for kind in kinds:
        cells = []
        for behaviour in behaviours:
            of_kind = [r for r in rows if (r["behaviour"], r["kind"]) == (behaviour, kind)]
            if of_kind:
                cells += [smallest_seen(of_kind, n) for n in starts]
                by.setdefault(kind, []).append(of_kind[-1]["by"] or "nothing")
            else:
                cells += ["not run"] * len(starts)
        lines.append([kind, *cells, ", ".join(dict.fromkeys(by.get(kind, [])))])
    trials = sorted({r["trials"] for r in rows})
    pool = sorted({r["starts"] for r in rows})
    return (f"## What is seen\n\nOne of two worlds of `mujoco` is changed, and the controller does not know: friction of the ground; mass and inertia of every body; "
            f"stiffness of the servos; damping of servos and\njoints; delay of the drives; the direction of gravity (a slope along x) and its size. The least of the "
            f"sizes that were tried that is found to *differ* in {100 * SEEN:.0f} % of trials, and every larger one\n(trials of each size: {', '.join(map(str, trials))}, drawn "
            f"of {', '.join(map(str, pool))} starts; sizes beyond one that 6 starts see in 99 % are not run), against the margins as they are: what "
            "changes no statistic by more is not meant to be seen. 2 s each; where starts hardly differ, on the plane, more of them see no more.\n\n"
            + table(["", *(f"{b}: {n}" for b in behaviours for n in starts), "most often in"], lines)
            + "\n![Share of trials that are found to differ, over the size of what is planted](verdict-power.svg)\n")


def _pushes(rows, starts):
    def cell(words):
        return ", ".join(f"{word} {count}" for word, count in sorted(words.items(), key=lambda kv: -kv[1]))

    lines = [[row["behaviour"], row["level"], f"{row['cut']} of {row['starts']}", row["whole"], *(cell(of(row["words"], n)) for n in starts)] for row in rows]
    return ("## Pushed and randomised\n\nPairs that differ, and the same with pushes and randomisation, which are the user's choice: the word may become *unresolved*, "
            "never *agrees*.\n\n" + table(["behaviour", "", "pairs that end early", "all starts together", *(f"trials of {n}" for n in starts)], lines))


def picture(rows, starts):
    """Panels of one kind each, one row a behaviour, as SVG: share of trials over size."""
    behaviours, kinds = list(dict.fromkeys(r["behaviour"] for r in rows)), list(dict.fromkeys(r["kind"] for r in rows))
    width, height, left, top = 150, 110, 70, 40
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + width * len(kinds) + 10}" height="{top + height * len(behaviours) + 10}" '
           'font-family="sans-serif" font-size="10">', '<rect width="100%" height="100%" fill="white"/>']
    for i, n in enumerate(starts):
        out.append(f'<text x="{left + 90 * i}" y="12" fill="{COLOURS[n]}">{n} starts</text>')
    for r, behaviour in enumerate(behaviours):
        for c, kind in enumerate(kinds):
            points = [row for row in rows if (row["behaviour"], row["kind"]) == (behaviour, kind)]
            out += _panel(points, left + width * c, top + height * r, width - 20, height - 40, starts, kind if r == 0 else "", behaviour if c == 0 else "")
    return "\n".join([*out, "</svg>\n"])


def _panel(points, x, y, width, height, starts, title, label):
    out = [f'<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="none" stroke="#bbb"/>',
           f'<line x1="{x}" x2="{x + width}" y1="{y + height * (1 - SEEN):.1f}" y2="{y + height * (1 - SEEN):.1f}" stroke="#ccc" stroke-dasharray="3"/>']
    if title:
        out.append(f'<text x="{x + width / 2}" y="{y - 8}" text-anchor="middle" font-weight="bold">{title}</text>')
    if label:
        out.append(f'<text x="{x - 60}" y="{y + height / 2}">{label}</text>')
    across = [x + width * (i + 0.5) / max(1, len(points)) for i in range(len(points))]
    for at, row in zip(across, points, strict=True):
        out.append(f'<text x="{at:.1f}" y="{y + height + 12}" text-anchor="middle" font-size="8">{row["size"]:+g}</text>')
    if points:
        out.append(f'<text x="{x + width}" y="{y + height + 23}" text-anchor="end" font-size="8">{points[0]["unit"]}</text>')
    for n in starts:
        at = [(px, y + height * (1 - of(row["seen"], n))) for px, row in zip(across, points, strict=True)]
        path = " ".join(f"{px:.1f},{py:.1f}" for px, py in at)
        out.append(f'<polyline points="{path}" fill="none" stroke="{COLOURS[n]}" stroke-width="1.5"/>')
        out += [f'<circle cx="{px:.1f}" cy="{py:.1f}" r="2" fill="{COLOURS[n]}"/>' for px, py in at]
    return out
