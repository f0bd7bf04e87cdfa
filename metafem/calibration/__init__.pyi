from .contact_table import ContactTable as ContactTable
from .measured_law.law import MeasuredLaw as MeasuredLaw
from .measurement_errors import MeasurementErrors as MeasurementErrors
from .verdict import Verdict as Verdict
