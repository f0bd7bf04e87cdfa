"""Specifications, result folders and part files, with their units and formats."""

from metafem.files.atomic import MARKS, check_free, refuse_existing, write_text
from metafem.files.loads import load_range
from metafem.files.measurement.block import block_text
from metafem.files.measurement.contacts import contacts_table, read_contacts
from metafem.files.measurement.figures import refuse_figure, write_figure
from metafem.files.measurement.handed_on import (
    HandedOn,
    calibration_data,
    read_handed_on,
)
from metafem.files.measurement.images.find import ImageFile, Images, find_images
from metafem.files.measurement.images.forces import Shot, shots
from metafem.files.measurement.images.pixel_size import pixel_size
from metafem.files.measurement.laws import read_measured_law
from metafem.files.measurement.made import corrected_table, made_table
from metafem.files.measurement.maps import read_height_map
from metafem.files.measurement.sites import Sites, read_sites
from metafem.files.measurement.tables import CalibrationData, of_files, read_calibration
from metafem.files.part.plan import PartOptions, part_notes, planned
from metafem.files.result.folder import (
    load,
    load_compared,
    result_folder,
    result_tables,
    same_design,
    save,
    stored_hardness,
    write_all,
)
from metafem.files.result.study import stored_studies, study_data, study_path, write_study
from metafem.files.result.tables import law_table, read_surface
from metafem.files.schema.document import place_schema, schema_text, write_schema
from metafem.files.schema.forms import KeyForm, SectionForm, section_forms
from metafem.files.specification.demos import DEMOS, demo_text
from metafem.files.specification.manual import all_keys, manual
from metafem.files.specification.models import MODELS
from metafem.files.specification.named_tables import measured_pairs
from metafem.files.specification.options import chosen_model
from metafem.files.specification.read import (
    Specification,
    parsed,
    read_spec,
    refuse_missing_block,
    toml_table,
)
from metafem.files.units import option_names, quantity

__all__ = [
    "DEMOS",
    "MARKS",
    "MODELS",
    "CalibrationData",
    "HandedOn",
    "ImageFile",
    "Images",
    "KeyForm",
    "PartOptions",
    "SectionForm",
    "Shot",
    "Sites",
    "Specification",
    "all_keys",
    "block_text",
    "calibration_data",
    "check_free",
    "chosen_model",
    "contacts_table",
    "corrected_table",
    "demo_text",
    "find_images",
    "law_table",
    "load",
    "load_compared",
    "load_range",
    "made_table",
    "manual",
    "measured_pairs",
    "of_files",
    "option_names",
    "parsed",
    "part_notes",
    "pixel_size",
    "place_schema",
    "planned",
    "quantity",
    "read_calibration",
    "read_contacts",
    "read_handed_on",
    "read_height_map",
    "read_measured_law",
    "read_sites",
    "read_spec",
    "read_surface",
    "refuse_existing",
    "refuse_figure",
    "refuse_missing_block",
    "result_folder",
    "result_tables",
    "same_design",
    "save",
    "schema_text",
    "section_forms",
    "shots",
    "stored_hardness",
    "stored_studies",
    "study_data",
    "study_path",
    "toml_table",
    "write_all",
    "write_figure",
    "write_schema",
    "write_study",
    "write_text",
]
