"""The surfaces of the core's tests."""

from tests.core.studies import conftest as core

linear, surface = core.linear, core.surface
