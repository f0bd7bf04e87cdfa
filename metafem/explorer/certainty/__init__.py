"""The reliability of the design: misfit, interaction, tolerances and validity."""
