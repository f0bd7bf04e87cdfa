from .contact_table import ContactTable as ContactTable
from .heterogeneity import Heterogeneity as Heterogeneity
from .measured_law.law import MeasuredLaw as MeasuredLaw
from .measurement_errors import MeasurementErrors as MeasurementErrors
from .shear import shear as shear
from .shear_calibration import ShearCalibration as ShearCalibration
from .shear_calibration import ShearTest as ShearTest
from .verdict import Verdict as Verdict
