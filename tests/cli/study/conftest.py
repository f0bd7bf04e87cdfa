"""The cache of stopped studies, in a folder of each test."""

import pytest

from metafem import _caches


@pytest.fixture(autouse=True)
def stopped_studies(tmp_path_factory, monkeypatch):
    """Keep the batches of stopped studies out of the user's cache, and return their folder."""
    folder = tmp_path_factory.mktemp("cache") / "studies"
    monkeypatch.setattr(_caches, "study_folder", lambda: folder)
    return folder
