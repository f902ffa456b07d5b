// SPDX-License-Identifier: Apache-2.0
// Cube of side 6 with a sphere of radius 1 in its midst, tetrahedra.
SetFactory("OpenCASCADE");
DefineConstant[ n = 4 ];  // edges along the radius of the sphere
Box(1) = {-3, -3, -3, 6, 6, 6};
Sphere(2) = {0, 0, 0, 1};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Mesh.MeshSizeMin = 1 / n;
Mesh.MeshSizeMax = 1 / n;
Physical Surface("sphere") = {7};
Physical Surface("walls") = {1 : 6};
Physical Volume("fluid") = {3};
