// SPDX-License-Identifier: Apache-2.0
DefineConstant[ n = 16 ];
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(5) = {0.8, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 5}; Line(5) = {5, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 5, 4}; Plane Surface(1) = {1}; MeshSize {:} = 1/n;
Physical Curve("floor") = {1}; Physical Curve("right") = {2}; Physical Curve("left") = {4}; Physical Curve("vent") = {3}; Physical Curve("roof") = {5}; Physical Surface("w") = {1};
