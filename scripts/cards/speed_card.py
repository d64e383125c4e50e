"""What the cards of policies say that are asked for no speed: how fast they are on rough ground (scripts/cards/policy-cards)."""
from course_card import ROUGH, rolled_out, rollout_text


def measure(options, folder, note):
    note("speed")
    return {"speed": rolled_out(options, folder, {"environment.yaml": "gait alone"}, None, ROUGH, options.runs)}


def sections(name, results):
    """Of the card, in Markdown."""
    return f"""## Speed

{results['runs']} episodes of 20 s on `rough` of 20 mm.

{rollout_text(results['speed'], results['engines'])}"""
