from .contact_table import ContactTable as ContactTable
from .measurement_errors import MeasurementErrors as MeasurementErrors
from .verdict import Verdict as Verdict
