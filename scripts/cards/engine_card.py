"""What the cards of engines say of `crossgait conformance`: scripts/cards/engine-cards and scripts/cards/served-cards."""
import re

from cards import table


def text_of(value):
    return "not finite" if value is None else f"{value:.4g}"


def bound_of(measurement):
    low, high = measurement["low"], measurement["high"]
    if low is None and high is None:
        return ""
    if low is None or high is None:
        return f"<= {high:.4g}" if low is None else f">= {low:.4g}"
    return f"{low:.4g} to {high:.4g}"


def label_of(measurement):
    return measurement["what"] + (f" ({measurement['unit']})" if measurement["unit"] else "")


def measurement(card, check, what):
    for row in card["checks"]:
        for number in row["measurements"]:
            if row["name"] == check and number["what"] == what:
                return number
    return None


def value_in(card, check, what):
    found = measurement(card, check, what)
    return "" if found is None else text_of(found["value"])


def summary(cards):
    rows = []
    for one in cards:
        engine = one["engine"]
        steps = value_in(one, "step_time", "time over the other's, median")
        spread = value_in(one, "step_time", "its interquartile range")
        rows.append([
            f"`{engine['name']}`", f"{engine['library']} {engine['version']}", engine["mode"], engine["precision"],
            ", ".join(engine[f"{what}_law"] or "none" for what in ("contact", "loop", "joint_friction", "joint_limit", "coupling", "implicit_servo")),
            str(one["passed"]), str(one["failed"]), str(one["skipped"]), steps and f"{steps} ({spread})"])
    return table(["engine", "library", "mode", "precision", "laws of contact, loops, joint friction, joint limits, couplings, implicit servos", "passed", "failed", "skipped",
                  "step of a trot over the first other engine's, median (interquartile range)"], rows)


def failures(cards):
    """A line for each check that failed, and one for all that failed by the same words, names in quotes apart."""
    lines = []
    for one in cards:
        alike = {}
        for check in (c for c in one["checks"] if c["status"] == "failed"):
            said = [f"{label_of(m)} {text_of(m['value'])}, not {bound_of(m)}" for m in check["measurements"] if not m["holds"]]
            text = "; ".join(said + [check["reason"]] * bool(check["reason"]))
            alike.setdefault(re.sub(r"\B'[^']*'", "", text), (text, []))[1].append(check["name"])
        lines += [f"- `{one['engine']['name']}`, {', '.join(names)}: {text}" for text, names in alike.values()]
    return "\n".join(lines) or "None."


def skipped(cards):
    lines = []
    for one in cards:
        needs = {}
        for check in (c for c in one["checks"] if c["status"] == "skipped"):
            needs.setdefault(check["precondition"] or check["reason"], []).append(check["name"])
        said = "; ".join(f"{', '.join(names)} ({need})" for need, names in needs.items())
        lines.append(f"- `{one['engine']['name']}`: {said or 'none'}")
    return "\n".join(lines)
