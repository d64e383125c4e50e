"""Policies as they are published, with the files that came with them (docs/importing.md)."""

from crossgait.importing.imported import Imported, import_policy

__all__ = ["Imported", "import_policy"]
