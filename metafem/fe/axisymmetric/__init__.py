"""One axisymmetric contact at small strain, against which the models' laws are checked."""
