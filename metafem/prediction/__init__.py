"""One state of a surface, or its whole friction law: where loads in N and rescaled loads meet."""

from metafem.prediction.equilibrium import equilibrium
from metafem.prediction.friction_law import BranchFit, FrictionLaw, friction_law

__all__ = ["BranchFit", "FrictionLaw", "equilibrium", "friction_law"]
