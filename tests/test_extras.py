"""Missing packages of extras are named."""

import pytest

from metafem._extras import refuse_missing
from metafem.errors import InvalidInput


def test_an_installed_package_is_accepted():
    refuse_missing("numpy", "images", "measuring images")


def test_a_missing_package_names_its_extra():
    with pytest.raises(
        InvalidInput, match=r"measuring images needs the extra images: pip install 'metafem\[images\]'"
    ):
        refuse_missing("no_such_package", "images", "measuring images")
