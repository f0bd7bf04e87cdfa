"""One contact by finite elements, against closed forms and other computations."""
