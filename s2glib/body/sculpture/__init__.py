"""How the mannequin is made: solids, the parts of a person, and how they are joined."""

from s2glib.body.sculpture.assembly import assemble

__all__ = ["assemble"]
