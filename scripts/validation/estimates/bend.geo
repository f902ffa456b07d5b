// SPDX-License-Identifier: Apache-2.0
// A quarter of a ring of radii 1 and 2.
DefineConstant[ n = 4, split = 0 ];
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {2, 0, 0}; Point(4) = {0, 2, 0}; Point(5) = {0, 1, 0};
Line(1) = {2, 3}; Circle(2) = {3, 1, 4}; Line(3) = {4, 5}; Circle(4) = {5, 1, 2};
Transfinite Curve {1, 3} = n + 1; Transfinite Curve {2, 4} = 2 * n + 1;
Curve Loop(1) = {1 : 4}; Plane Surface(1) = {1}; Transfinite Surface {1};
If (!split)
  Recombine Surface {1};
EndIf
Physical Curve("foot") = {1}; Physical Curve("outer") = {2}; Physical Curve("end") = {3}; Physical Curve("inner") = {4}; Physical Surface("inside") = {1};
