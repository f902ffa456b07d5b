// SPDX-License-Identifier: Apache-2.0
// A square sheet of 0.2 m.
DefineConstant[ size = 0.02 ]; // m; of the triangles
a = 0.2;
Point(1) = {-a / 2, -a / 2, 0, size};
Point(2) = {a / 2, -a / 2, 0, size};
Point(3) = {a / 2, a / 2, 0, size};
Point(4) = {-a / 2, a / 2, 0, size};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Physical Curve("edge") = {1 : 4};
Physical Surface("sheet") = {1};
