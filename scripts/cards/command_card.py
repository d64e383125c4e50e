"""What the cards of policies say that follow a command with the joints: the error of tracking it (scripts/cards/policy-cards)."""
import os
import re
import sys

from cards import Method, ask, falls_bound, shown, table

GROUNDS = {"flat": "flat", "rough": "rough:size_x=50,size_y=30"}
COMMANDS = [(vx, 0) for vx in (0, 0.25, 0.5, 0.75, 1)] + [(0, 0.5), (0.5, 0.5), (0.5, -0.5), (1, 0.5), (1, -0.5)]  # m/s, rad/s
ASKED = 0.15  # m/s, the largest error of tracking


def weights_of(environment):
    """Of the two terms of the reward that are errors of tracking; rollouts say sums of weighted terms."""
    with open(environment, encoding="utf-8") as text:
        found = dict(re.findall(r"^ +(velocity_error|yaw_rate_error): (-[0-9.e-]+)$", text.read(), re.MULTILINE))
    if len(found) != 2:
        sys.exit(f"{environment}: reward: velocity_error and yaw_rate_error are what a card is made of")
    return {name: float(weight) for name, weight in found.items()}


def followed(program, method, engine, ground, command, episodes, weights):
    """What is said of all episodes, from standing, and what each has for errors of velocity and yaw rate, means over its policy steps."""
    said = ask(program, "rollout", *method.arguments, "--engine", engine, "--terrain", ground, "--episode-seconds", "20",
               "--command", f"{command[0]},0,{command[1]}", "--episodes", str(episodes))["policies"][0]

    def errors(name):
        return [e["reward_terms"][name] / weights[name] / e["steps"] for e in said["episodes"]]

    return said["all"], errors("velocity_error"), errors("yaw_rate_error")


def cell(program, method, engine, ground, command, episodes):
    told, velocity, yaw_rate = followed(program, method, engine, ground, command, episodes, weights_of(method.arguments[-1]))
    return shown(told) | {
        "slip_m_per_s": told["slip_m"]["mean"] / 20, "velocity_error": sum(velocity) / episodes,
        "yaw_rate_error": sum(yaw_rate) / episodes, "runs": velocity}


def measure(options, folder, note):
    methods = [Method("policy", os.path.basename(folder), os.path.join(folder, "environment.yaml"))]
    if os.path.exists(os.path.join(folder, "gait.yaml")):
        methods.append(Method("gait", "zero", os.path.join(folder, "gait.yaml")))
    results = {}
    for method in methods:
        note(f"{method.name}: commands")
        results[method.name] = {
            name: {engine: {f"{vx:g},{yaw_rate:g}": cell(options.program, method, engine, ground, (vx, yaw_rate), options.runs)
                            for vx, yaw_rate in COMMANDS} for engine in options.engines} for name, ground in GROUNDS.items()}
    return {"commands": results}


def worst_text(results, engines):
    rows = []
    for ground in GROUNDS:
        for e in engines:
            row = [ground, f"`{e}`"]
            for by_ground in results.values():
                cells = by_ground[ground][e]
                worst = max(cells, key=lambda command: cells[command]["velocity_error"])
                mean = sum(c["velocity_error"] for c in cells.values()) / len(cells)
                ended, all_of = (sum(c[key] for c in cells.values()) for key in ("ended_early", "episodes"))
                row += [f"{mean:.3f}", f"{cells[worst]['velocity_error']:.3f} ({worst})",
                        f"{ended} of {all_of}, < {100 * falls_bound(ended, all_of):.1f} %"]
            rows.append(row)
    head = ["ground", "engine"]
    for name in results:
        head += [f"{name}: mean error, m/s", "worst (command)", "ended early, upper end at 95 %"]
    return table(head, rows)


def command_text(own, ground, engines):
    rows = []
    for command in next(iter(own[ground].values())):
        row = [command]
        for e in engines:
            c = own[ground][e][command]
            cost = f"{c['cost_of_transport']:.2f}" if command.split(",")[0] != "0" and "cost_of_transport" in c else "-"
            row.append(f"{c['velocity_error']:.3f}, {c['yaw_rate_error']:.3f}, {cost}, {c['slip_m_per_s']:.3f}, {c['ended_early']}")
        rows.append(row)
    return table(["m/s, rad/s"] + [f"`{e}`: error m/s, rad/s, cost, slip m/s, ended early" for e in engines], rows)


def sections(name, results):
    """Of the card, in Markdown."""
    engines, own = results["engines"], results["commands"]["policy"]
    met = all(c["velocity_error"] <= ASKED for by_engine in own.values() for cells in by_engine.values() for c in cells.values())
    grounds = "\n\n".join(f"### {ground}\n\n{command_text(own, ground, engines)}" for ground in GROUNDS)
    return f"""## Commands

{results['runs']} episodes of 20 s for each command, from standing, on flat and on `rough` ground of 20 mm. The error is the mean, over all steps of 20 ms, of the
distance between the trunk's velocity, in the frame it faces, and the command; at most {ASKED:g} m/s was asked of every command on both grounds in every
engine: {'met' if met else 'not met'}. Slip is how far loaded feet slide, all four together, per second. Not trained in:
{', '.join(f'`{e}`' for e in engines if e not in results['trained_in']) or 'none'}.

{worst_text(results['commands'], engines)}

{grounds}"""
