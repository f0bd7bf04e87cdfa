"""One axisymmetric contact at small strain, to check the contact laws of the models."""
