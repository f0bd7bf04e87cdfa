"""The workshop: fields with units, and the specification as text."""
