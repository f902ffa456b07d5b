# SPDX-License-Identifier: Apache-2.0
"""Names of a package that are loaded on first use. Starting a run needs neither numpy nor h5py."""
import importlib


def names(package, places):
    """Creates `__getattr__` of a package. `places` is {module: (names, ...)}."""

    def get(name):
        for module, there in places.items():
            if name in there:
                return getattr(importlib.import_module(f"{package}.{module}"), name)
        raise AttributeError(f"module '{package}' has no attribute '{name}'")

    return get
