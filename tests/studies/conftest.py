"""The design and the surfaces of the core's tests."""

from tests.core.studies import conftest as core

design, linear, surface = core.design, core.linear, core.surface
