# SPDX-License-Identifier: Apache-2.0
"""Transports between processes of a job."""
import os
import re


def choose():
    """Selects shared memory if the whole job is on one machine and the user made no choice, like the programs of the
    job. Different choices are incompatible, and probing all networks is slow."""
    if "OMPI_COMM_WORLD_SIZE" not in os.environ or os.environ["OMPI_COMM_WORLD_SIZE"] != os.environ.get(
        "OMPI_COMM_WORLD_LOCAL_SIZE"
    ):
        return
    if any("OMPI_MCA_" + name in os.environ for name in ("pml", "btl", "mtl", "mca_param_files")):
        return
    for file in ("/etc/openmpi/openmpi-mca-params.conf", os.path.expanduser("~/.openmpi/mca-params.conf")):
        if os.path.exists(file) and re.search(r"^\s*(pml|btl|mtl|ess)[ \t=]+[^\^ \t=]", open(file).read(), re.M):
            return
    os.environ.update(OMPI_MCA_pml="ob1", OMPI_MCA_btl="self,vader")
