"""What the cards of policies say that drive a gait: the course, speed on rough ground, cost of transport (scripts/cards/policy-cards)."""
import os

from cards import Method, ask, falls_bound, shown, table

ROUGH = "rough:size_x=50,size_y=10"
FAST, CHEAP = 1.0, 0.5  # m/s: where falls and speed are counted, and where cost is
CHEAP_GROUND = "rough:amplitude=.01,size_x=50,size_y=10"


def methods_of(folder, files):
    """The policy in environment.yaml, and the gaits that lie beside it, each in its own."""
    found = [Method("policy", os.path.basename(folder), os.path.join(folder, "environment.yaml"))]
    tuned = [Method(label, "zero", os.path.join(folder, file)) for file, label in files.items()]
    return found + [m for m in tuned if os.path.exists(m.arguments[-1])]


def on_course(options, folder):
    results = {}
    for method in methods_of(folder, {"tuned.yaml": "tuned gait"}):
        said = ask(options.program, "course", *method.arguments, "--engines", ",".join(options.engines), "--episodes", str(options.runs))
        results[method.name] = {
            "scores": {s["engine"]: [s["mean"], s["deviation"]] for s in said["scores"]},
            "sections": {e: {c["section"]["name"]: shown(c["all"]) | {"score": c["score"]["mean"], "runs": c["scores"]}
                             for c in said["cells"] if c["engine"] == e} for e in options.engines}}
    return results


def rolled_out(options, folder, files, command, terrain, episodes):
    """`episodes` of the policy, and as many of the gaits as there are runs of a section; `command` in m/s, or None for none."""
    asked = [] if command is None else ["--command", f"{command},0,0"]
    return {method.name: {engine: shown(ask(
        options.program, "rollout", *method.arguments, "--engine", engine, *asked, "--terrain", terrain,
        "--episode-seconds", "20", "--episodes", str(episodes if method.name == "policy" else options.runs),
    )["policies"][0]["all"]) for engine in options.engines} for method in methods_of(folder, files)}


def course_text(results, engines):
    rows = [[f"`{e}`"] + [f"{m['scores'][e][0]:.3f} ± {m['scores'][e][1]:.3f}" for m in results.values()] for e in engines]
    if "tuned gait" in results:
        for row, e in zip(rows, engines, strict=True):
            mine, theirs = results["policy"]["scores"][e][0], results["tuned gait"]["scores"][e][0]
            row.append(f"{(mine - theirs) / (1 - theirs):.2f}")
    head = ["engine", *results] + (["of what the tuned gait loses, won back"] if "tuned gait" in results else [])
    parts = [table(head, rows)]
    own = results["policy"]["sections"]
    head = ["section, of the policy"] + [f"`{e}`: score, cost, swing contact, slip, ended early" for e in engines]
    rows = []
    for section in own[engines[0]]:
        cells = []
        for e in engines:
            c = own[e][section]
            numbers = ", ".join(f"{c[key]:.2f}" if key in c else "-" for key in ("cost_of_transport", "swing_contact_ratio", "slip_per_path"))
            cells.append(f"{c['score']:.3f}, {numbers}, {c['ended_early']}")
        rows.append([section, *cells])
    return "\n\n".join([*parts, table(head, rows)])


def rollout_text(results, engines):
    rows = []
    for e in engines:
        for name, by_engine in results.items():
            c = by_engine[e]
            numbers = [f"{c[key]:.3f}" if key in c else "-" for key in ("mean_speed_mps", "cost_of_transport", "swing_contact_ratio", "slip_per_path")]
            ended = f"{c['ended_early']} of {c['episodes']}, < {100 * falls_bound(c['ended_early'], c['episodes']):.1f} %"
            rows.append([f"`{e}`", name, *numbers, ended])
    return table(["engine", "", "m/s", "cost of transport", "swing contact", "slip", "ended early, upper end at 95 %"], rows)


def measure(options, folder, note):
    note("course")
    results = {"course": on_course(options, folder)}
    note("fast and cheap")
    results["fast"] = rolled_out(options, folder, {"tuned.yaml": "tuned gait"}, FAST, ROUGH, options.episodes)
    results["cheap"] = rolled_out(options, folder, {"cheap.yaml": "gait tuned for cost"}, CHEAP, CHEAP_GROUND, options.runs)
    return results


def sections(name, results):
    """Of the card, in Markdown."""
    engines = results["engines"]
    return f"""## The course

`crossgait course --policy {name}`, {results['runs']} runs of every section ([what that is](../../../docs/course.md)); deviations from run to run.
Not trained in: {', '.join(f'`{e}`' for e in engines if e not in results['trained_in']) or 'none'}.

{course_text(results['course'], engines)}

## Fast

Asked for {FAST:g} m/s on `rough`, episodes of 20 s.

{rollout_text(results['fast'], engines)}

## Cheap

Asked for {CHEAP:g} m/s on `rough` of 10 mm, {results['runs']} episodes of 20 s.

{rollout_text(results['cheap'], engines)}"""
