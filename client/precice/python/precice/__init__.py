# SPDX-License-Identifier: Apache-2.0
"""Version 3 of preCICE's Python interface for Couplet jobs (docs/precice.md). It uses the C library libprecice beside this package, or the file that
COUPLET_PRECICE_LIBRARY names. Arrays are numpy's; errors are RuntimeError."""
import ctypes

import numpy as np

from precice.load import library

__version__ = "3.1.0"
_c = library()
Error = RuntimeError


def _call(name, *arguments, result=None):
    function = getattr(_c, name)
    function.restype = result
    answer = function(*arguments)
    error = _c.couplet_precice_error()
    if error:
        raise Error(error.decode())
    return answer


def _text(value):
    if not isinstance(value, (str, bytes)):
        raise TypeError(f"a name is expected, not {value!r}")
    return value.encode() if isinstance(value, str) else value


def _reals(values):
    return np.ascontiguousarray(values, dtype=np.float64)


def _at(array):
    return array.ctypes.data_as(ctypes.c_void_p)


def _ids(ids):
    array = np.ascontiguousarray(ids)
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise TypeError("vertex ids are integers")
    return np.ascontiguousarray(array, dtype=np.intc).reshape(-1) if array.ndim < 2 else np.ascontiguousarray(array, dtype=np.intc)


def get_version_information():
    return _call("precicec_getVersionInformation", result=ctypes.c_char_p)


