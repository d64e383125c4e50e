"""Import a published policy: `python -m crossgait.importing`, which `crossgait import` runs."""

from __future__ import annotations

import argparse
import json
import sys

from crossgait.commands import exit_code, say
from crossgait.importing.imported import import_policy, settings_of


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="crossgait import", description="A published policy, as a folder that runs.")
    parser.add_argument("policy")
    parser.add_argument("--from", dest="sources", action="append", default=[], metavar="FILE")
    parser.add_argument("--robot", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--set", dest="settings", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--joint-order")
    parser.add_argument("--class", dest="config_class")
    parser.add_argument("--document", action="store_true", help="as JSON, with what is said of it")
    return parser.parse_args()


def _run() -> int:
    given = _arguments()
    found = import_policy(
        given.policy,
        given.robot,
        given.out,
        given.sources,
        settings=settings_of(given.settings),
        joint_order=given.joint_order,
        config_class=given.config_class,
    )
    if given.document:
        print(json.dumps({"text": f"{found}\n", "document": found.to_dict()}))
    else:
        say(str(found))
    return 0


if __name__ == "__main__":
    sys.exit(exit_code("crossgait import", _run))
