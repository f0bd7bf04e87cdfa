"""How sure the design is: misfit, interaction, tolerances, validity."""
