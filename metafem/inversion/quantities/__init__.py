"""Targets of quantities other than friction: stiffness, tangential stiffness and conductance."""
