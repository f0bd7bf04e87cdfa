"""The text of the specification: edits, handles of the target, fields and links."""
