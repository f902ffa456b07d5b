// SPDX-License-Identifier: Apache-2.0
// A tuning fork: a stem, a bridge and two prongs 80 mm long; h: size of the tetrahedra [m].
SetFactory("OpenCASCADE");
DefineConstant [ h = 0.0025 ];
Box(1) = {-0.0025, 0, 0, 0.005, 0.03, 0.005};
Box(2) = {-0.01, 0.03, 0, 0.02, 0.006, 0.005};
Box(3) = {-0.01, 0.036, 0, 0.005, 0.08, 0.005};
Box(4) = {0.005, 0.036, 0, 0.005, 0.08, 0.005};
v[] = BooleanUnion{ Volume{1}; Delete; }{ Volume{2:4}; Delete; };
Mesh.CharacteristicLengthMax = h; Mesh.CharacteristicLengthMin = h;
Physical Volume("fork") = {v[]};
b[] = Boundary{ Volume{v[]}; };
r[] = Surface In BoundingBox{-0.003, -1e-5, -1e-5, 0.003, 1e-5, 0.0051};
Physical Surface("root") = {r[]};
b[] -= r[];
Physical Surface("rest") = {b[]};