class Participant:
    """Participant of this process, which has only one. `communicator` is an mpi4py communicator of its processes."""

    def __init__(self, participant_name, configuration_file_name, solver_process_index, solver_process_size, communicator=None):
        arguments = [_text(participant_name), _text(configuration_file_name), int(solver_process_index), int(solver_process_size)]
        if communicator is None:
            _call("precicec_createParticipant", *arguments)
            return
        from mpi4py import MPI
        _call("precicec_createParticipant_withCommunicator", *arguments, ctypes.c_void_p(MPI._addressof(communicator)))

    # -- steering -----------------------------------------------------------------------------------------------------
    def initialize(self):
        _call("precicec_initialize")

    def advance(self, computed_timestep_length):
        _call("precicec_advance", ctypes.c_double(computed_timestep_length))

    def finalize(self):
        _call("precicec_finalize")

    # -- status and requirements --------------------------------------------------------------------------------------
    def get_mesh_dimensions(self, mesh_name):
        return _call("precicec_getMeshDimensions", _text(mesh_name), result=ctypes.c_int)

    def get_data_dimensions(self, mesh_name, data_name):
        return _call("precicec_getDataDimensions", _text(mesh_name), _text(data_name), result=ctypes.c_int)

    def is_coupling_ongoing(self):
        return bool(_call("precicec_isCouplingOngoing", result=ctypes.c_int))

    def is_time_window_complete(self):
        return bool(_call("precicec_isTimeWindowComplete", result=ctypes.c_int))

    def get_max_time_step_size(self):
        return _call("precicec_getMaxTimeStepSize", result=ctypes.c_double)

    def requires_initial_data(self):
        return bool(_call("precicec_requiresInitialData", result=ctypes.c_int))

    def requires_writing_checkpoint(self):
        return bool(_call("precicec_requiresWritingCheckpoint", result=ctypes.c_int))

    def requires_reading_checkpoint(self):
        return bool(_call("precicec_requiresReadingCheckpoint", result=ctypes.c_int))

    def requires_mesh_connectivity_for(self, mesh_name):
        return bool(_call("precicec_requiresMeshConnectivityFor", _text(mesh_name), result=ctypes.c_int))

    def requires_gradient_data_for(self, mesh_name, data_name):
        return bool(_call("precicec_requiresGradientDataFor", _text(mesh_name), _text(data_name), result=ctypes.c_int))

    # -- meshes -------------------------------------------------------------------------------------------------------
    def reset_mesh(self, mesh_name):
        _call("precicec_resetMesh", _text(mesh_name))

    def set_mesh_vertex(self, mesh_name, position):
        position, dimensions = _reals(position), self.get_mesh_dimensions(mesh_name)
        if position.shape != (dimensions,):
            raise Error(f"set_mesh_vertex: a position on '{mesh_name}' has {dimensions} coordinates, not the shape {position.shape}.")
        return _call("precicec_setMeshVertex", _text(mesh_name), _at(position), result=ctypes.c_int)

    def get_mesh_vertex_size(self, mesh_name):
        return _call("precicec_getMeshVertexSize", _text(mesh_name), result=ctypes.c_int)

    def set_mesh_vertices(self, mesh_name, positions):
        """Adds vertices at `positions` (vertices, dimensions). Returns their ids."""
        positions, dimensions = _reals(positions), self.get_mesh_dimensions(mesh_name)
        if positions.size == 0:
            positions = positions.reshape(0, dimensions)
        if positions.ndim != 2 or positions.shape[1] != dimensions:
            raise Error(f"set_mesh_vertices: positions on '{mesh_name}' are of shape (vertices, {dimensions}), not {positions.shape}.")
        ids = np.empty(len(positions), dtype=np.intc)
        _call("precicec_setMeshVertices", _text(mesh_name), len(positions), _at(positions), _at(ids))
        return ids

    def _element(self, kind, mesh_name, *ids):
        _call(f"precicec_setMesh{kind}", _text(mesh_name), *map(int, ids))

    def _elements(self, kind, corners, mesh_name, vertices):
        vertices = _ids(vertices)
        if vertices.size and (vertices.ndim != 2 or vertices.shape[1] != corners):
            raise Error(f"set_mesh_{kind.lower()}: ids are of shape (elements, {corners}), not {vertices.shape}.")
        _call(f"precicec_setMesh{kind}", _text(mesh_name), len(vertices), _at(vertices))

    def set_mesh_edge(self, mesh_name, first_vertex_id, second_vertex_id):
        self._element("Edge", mesh_name, first_vertex_id, second_vertex_id)

    def set_mesh_edges(self, mesh_name, vertices):
        self._elements("Edges", 2, mesh_name, vertices)

    def set_mesh_triangle(self, mesh_name, first_vertex_id, second_vertex_id, third_vertex_id):
        self._element("Triangle", mesh_name, first_vertex_id, second_vertex_id, third_vertex_id)

    def set_mesh_triangles(self, mesh_name, vertices):
        self._elements("Triangles", 3, mesh_name, vertices)

    def set_mesh_quad(self, mesh_name, first_vertex_id, second_vertex_id, third_vertex_id, fourth_vertex_id):
        self._element("Quad", mesh_name, first_vertex_id, second_vertex_id, third_vertex_id, fourth_vertex_id)

    def set_mesh_quads(self, mesh_name, vertices):
        self._elements("Quads", 4, mesh_name, vertices)

    def set_mesh_tetrahedron(self, mesh_name, first_vertex_id, second_vertex_id, third_vertex_id, fourth_vertex_id):
        self._element("Tetrahedron", mesh_name, first_vertex_id, second_vertex_id, third_vertex_id, fourth_vertex_id)

    def set_mesh_tetrahedra(self, mesh_name, vertices):
        self._elements("Tetrahedra", 4, mesh_name, vertices)

    # -- data ---------------------------------------------------------------------------------------------------------
    def write_data(self, mesh_name, data_name, vertex_ids, values):
        """Writes `values`: (vertices,) for a scalar, (vertices, dimensions) for a vector."""
        ids, values, n = _ids(vertex_ids), _reals(values), self.get_data_dimensions(mesh_name, data_name)
        if values.size != ids.size * n or (n > 1 and values.size and values.shape != (ids.size, n)):
            raise Error(f"write_data: values of '{data_name}' at {ids.size} vertices are of shape {(ids.size, n) if n > 1 else (ids.size,)}, not {values.shape}.")
        _call("precicec_writeData", _text(mesh_name), _text(data_name), ids.size, _at(ids), _at(values))

    def read_data(self, mesh_name, data_name, vertex_ids, relative_read_time):
        ids, n = _ids(vertex_ids), self.get_data_dimensions(mesh_name, data_name)
        values = np.empty((ids.size, n) if n > 1 else ids.size)
        _call("precicec_readData", _text(mesh_name), _text(data_name), ids.size, _at(ids), ctypes.c_double(relative_read_time), _at(values))
        return values

    # -- not supported: each raises an error that names it ----------------------------------------------------------------
    def write_gradient_data(self, mesh_name, data_name, vertex_ids, gradients):
        _call("precicec_writeGradientData", _text(mesh_name), _text(data_name), 0, None, None)

    def write_and_map_data(self, mesh_name, data_name, coordinates, values):
        _call("precicec_writeAndMapData", _text(mesh_name), _text(data_name), 0, None, None)

    def map_and_read_data(self, mesh_name, data_name, coordinates, relative_read_time):
        _call("precicec_mapAndReadData", _text(mesh_name), _text(data_name), 0, None, ctypes.c_double(relative_read_time), None)

    def set_mesh_access_region(self, mesh_name, bounding_box):
        _call("precicec_setMeshAccessRegion", _text(mesh_name), None)

    def get_mesh_vertex_ids_and_coordinates(self, mesh_name):
        _call("precicec_getMeshVertexIDsAndCoordinates", _text(mesh_name), 0, None, None)

    # -- accepted, not used -------------------------------------------------------------------------------------------
    def start_profiling_section(self, section_name):
        _call("precicec_startProfilingSection", _text(section_name))

    def stop_last_profiling_section(self):
        _call("precicec_stopLastProfilingSection")
