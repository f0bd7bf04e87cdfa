"""The chapters of the report in the order in which they are read, and the claims of each."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Chapter:
    """A page of the report: file name, title, the question that it answers, and its claims in order."""

    name: str
    title: str
    question: str
    claims: tuple[str, ...]


CHAPTERS = (
    Chapter(
        "paper",
        "The paper, figure by figure",
        "Is the paper reproduced?",
        (
            "fig1_flow", "table_s1", "table_s2", "equations", "bounds", "fig2_calibration",
            "fig3_operating_points", "fig3_branches", "fig_s1_topography", "fig4_linear", "fig5_bilinear",
            "static_and_sliding", "contacts_at_loads", "error_bars", "fig_s2_misalignment",
            "fig_s3_manufacturing",
        ),
    ),
    Chapter(
        "interaction",
        "Elastic interaction and the block",
        "Is elastic interaction below 2.3 %, and which substrate should be used?",
        (
            "interaction_error", "curves", "order3_equations", "order3_against_resolved",
            "order3_independent", "block_or_layer", "pedestal_effect", "block_with_pedestals",
            "arrangement_and_base",
        ),
    ),
    Chapter(
        "finite_elements",
        "Finite elements",
        "Do finite elements confirm the laws on which the models rest?",
        ("fe_hertz", "fe_cap", "fe_layer", "fe_cell", "fe_pedestal", "fe_finite_strain"),
    ),
    Chapter(
        "contact_laws",
        "Contact laws",
        "What do adhesion, the shape of the caps and plasticity change?",
        ("one_contact", "contact_laws", "contact_designs", "elastic_plastic", "plasticity"),
    ),
    Chapter(
        "inversion",
        "Inverse design",
        "Which laws can be designed, and how exactly?",
        ("targets", "any_law", "several_radii", "later_targets", "layout"),
    ),
    Chapter(
        "measurements",
        "From measurements to the model, and back",
        "Are the quantities fitted to measurements unbiased, and are their errors right?",
        (
            "contact_calibration", "calibration_bias", "shear_calibration", "image_areas", "site_matching",
            "topography", "segmented_regression", "diagnosis", "whole_circle", "misuse",
        ),
    ),
    Chapter(
        "cost",
        "What it costs",
        "What does a law cost, and how exact is it?",
        ("work_precision", "scaling"),
    ),
    Chapter(
        "stability",
        "Where it fails",
        "Where do the models fail, and do they say so?",
        ("random_scenes", "stability_map", "extreme_inputs"),
    ),
)  # fmt: skip
