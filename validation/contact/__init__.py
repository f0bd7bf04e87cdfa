"""Contact laws against closed forms, printed numbers and finite elements."""
