"""The specification's text: edits, handles of the target, fields, links."""
