"""One axisymmetric contact at small strain, used to check the contact laws of the models."""
