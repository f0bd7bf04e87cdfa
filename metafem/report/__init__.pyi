from .fits import fit_table as fit_table
from .names import all_notes as all_notes
from .names import error_data as error_data
from .names import error_words as error_words
from .names import misfit_words as misfit_words
from .names import model_data as model_data
from .page import page as page
from .page import parameter_rows as parameter_rows
