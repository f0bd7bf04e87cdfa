"""Closed forms of whole problems that judge the package; used by tests and validation alone."""
